// fuzz_target.cpp: Entry point that libFuzzer and replay.cpp call; limits of time and memory of every target.
#include "fuzz_target.h"

#include <unistd.h>

#include <atomic>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>

#include "vog/error.h"

// Memory is counted where libFuzzer is: GCC comes without this header.
#if __has_include(<sanitizer/allocator_interface.h>) && defined(__has_feature)
#if __has_feature(address_sanitizer)
#define VOG_COUNTS_MEMORY
#include <sanitizer/allocator_interface.h>
#endif
#endif

namespace vog::fuzz {

namespace {

/// Bytes allocated now, and the most since the last reset.
std::atomic<std::int64_t> g_live, g_peak;

#ifdef VOG_COUNTS_MEMORY
void count_malloc(const volatile void*, std::size_t size) {
    const std::int64_t live = g_live += static_cast<std::int64_t>(size);
    std::int64_t peak = g_peak;
    while (live > peak && !g_peak.compare_exchange_weak(peak, live)) {
    }
}
void count_free(const volatile void* memory) {
    if (memory)
        g_live -=
            static_cast<std::int64_t>(__sanitizer_get_allocated_size(const_cast<void*>(memory)));
}
const int g_counted = __sanitizer_install_malloc_and_free_hooks(count_malloc, count_free);
#endif

/// Message of the last refusal in this run.
std::string& last_refusal() {
    static std::string text;
    return text;
}

/// Folder that is removed when the process ends.
struct Folder {
    std::filesystem::path path;
    Folder() {
        const std::filesystem::path memory = "/dev/shm";
        const bool fast = ::access(memory.c_str(), W_OK) == 0;
        std::string pattern =
            ((fast ? memory : std::filesystem::temp_directory_path()) / "vog-fuzz-XXXXXX").string();
        if (!::mkdtemp(pattern.data())) std::abort();
        path = pattern;
    }
    ~Folder() {
        std::error_code ignored;
        std::filesystem::remove_all(path, ignored);
    }
};

/// Whether a text is UTF-8 without control characters.
bool printable(const std::string& text) {
    for (std::size_t n = 0; n < text.size();) {
        const auto lead = static_cast<unsigned char>(text[n++]);
        if (lead < 0x20 || lead == 0x7f) return false;
        if (lead < 0x80) continue;
        const int more = lead >= 0xf0 ? 3 : lead >= 0xe0 ? 2 : lead >= 0xc2 ? 1 : -1;
        if (more < 0 || lead > 0xf4) return false;
        for (int k = 0; k < more; ++k, ++n)
            if (n >= text.size() || (static_cast<unsigned char>(text[n]) & 0xc0) != 0x80)
                return false;
    }
    return true;
}

}  // namespace

void expect(bool holds, const char* property) {
    if (holds) return;
    std::fprintf(stderr, "fuzz: does not hold: %s\n", property);
    if (!last_refusal().empty())
        std::fprintf(stderr, "fuzz: last refusal: %s\n", last_refusal().c_str());
    std::abort();
}

bool accepted(const std::function<void()>& call) {
    try {
        call();
        return true;
    } catch (const Error& error) {
        const std::string message = error.what();
        last_refusal() = message;
        if (message.empty() || !printable(message)) {
            std::fprintf(stderr, "fuzz: message of %zu bytes: '%s'\n", message.size(),
                         message.c_str());
            expect(false, "a message is one line of printable text");
        }
        return false;
    }
}

std::filesystem::path scratch_file(const std::string& name) {
    static const Folder folder;
    return folder.path / name;
}

std::filesystem::path input_file(Bytes input, const std::string& extension) {
    const std::filesystem::path file = scratch_file("input" + extension);
    std::ofstream stream(file, std::ios::binary);
    stream.write(reinterpret_cast<const char*>(input.data()),
                 static_cast<std::streamsize>(input.size()));
    return file;
}

float Numbers::number() {
    const std::uint8_t kind = byte();
    const float sign = kind & 1 ? -1.0f : 1.0f;
    if (kind < 160) return sign * static_cast<float>(share() * (kind < 80 ? 1 : 100));
    if (kind < 224) return sign * std::pow(10.0f, static_cast<float>(below(77) - 38));
    return std::bit_cast<float>(static_cast<std::uint32_t>(bits(4)));
}

float Numbers::positive() {
    const float any = std::abs(number());
    return any > 0 && std::isfinite(any) ? any : 1.0f;
}

std::string Numbers::text(int most) {
    std::string text(static_cast<std::size_t>(below(most + 1)), ' ');
    for (char& c : text) c = static_cast<char>(byte());
    return text;
}

}  // namespace vog::fuzz

/// libFuzzer's name.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace vog::fuzz;
    const std::int64_t before = g_live;
    g_peak = before;
    const std::clock_t start = std::clock();
    last_refusal().clear();
    run({data, size});
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    const double kilobytes = static_cast<double>(size) / 1024;
    if (seconds > kLimits.seconds + kLimits.seconds_per_kilobyte * kilobytes) {
        std::fprintf(stderr, "fuzz: %.1f s for %zu bytes\n", seconds, size);
        expect(false, "time within the limit");
    }
    const double most = 64 * 1048576.0 + kLimits.memory_ratio * static_cast<double>(size);
    if (static_cast<double>(g_peak - before) > most) {
        std::fprintf(stderr, "fuzz: %lld bytes for %zu\n", static_cast<long long>(g_peak - before),
                     size);
        expect(false, "memory within the limit");
    }
    return 0;
}
