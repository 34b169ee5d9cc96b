// replay.cpp: Runs a fuzz target on files and folders, in builds without libFuzzer.
// usage: NAME_fuzz FILE|FOLDER...
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

void replay(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    const std::vector<char> bytes{std::istreambuf_iterator<char>(stream), {}};
    std::fprintf(stderr, "%s\n", file.c_str());
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

}  // namespace

int main(int count, char** arguments) {
    int runs = 0;
    for (int n = 1; n < count; ++n) {
        if (!std::filesystem::is_directory(arguments[n])) {
            replay(arguments[n]);
            ++runs;
            continue;
        }
        for (const auto& entry : std::filesystem::directory_iterator(arguments[n])) {
            replay(entry.path());
            ++runs;
        }
    }
    std::fprintf(stderr, "%d inputs\n", runs);
    return runs > 0 ? 0 : 1;
}
