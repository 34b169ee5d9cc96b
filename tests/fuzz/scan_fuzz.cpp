// scan_fuzz.cpp: Readers of dense images: names, density and fields.
#include "fuzz_target.h"
#include "same_volume.h"

namespace vog::fuzz {

// Deflate packs up to 1032 bytes into one, each of which becomes a float and a voxel of a leaf.
const Limits kLimits{.memory_ratio = 50000};

void run(Bytes input) {
    if (input.empty()) return;
    // The first byte chooses the format.
    constexpr const char* kExtensions[] = {".nii", ".nrrd", ".mha", ".tif", ".fits"};
    const std::filesystem::path file = input_file(input.subspan(1), kExtensions[input[0] % 5]);
    std::vector<std::string> names;
    accepted([&] { names = grid_names(file); });
    expect_valid_grids(names,
                       [&](const VdbOptions& options) { return read_volume(file, options); });
    expect_finite_fields(file, names);
}

}  // namespace vog::fuzz
