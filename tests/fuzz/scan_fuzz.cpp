// scan_fuzz.cpp: Readers of dense images: names, density and fields.
#include <algorithm>

#include "fuzz_target.h"
#include "same_volume.h"

namespace vog::fuzz {

// Deflate packs up to 1032 bytes into one, each of which becomes a float and a voxel of a leaf.
const Limits kLimits{.memory_ratio = 50000};

namespace {

/// Raw values with a head: the head's length in two bytes, the head, the values.
std::filesystem::path raw_file(Bytes input) {
    const std::size_t head =
        input.size() < 2 ? 0 : std::min<std::size_t>(input[0] + 256u * input[1], input.size() - 2);
    const Bytes rest = input.subspan(std::min<std::size_t>(2, input.size()));
    input_file(rest.first(head), ".raw.json");
    return input_file(rest.subspan(head), ".raw");
}

}  // namespace

void run(Bytes input) {
    if (input.empty()) return;
    // The first byte chooses the format.
    constexpr const char* kExtensions[] = {".nii", ".nrrd", ".mha", ".tif", ".fits"};
    constexpr std::uint8_t kRaw = 0xfa;
    const std::filesystem::path file =
        input[0] == kRaw ? raw_file(input.subspan(1))
                         : input_file(input.subspan(1), kExtensions[input[0] % 5]);
    std::vector<std::string> names;
    accepted([&] { names = grid_names(file); });
    expect_valid_grids(names,
                       [&](const VdbOptions& options) { return read_volume(file, options); });
    expect_finite_fields(file, names);
}

}  // namespace vog::fuzz
