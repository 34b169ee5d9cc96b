// vdb_fuzz.cpp: Readers of OpenVDB's volumes: names, description, density; what is read is written and read again.
#include <algorithm>

#include "fuzz_target.h"
#include "same_volume.h"
#include "vog/volume_io.h"

namespace vog::fuzz {

const Limits kLimits{};

void run(Bytes input) {
    const std::filesystem::path file = input_file(input, ".vdb");
    std::vector<std::string> names;
    accepted([&] { names = vdb_grid_names(file); });
    accepted([&] { (void)inspect_vdb(file); });
    names.resize(std::min<std::size_t>(names.size(), 3));
    names.push_back("");
    for (const std::string& name : names)
        for (const bool lenient : {false, true}) {
            const VdbOptions options{
                .grid = name, .level_set_to_fog = lenient, .values = {lenient, lenient}};
            Volume volume;
            if (!accepted([&] { volume = read_vdb(file, options); })) continue;
            expect(active_voxels(volume) > 0, "a volume that is read has active voxels");
            expect_valid(volume);
        }
    accepted([&] { (void)read_vdb(file, {.mask = true}); });
}

}  // namespace vog::fuzz
