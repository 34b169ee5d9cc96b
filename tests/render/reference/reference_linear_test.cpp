// reference_linear_test.cpp: The reference renderer's trilinear field against brute force.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "render/reference/fields/linear_volume.h"
#include "render/reference/reference.h"
#include "render/reference/reference_grid.h"
#include "support/data.h"
#include "support/random_volume.h"
#include "support/ray_voxels.h"
#include "vog/volume_io.h"

namespace vog {

using namespace reference;
namespace {

constexpr VoxelGridOptions kExact{Interpolation::linear, 0};
// Sums of some hundred cells, rounded at 1e-16 of distances of up to a thousand voxels.
constexpr double kLinearRounding = 1e-11;

Volume single(Vec3i at, float value) {
    Volume volume;
    Leaf leaf;
    leaf.origin = {at.x & ~7, at.y & ~7, at.z & ~7};
    leaf.set(leaf_offset(at.x & 7, at.y & 7, at.z & 7), value);
    volume.leaves.push_back(leaf);
    return volume;
}

/// Leaves from empty to dense, a tile in the row above them and a large one beside them. (A tile of
/// 4096^3 is left out: its border has 786 000 blocks.)
Volume leaves_and_tiles(std::uint64_t seed) {
    Volume volume = test::random_volume(seed);
    volume.tiles = {{{24, -8, 0}, 8, 0.5f}, {{-128, 0, 0}, 128, 2e-2f}};
    std::erase_if(volume.leaves, [](const Leaf& leaf) {
        return leaf.origin.x < 0 && leaf.origin.y >= 0 && leaf.origin.z >= 0;
    });
    sort_nodes(volume);
    return volume;
}

VoxelGridOptions with_step(double step_voxels) { return {Interpolation::linear, step_voxels}; }

/// Rays through the box from around it and from inside, in world space.
std::vector<std::pair<Vec3d, Vec3d>> rays_through(const Volume& volume, Box box, int count) {
    test::Random random(9);
    std::vector<std::pair<Vec3d, Vec3d>> rays;
    for (int i = 0; i < count; ++i) {
        const Vec3d size = box.upper - box.lower;
        const Vec3d target =
            box.lower + Vec3d{random() * size.x, random() * size.y, random() * size.z};
        Vec3d from = target + (i % 4 ? 2.0 : 0.2) * box.radius() * normalized(random.in_cube(1));
        if (i % 8 == 1) from.x = target.x, from.z = target.z;
        rays.push_back(
            {volume.world_from_index(from), volume.world_from_index.linear * (target - from)});
    }
    return rays;
}

TEST(reference_linear, one_voxel_is_a_tent) {
    for (const Vec3i at : {Vec3i{3, 4, 5}, Vec3i{0, 0, 0}, Vec3i{-1, 7, 8}, Vec3i{4095, 0, -128}}) {
        const VoxelGrid grid = voxel_grid(single(at, 2), kExact);
        const Vec3d center = vec_cast<double>(at);
        for (const double off : {0.0, 0.25, -0.75, 0.9375}) {
            // Along an axis the tent integrates to 1; across, it falls off as 1 - |offset|.
            EXPECT_NEAR(optical_depth(grid, center + Vec3d{-9, off, 0}, {1, 0, 0}),
                        2 * (1 - std::abs(off)), kLinearRounding);
            EXPECT_NEAR(optical_depth(grid, center + Vec3d{off, 0.5, 20}, {0, 0, -1}),
                        1 - std::abs(off), kLinearRounding);
        }
        // (1 - |s|)^3 along the diagonal, twice from 0 to 1.
        EXPECT_NEAR(optical_depth(grid, center - Vec3d{7, 7, 7}, {1, 1, 1}), std::sqrt(3),
                    kLinearRounding);
        EXPECT_EQ(optical_depth(grid, center + Vec3d{-9, 1.001, 0}, {1, 0, 0}), 0);
    }
}

TEST(reference_linear, tile_and_the_same_leaves_agree) {
    Volume tile, leaves;
    tile.tiles.push_back({{0, -128, 128}, 128, 0.25f});
    for (int x = 0; x < 128; x += 8)
        for (int y = -128; y < 0; y += 8)
            for (int z = 128; z < 256; z += 8) {
                Leaf leaf;
                leaf.origin = {x, y, z};
                for (int n = 0; n < kLeafVoxels; ++n) leaf.set(n, 0.25f);
                leaves.leaves.push_back(leaf);
            }
    for (const VoxelGridOptions& options : {kExact, with_step(0.25)}) {
        const VoxelGrid a = voxel_grid(tile, options), b = voxel_grid(leaves, options);
        for (const auto& [origin, direction] : rays_through(tile, index_box(tile), 300))
            ASSERT_NEAR(optical_depth(a, origin, direction), optical_depth(b, origin, direction),
                        kLinearRounding);
    }
}

TEST(reference_linear, tile_where_a_larger_node_starts_hides_no_border_of_others) {
    Volume volume;
    volume.tiles.push_back({{0, 0, 0}, 128, 0.25f});
    Leaf leaf;
    leaf.origin = {512, 512, 512};
    leaf.set(0, 2);  // its tent reaches into the seven blocks below
    volume.leaves.push_back(leaf);
    const VoxelGrid grid = voxel_grid(volume, kExact);
    const Box box{{510, 510, 510}, {514, 514, 514}};
    for (const auto& [origin, direction] : rays_through(volume, box, 100)) {
        const double expected = test::brute_linear_depth(volume, origin, direction);
        ASSERT_NEAR(optical_depth(grid, origin, direction), expected, kLinearRounding);
    }
    EXPECT_NEAR(optical_depth(grid, {511.5, 512, 500}, {0, 0, 1}), 1, kLinearRounding);
}

TEST(reference_linear, exact_rule_matches_simpson_under_every_map) {
    for (const auto& [name, map] : test::grid_maps()) {
        SCOPED_TRACE(name);
        Volume volume = leaves_and_tiles(31);
        volume.world_from_index = map;
        const VoxelGrid grid = voxel_grid(volume, kExact);
        for (const Box& box : {Box{{-10, -10, -10}, {33, 18, 18}}, index_box(volume)})
            for (const auto& [origin, direction] : rays_through(volume, box, 60)) {
                const double expected = test::brute_linear_depth(volume, origin, direction);
                ASSERT_NEAR(optical_depth(grid, origin, direction), expected, kLinearRounding);
            }
    }
}

TEST(reference_linear, midpoint_rule_converges_with_the_square_of_the_step) {
    const Volume volume = leaves_and_tiles(32);
    const Box box{{-9, -9, -9}, {17, 17, 17}};
    const VoxelGrid exact = voxel_grid(volume, kExact);
    const auto error = [&](double step) {
        const VoxelGrid grid = voxel_grid(volume, with_step(step));
        double sum = 0;
        for (const auto& [origin, direction] : rays_through(volume, box, 400)) {
            const double e =
                optical_depth(grid, origin, direction) - optical_depth(exact, origin, direction);
            sum += e * e;
        }
        return std::sqrt(sum / 400);
    };
    // White noise with steps to zero everywhere is the worst case: half a percent of T near 10.
    EXPECT_LT(error(0.25), 0.05);
    // The field's slope jumps at each plane of centres, where samples fall at random: the errors of
    // the pieces add like noise, each falling with the square of the step.
    EXPECT_NEAR(error(0.25) / error(0.0625), 16, 6);
}

TEST(reference_linear, sum_over_a_lattice_of_rays_conserves_mass) {
    // Interpolation spreads a voxel's value but keeps its integral: the midpoints of a fine lattice
    // of parallel rays integrate the tents across exactly.
    const Volume volume = [] {
        Volume v = test::random_volume(33);
        v.tiles = {{{24, -8, 0}, 8, 0.5f}};
        return v;
    }();
    const VoxelGrid grid = voxel_grid(volume, kExact);
    double sum = 0;
    for (double x = -9.75; x < 33; x += 0.5)
        for (double y = -9.75; y < 18; y += 0.5)
            sum += 0.25 * optical_depth(grid, {x, y, -30}, {0, 0, 1});
    EXPECT_NEAR(sum, mass(volume), 1e-9 * sum);
}

TEST(reference_linear, border_blocks_do_not_change_the_constant_field) {
    const Volume volume = leaves_and_tiles(34);
    const VoxelGrid plain = voxel_grid(volume);
    auto data = std::make_shared<VoxelGrid::Data>(plain.data());
    data->set_tree(nano_tree(volume, true));
    data->world_corner = data->corner;
    const VoxelGrid bordered{std::move(data)};
    for (const auto& [origin, direction] : rays_through(volume, index_box(volume), 200))
        ASSERT_NEAR(optical_depth(bordered, origin, direction),
                    optical_depth(plain, origin, direction), kLinearRounding);
}

TEST(reference_linear, real_data_are_close_to_their_constant_field) {
    VOG_NEEDS_DATA("smoke.vdb");
    const Volume volume = read_vdb(test::data_dir() / "smoke.vdb");
    const VoxelGrid constant = voxel_grid(volume), exact = voxel_grid(volume, kExact);
    const VoxelGrid quarter = voxel_grid(volume, with_step(0.25));
    const Camera camera = paper_view(world_box(volume));
    const DepthImage a = render_reference({&constant, 1}, camera, 96, 96);
    const DepthImage b = render_reference({&exact, 1}, camera, 96, 96);
    const DepthImage c = render_reference({&quarter, 1}, camera, 96, 96);
    double ab = 0, bc = 0, norm = 0, mean_a = 0, mean_b = 0;
    for (std::size_t i = 0; i < a.depth.size(); ++i) {
        ab += std::pow(a.depth[i] - b.depth[i], 2), bc += std::pow(c.depth[i] - b.depth[i], 2);
        norm += b.depth[i] * b.depth[i];
        mean_a += a.depth[i], mean_b += b.depth[i];
    }
    EXPECT_LT(std::sqrt(ab / norm), 0.03) << "half a voxel apart would give more";
    EXPECT_LT(std::sqrt(bc / norm), 1e-3);
    EXPECT_NEAR(mean_a / mean_b, 1, 2e-3);
    const CameraFrame frame = frame_of(camera, 96, 96);
    for (int n = 8; n < 96; n += 20)
        EXPECT_NEAR(b.at(n, 96 - n),
                    test::brute_linear_depth(volume, frame.eye, frame.direction(n, 96 - n)),
                    1e-6 * (1 + b.at(n, 96 - n)));
}

TEST(reference_linear, gradients_of_a_quadratic_field_are_exact_across_leaves) {
    // Central differences of a quadratic polynomial are its derivatives, which are linear: interpolation keeps them.
    const auto value_at = [](Vec3d p) { return 300 + p.x * p.x + 2 * p.y * p.z - 0.5 * p.z * p.z; };
    const auto gradient_at = [](Vec3d p) { return Vec3d{2 * p.x, 2 * p.z, 2 * p.y - p.z}; };
    Volume volume;
    for (int n = 0; n < 8; ++n) {
        Leaf leaf;
        leaf.origin = {n & 4 ? 0 : -8, n & 2 ? 0 : -8, n & 1 ? 0 : -8};
        for (int at = 0; at < kLeafVoxels; ++at) {
            const Vec3i voxel = leaf.origin + Vec3i{at >> 6, at >> 3 & 7, at & 7};
            leaf.set(at, static_cast<float>(value_at(vec_cast<double>(voxel))));
        }
        volume.leaves.push_back(leaf);
    }
    volume.world_from_index.linear = {{Vec3d{2, 0, 0}, Vec3d{0, 0.5, 0}, Vec3d{0, 0, 1}}};
    VoxelField own;
    own.component.resize(1);
    const LinearVolume grid(volume, own, {Interpolation::linear, 0.25});
    ASSERT_TRUE(grid.own());
    const Vec3d along{3, 0.75, 2.5};  // world
    int samples = 0;
    grid.walk({-9, -1.5, -6}, along, Segment{},
              [&](const LinearVolume::Sample& sample, double t, double) {
                  const Vec3d world = Vec3d{-9, -1.5, -6} + t * along;
                  const Vec3d index{world.x / 2, world.y / 0.5, world.z};
                  for (int axis = 0; axis < 3; ++axis)
                      if (!(std::abs(index[axis] + 0.5) < 6.5)) return true;
                  const Vec3d expected = gradient_at(index), found = sample.gradient();
                  EXPECT_NEAR(found.x, expected.x / 2, 1e-4);
                  EXPECT_NEAR(found.y, expected.y / 0.5, 1e-4);
                  EXPECT_NEAR(found.z, expected.z, 1e-4);
                  ++samples;
                  return true;
              });
    EXPECT_GT(samples, 20);
}

}  // namespace
}  // namespace vog
