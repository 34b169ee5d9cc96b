// nvdb_fuzz.cpp: Readers of NanoVDB's volumes: names and density.
// An uncompressed NanoVDB file has some 300 kB of tables for a single voxel. Most inputs are therefore changes to such
// a file.
#include <nanovdb/util/GridBuilder.h>
#include <nanovdb/util/IO.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "fuzz_target.h"
#include "same_volume.h"

namespace vog::fuzz {

// The file that an input changes has a quarter of a million bytes.
const Limits kLimits{.seconds = 10};

namespace {

/// A valid file with a leaf and a tile.
std::string base_file() {
    nanovdb::GridBuilder<float> builder(0.0f, nanovdb::GridClass::FogVolume);
    auto accessor = builder.getAccessor();
    for (int n = 0; n < 20; ++n) accessor.setValue({n % 3, n % 5, n}, 0.5f + 0.1f * float(n));
    auto grid = builder.getHandle<>(0.1, nanovdb::Vec3d(1, 2, 3), "density");
    const std::filesystem::path file = scratch_file("base.nvdb");
    nanovdb::io::writeGrid(file.string(), grid, nanovdb::io::Codec::NONE);
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

/// The whole file, or changes to the valid one: place (3 bytes), count (1), bytes.
std::vector<std::uint8_t> file_bytes(Bytes input) {
    if (input.empty() || input[0] % 4 == 0) return {input.begin(), input.end()};
    static const std::string base = base_file();
    std::vector<std::uint8_t> bytes(base.begin(), base.end());
    Numbers numbers(input.subspan(1));
    while (!numbers.empty()) {
        // Headers, the root and its tables lie in the first kilobytes.
        const std::size_t range = numbers.flag() ? 4096 : bytes.size();
        const std::size_t place = numbers.bits(3) % range, count = numbers.bits(1) % 16;
        for (std::size_t n = place; n < std::min(place + count + 1, bytes.size()); ++n)
            bytes[n] = numbers.byte();
    }
    return bytes;
}

}  // namespace

void run(Bytes input) {
    const std::filesystem::path file = input_file(file_bytes(input), ".nvdb");
    std::vector<std::string> names;
    accepted([&] { names = nvdb_grid_names(file); });
    expect_valid_grids(names, [&](const VdbOptions& options) { return read_nvdb(file, options); });
    expect_finite_fields(file, names);
}

}  // namespace vog::fuzz
