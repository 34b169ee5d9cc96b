// arrangement_test.cpp: levels of a mesh, parts side by side, and volumes that are neither.
#include "data/levels/arrangement.h"

#include <gtest/gtest.h>

#include "support/level_volumes.h"
#include "support/moment_volumes.h"

namespace vog {
namespace {

using Kind = Arrangement::Kind;

Kind kind_of(std::vector<Volume> volumes) {
    Levels levels;
    levels.volumes = std::move(volumes);
    return arrangement_of(levels).kind;
}

Affine shifted(Vec3d by) { return {{}, by}; }

TEST(arrangement, nested_lattices_are_levels) {
    for (const test::NestedScene& scene : test::nested_scenes()) {
        SCOPED_TRACE(scene.name);
        const Levels levels = test::nested_cubes(20, scene.outer, scene.inner);
        const Arrangement found = arrangement_of(levels);
        EXPECT_EQ(found.kind, scene.fits ? Kind::levels : Kind::overlapping) << found.text;
        EXPECT_EQ(found.is_mesh(), scene.fits);
    }
}

TEST(arrangement, volumes_of_one_voxel_size_that_overlap_are_no_mesh) {
    const Volume cube = test::cube_of(20, 0.5f, {});
    EXPECT_EQ(kind_of({cube, cube}), Kind::overlapping) << "time steps";
    EXPECT_EQ(kind_of({cube, test::cube_of(20, 0.7f, shifted({19, 0, 0}))}), Kind::overlapping)
        << "one layer of voxels";
    EXPECT_EQ(kind_of({cube, test::cube_of(20, 0.7f, shifted({0.4, 0.3, 0.2}))}), Kind::overlapping)
        << "lattices apart by parts of a voxel";
    // A second level does not excuse two volumes of the first.
    const Volume fine = test::nested_cubes(20, {}, {{2, {4.5, 3.5, 5.5}, 16}}).volumes[1];
    EXPECT_EQ(kind_of({cube, fine, cube}), Kind::overlapping);
}

TEST(arrangement, volumes_that_do_not_overlap_are_parts) {
    const Volume cube = test::cube_of(20, 0.5f, {});
    const Volume beside = test::cube_of(20, 0.7f, shifted({20, 0, 0}));
    EXPECT_EQ(kind_of({cube, beside}), Kind::parts);
    EXPECT_EQ(kind_of({cube, test::cube_of(20, 0.7f, shifted({100, 0, 0}))}), Kind::parts);
    // Two parts of a coarse level, and a finer level over both.
    const Volume fine = test::cube_of(16, 0.7f, test::nested_map({}, 2, {15.5, 3.5, 3.5}));
    EXPECT_EQ(kind_of({cube, beside, fine}), Kind::levels);
    // Voxels of two volumes may interleave within one leaf.
    test::VolumeMaker even, odd;
    for (int x = 0; x < 8; ++x) (x % 2 ? odd : even).box({x, 0, 0}, {x, 7, 7}, 1);
    EXPECT_EQ(kind_of({even.finish(), odd.finish()}), Kind::parts);
}

TEST(arrangement, tiles_overlap_like_voxels) {
    const auto tile = [](Vec3i origin, int edge) {
        Volume volume;
        volume.tiles.push_back({origin, edge, 1});
        return volume;
    };
    EXPECT_EQ(kind_of({tile({0, 0, 0}, 128), tile({0, 0, 0}, 8)}), Kind::overlapping);
    EXPECT_EQ(kind_of({tile({0, 0, 0}, 128), tile({128, 0, 0}, 128)}), Kind::parts);
    EXPECT_EQ(kind_of({tile({0, 0, 0}, 128), test::cube_of(20, 1, {})}), Kind::overlapping);
    EXPECT_EQ(kind_of({test::cube_of(20, 1, {}), tile({24, 0, 0}, 8)}), Kind::parts);
}

TEST(arrangement, a_finer_volume_outside_the_coarser_box_is_no_level_but_may_be_a_part) {
    const Volume cube = test::cube_of(16, 0.5f, {});
    // 64 fine voxels reach 21 coarse ones beyond the cube.
    const Volume reaching = test::cube_of(64, 0.7f, test::nested_map({}, 2, {4.5, 4.5, 4.5}));
    EXPECT_EQ(kind_of({cube, reaching}), Kind::overlapping);
    const Volume apart = test::cube_of(32, 0.7f, test::nested_map({}, 2, {63.5, 4.5, 4.5}));
    EXPECT_EQ(kind_of({cube, apart}), Kind::parts);
}

TEST(arrangement, names_that_differ_in_more_than_digits_are_quantities) {
    Levels levels = test::nested_cubes(20, {}, {{2, {4.5, 3.5, 5.5}, 16}});
    levels.volumes[0].name = "density_L0";
    levels.volumes[1].name = "density_L12";
    EXPECT_EQ(arrangement_of(levels).kind, Kind::levels);
    levels.volumes[1].name = "temperature_L1";
    levels.volumes[1].source = "a.vdb";
    const Arrangement found = arrangement_of(levels);
    EXPECT_EQ(found.kind, Kind::quantities);
    EXPECT_EQ(found.text, "'density_L0' and a.vdb 'temperature_L1' are different quantities");
}

}  // namespace
}  // namespace vog
