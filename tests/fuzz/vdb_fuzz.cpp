// vdb_fuzz.cpp: Readers of OpenVDB's volumes: names, description, density; what is read is written and read again.
#include "fuzz_target.h"
#include "same_volume.h"

namespace vog::fuzz {

const Limits kLimits{};

void run(Bytes input) {
    const std::filesystem::path file = input_file(input, ".vdb");
    std::vector<std::string> names;
    accepted([&] { names = vdb_grid_names(file); });
    accepted([&] { (void)inspect_vdb(file); });
    expect_valid_grids(names, [&](const VdbOptions& options) { return read_vdb(file, options); });
    accepted([&] { (void)read_vdb(file, {.mask = true}); });
    expect_finite_fields(file, names);
}

}  // namespace vog::fuzz
