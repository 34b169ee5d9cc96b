// visibility_test.cpp: visibility weights of a cube in closed form, and their invariances.
#include "convert/moments/cut/visibility.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/moment_volumes.h"

namespace vog {

using namespace moments;
namespace {

using test::VolumeMaker;

Volume cube(int edge, float value, int from = 0) {
    VolumeMaker maker;
    maker.box({from, from, from}, {from + edge - 1, from + edge - 1, from + edge - 1}, value);
    return maker.finish();
}

TEST(visibility, corners_weigh_more_than_edges_than_faces_than_the_middle) {
    const Volume volume = cube(64, 1);
    const LatticeField field = lattice_field(volume);
    const VisibilityWeight visibility(field);
    const double corner = visibility({2, 2, 2}), edge = visibility({2, 2, 31}),
                 face = visibility({2, 31, 31}), middle = visibility({31, 31, 31});
    EXPECT_GT(corner, edge);
    EXPECT_GT(edge, face);
    EXPECT_GE(face, middle);
    EXPECT_LT(corner, 1.1);
    EXPECT_GT(middle, 0.1) << "no place has weight 0";
    EXPECT_LT(middle, 0.11);
    for (const Vec3d other : {Vec3d{61, 2, 2}, Vec3d{2, 61, 61}, Vec3d{61, 61, 61}})
        EXPECT_NEAR(visibility(other), corner, 1e-6) << "all corners alike";
}

TEST(visibility, one_bin_has_the_columns_of_its_three_diagonals) {
    // One bin of 4^3, alone: its columns hold it along all directions, at steps of 1, sqrt 2 and
    // sqrt 3, of which the longest are the highest percentile: T = 4 along these.
    const Volume volume = cube(4, 3);
    const LatticeField field = lattice_field(volume);
    const double root3 = std::sqrt(3.0);
    const double expected = 0.1 + (3 * std::exp(-8 / root3) +
                                   6 * std::exp(-8 * std::sqrt(2.0) / root3) + 4 * std::exp(-8.0)) /
                                      13;
    EXPECT_NEAR(VisibilityWeight(field)({1.5, 1.5, 1.5}), expected, 1e-6);
}

TEST(visibility, units_of_density_and_length_and_places_do_not_matter) {
    const Volume one = cube(40, 1);
    Volume other = cube(40, 1e-6f, -96);
    other.world_from_index.linear = {{Vec3d{0, -1e5, 0}, {1e5, 0, 0}, {0, 0, 1e5}}};
    const LatticeField field = lattice_field(one), far = lattice_field(other);
    const VisibilityWeight visibility(field), visibility_far(far);
    for (const Vec3d at : {Vec3d{1, 1, 1}, Vec3d{20, 3, 7}, Vec3d{39, 39, 20}})
        EXPECT_NEAR(visibility(at), visibility_far(at - Vec3d{96, 96, 96}), 1e-5);
}

TEST(visibility, tiles_weigh_as_the_same_voxels_in_leaves) {
    Volume tiles;
    tiles.tiles = {{{0, 0, 0}, 128, 0.5f}};
    const Volume leaves = cube(128, 0.5f);
    const LatticeField a = lattice_field(tiles), b = lattice_field(leaves);
    const VisibilityWeight coarse(a), fine(b);
    // Bins are as large as the samples of the tile, 16 voxels, instead of 4.
    for (const double at : {8.0, 40.0, 72.0}) {
        const Vec3d place{at, at + 16, at};
        EXPECT_NEAR(coarse(place), fine(place), 0.05);
    }
    const Volume none;
    const LatticeField nothing = lattice_field(none);
    EXPECT_NO_THROW(VisibilityWeight{nothing});
}

}  // namespace
}  // namespace vog
