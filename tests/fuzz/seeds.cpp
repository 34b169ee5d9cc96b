// seeds.cpp: Small OpenVDB files for the corpora of fuzz targets; those of `vog sample` have thousands of voxels.
// usage: vog_fuzz_seeds FOLDER     files go to FOLDER/vdb and FOLDER/points_vdb
#include <cstdio>
#include <filesystem>
#include <vector>

#include "drawn.h"
#include "vog/points.h"
#include "vog/volume_io.h"

namespace vog::fuzz {

const Limits kLimits{};
void run(Bytes) {}

namespace {

/// Bytes of a linear congruential sequence (Knuth's MMIX constants).
std::vector<std::uint8_t> bytes(std::uint64_t seed) {
    std::vector<std::uint8_t> all(2000);
    for (std::uint8_t& byte : all) {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        byte = static_cast<std::uint8_t>(seed >> 56);
    }
    return all;
}

void write_seeds(const std::filesystem::path& folder) {
    std::filesystem::create_directories(folder / "vdb");
    std::filesystem::create_directories(folder / "points_vdb");
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        const std::vector<std::uint8_t> drawn = bytes(seed);
        Numbers numbers(drawn);
        const std::string name = std::to_string(seed) + ".vdb";
        const Volume volume = drawn_volume(numbers);
        accepted([&] { write_vdb(folder / "vdb" / name, volume, seed % 2); });
        Points points;
        for (std::uint64_t n = 0; n <= seed; ++n)
            points.position.push_back({numbers.share(), numbers.share(), numbers.share()});
        if (seed % 2) points.velocity.resize(points.size());
        if (seed % 4 == 0) points.attributes = {{"mass", BigVector<float>(points.size(), 2.0f)}};
        if (seed < 8) accepted([&] { write_points(folder / "points_vdb" / name, points); });
    }
}

}  // namespace

}  // namespace vog::fuzz

int main(int count, char** arguments) {
    if (count != 2) {
        std::fprintf(stderr, "usage: vog_fuzz_seeds FOLDER\n");
        return 2;
    }
    vog::fuzz::write_seeds(arguments[1]);
}
