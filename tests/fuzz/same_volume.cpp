// same_volume.cpp: Validity of volumes that are read, equality of those that are written and read.
#include "same_volume.h"

#include <algorithm>

#include "fuzz_target.h"

namespace vog::fuzz {

namespace {

bool same(const Leaf& a, const Leaf& b) {
    return a.origin == b.origin && a.mask == b.mask && same_bytes(a.value, b.value);
}
bool same(const Tile& a, const Tile& b) {
    return a.origin == b.origin && a.edge == b.edge && a.value == b.value;
}

}  // namespace

void expect_valid_grids(std::vector<std::string> names,
                        const std::function<Volume(const VdbOptions&)>& read) {
    names.resize(std::min<std::size_t>(names.size(), 3));
    names.push_back("");
    for (const std::string& name : names)
        for (const bool lenient : {false, true}) {
            const VdbOptions options{
                .grid = name, .level_set_to_fog = lenient, .values = {lenient, lenient}};
            Volume volume;
            if (!accepted([&] { volume = read(options); })) continue;
            expect(active_voxels(volume) > 0, "a volume that is read has active voxels");
            expect(accepted([&] { validate(volume); }), "a volume that is read is valid");
        }
}

void expect_round_trip(const Volume& volume) {
    const std::filesystem::path file = scratch_file("again.vdb");
    if (!accepted([&] { write_vdb(file, volume); })) return;
    Volume again;
    const bool read = accepted([&] { again = read_vdb(file); });
    expect(read, "a volume that is written is read");
    expect(again.leaves.size() == volume.leaves.size(), "leaves survive");
    expect(again.tiles.size() == volume.tiles.size(), "tiles survive");
    for (std::size_t n = 0; n < again.leaves.size(); ++n)
        expect(same(again.leaves[n], volume.leaves[n]), "voxels survive bit for bit");
    for (std::size_t n = 0; n < again.tiles.size(); ++n)
        expect(same(again.tiles[n], volume.tiles[n]), "tiles survive bit for bit");
    expect(again.world_from_index == volume.world_from_index, "the transform survives");
    expect(again.name == volume.name, "the name survives");
}

}  // namespace vog::fuzz
