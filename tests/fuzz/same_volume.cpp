// same_volume.cpp: Validity of volumes that are read, equality of those that are written and read.
#include "same_volume.h"

#include <algorithm>
#include <cmath>

#include "fuzz_target.h"
#include "vog/voxel_field.h"

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

void expect_finite_fields(const std::filesystem::path& file, std::vector<std::string> names) {
    names.resize(std::min<std::size_t>(names.size(), 3));
    for (const std::string& name : names) {
        Volume volume;
        if (accepted([&] { volume = read_volume(file, {.grid = name, .ones = true}); }))
            expect(accepted([&] { validate(volume); }), "a measure of ones is valid");
        // The lattice of the file, or voxels of 1 at its origin.
        Volume measure;
        measure.world_from_index = volume.world_from_index;
        measure.leaves.resize(1);
        if (!volume.leaves.empty()) measure.leaves[0].origin = volume.leaves[0].origin;
        for (int n = 0; n < kLeafVoxels; n += 7) measure.leaves[0].set(n, 0.5f);
        Tile tile{measure.leaves[0].origin, 8, 1};
        tile.origin.z ^= 8;
        measure.tiles = {tile};
        VoxelField field;
        if (!accepted([&] { field = read_field({.file = file, .grid = name}, measure); })) continue;
        expect(accepted([&] { validate(measure); }), "a divided measure is valid");
        for (const VoxelValues& values : field.component) {
            expect(values.leaf.size() == measure.leaves.size(), "a field has all leaves");
            expect(values.tile.size() == measure.tiles.size(), "a field has all tiles");
            for (const auto& leaf : values.leaf)
                for (const float value : leaf) expect(std::isfinite(value), "a field is finite");
            for (const float value : values.tile)
                expect(std::isfinite(value), "a field is finite in tiles");
        }
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
