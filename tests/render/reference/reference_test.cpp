// reference_test.cpp: The reference renderer against closed forms and brute force.
#include "render/reference/reference.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <ostream>
#include <stdexcept>
#include <vector>

#include "render/splat/splat.h"
#include "support/data.h"
#include "support/random_volume.h"
#include "support/ray_voxels.h"
#include "vog/compare.h"
#include "vog/convert_moments.h"
#include "vog/error.h"
#include "vog/sample.h"
#include "vog/volume_io.h"

namespace vog {
namespace {

// Some hundred pieces of a ray, each rounded at 1e-16 of distances of up to a thousand voxels.
constexpr double kRounding = 1e-12;
// The image is float32: half an ulp is 6e-8.
constexpr double kFloat = 1e-7;

Volume dense_cube(int leaves_per_axis, float value) {
    Volume volume;
    for (int x = 0; x < leaves_per_axis; ++x)
        for (int y = 0; y < leaves_per_axis; ++y)
            for (int z = 0; z < leaves_per_axis; ++z) {
                Leaf leaf;
                leaf.origin = {8 * x, 8 * y, 8 * z};
                for (int n = 0; n < kLeafVoxels; ++n) leaf.set(n, value);
                volume.leaves.push_back(leaf);
            }
    return volume;
}

Volume one_voxel(Vec3i at, float value) {
    Volume volume;
    Leaf leaf;
    leaf.origin = {at.x & ~7, at.y & ~7, at.z & ~7};
    leaf.set(leaf_offset(at.x & 7, at.y & 7, at.z & 7), value);
    volume.leaves.push_back(leaf);
    return volume;
}

/// Length of the ray inside an index box, by slabs.
double chord(const Volume& volume, Vec3d lower, Vec3d upper, Vec3d origin, Vec3d direction) {
    const auto [first, last] = test::IndexRay(volume, origin, direction).cut(lower, upper);
    return (last - first) * length(direction);
}

/// `count` rays: from outside, from inside, along axes, through voxel edges and corners.
std::vector<std::pair<Vec3d, Vec3d>> test_rays(const Volume& volume, Box box, int count,
                                               std::uint64_t seed) {
    test::Random random(seed);
    const Affine& world = volume.world_from_index;
    std::vector<std::pair<Vec3d, Vec3d>> rays;
    for (int i = 0; i < count; ++i) {
        const auto inside = [&] {
            const Vec3d size = box.upper - box.lower;
            return box.lower + Vec3d{random() * size.x, random() * size.y, random() * size.z};
        };
        Vec3d target = inside(), from = inside();
        if (i % 4 != 0) from = target + 2 * box.radius() * normalized(random.in_cube(1));
        if (i % 8 == 1)  // along an axis of the grid
            for (int axis = 0; axis < 3; ++axis)
                if (axis != i / 8 % 3) from[axis] = target[axis];
        rays.push_back({world(from), world.linear * (target - from)});
    }
    return rays;
}

void expect_brute(const Volume& volume, Box box, int count, double tolerance) {
    const VoxelGrid grid = voxel_grid(volume);
    for (const auto& [origin, direction] : test_rays(volume, box, count, 5)) {
        const double expected = test::brute_depth(volume, origin, direction);
        const double depth = optical_depth(grid, origin, direction);
        if (expected == 0) {
            ASSERT_EQ(depth, 0) << "a voxel beside the ray counts";
        }
        ASSERT_NEAR(depth, expected, tolerance * (expected + 1e-3))
            << origin.x << " " << direction.x;
    }
}

TEST(reference, one_voxel_has_the_length_of_its_chord) {
    Volume volume = one_voxel({3, -5, 7}, 0.75f);
    volume.world_from_index.linear = {{Vec3d{0.5, 0, 0}, Vec3d{0, 0.5, 0}, Vec3d{0, 0, 0.5}}};
    const VoxelGrid grid = voxel_grid(volume);
    const Vec3d center = volume.world_from_index({3, -5, 7});
    for (int axis = 0; axis < 3; ++axis)
        for (const double sign : {-1.0, 1.0}) {
            Vec3d along;
            along[axis] = sign;
            EXPECT_NEAR(optical_depth(grid, center - 9.0 * along, along), 0.75 * 0.5, kRounding);
        }
    const Vec3d diagonal{1, 1, 1};
    EXPECT_NEAR(optical_depth(grid, center - 4.0 * diagonal, diagonal), 0.75 * 0.5 * std::sqrt(3),
                kRounding);
    EXPECT_NEAR(optical_depth(grid, center, diagonal), 0.75 * 0.25 * std::sqrt(3), kRounding);
    EXPECT_EQ(optical_depth(grid, center - 4.0 * diagonal, -diagonal), 0) << "behind the eye";
}

TEST(reference, voxel_is_centred_on_its_index) {
    const VoxelGrid grid = voxel_grid(one_voxel({0, 0, 0}, 1));
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-1.0, 1.0}) {
            Vec3d along{1, 1, 1}, in, out;
            along[axis] = 0;
            in[axis] = side * 0.499, out[axis] = side * 0.501;
            EXPECT_GT(optical_depth(grid, in - along, along), 1);
            EXPECT_EQ(optical_depth(grid, out - along, along), 0);
        }
}

TEST(reference, homogeneous_cube_matches_the_slab_chord) {
    for (const auto& [name, map] : test::grid_maps()) {
        Volume volume = dense_cube(3, 0.7f);
        volume.world_from_index = map;
        const VoxelGrid grid = voxel_grid(volume);
        const Box box{{-0.5, -0.5, -0.5}, {23.5, 23.5, 23.5}};
        for (const auto& [origin, direction] : test_rays(volume, box, 400, 1)) {
            const double expected = 0.7f * chord(volume, box.lower, box.upper, origin, direction);
            ASSERT_NEAR(optical_depth(grid, origin, direction), expected, kRounding) << name;
        }
    }
}

TEST(reference, tiles_and_leaves_join_without_gap_or_overlap) {
    // One value in a 136 x 128 x 128 box made of a 128^3 tile, leaves and 8^3 tiles, across the
    // borders of root cells and of lower nodes.
    Volume volume;
    volume.tiles.push_back({{-128, 0, 0}, 128, 0.01f});
    for (int y = 0; y < 128; y += 8)
        for (int z = 0; z < 128; z += 8) {
            if ((y + z) % 16 == 0) {
                volume.tiles.push_back({{0, y, z}, 8, 0.01f});
            } else {
                Leaf leaf;
                leaf.origin = {0, y, z};
                for (int n = 0; n < kLeafVoxels; ++n) leaf.set(n, 0.01f);
                volume.leaves.push_back(leaf);
            }
        }
    sort_nodes(volume);
    const VoxelGrid grid = voxel_grid(volume);
    const Box box{{-128.5, -0.5, -0.5}, {7.5, 127.5, 127.5}};
    for (const auto& [origin, direction] : test_rays(volume, box, 1000, 2)) {
        const double expected = 0.01f * chord(volume, box.lower, box.upper, origin, direction);
        ASSERT_NEAR(optical_depth(grid, origin, direction), expected, kRounding);
    }
}

TEST(reference, one_tile_of_each_size_is_one_box) {
    for (const int edge : {8, 128, 4096}) {
        Volume volume;
        volume.tiles.push_back({{-edge, 0, edge}, edge, 3e-3f});
        const VoxelGrid grid = voxel_grid(volume);
        const Box box = index_box(volume);
        for (const auto& [origin, direction] : test_rays(volume, box, 200, 3)) {
            const double expected = 3e-3f * chord(volume, box.lower, box.upper, origin, direction);
            ASSERT_NEAR(optical_depth(grid, origin, direction), expected, kRounding * edge);
        }
    }
}

TEST(reference, rays_in_faces_and_through_edges_and_corners_count_once) {
    // Origins and directions are exact in binary, so the rays truly lie in voxel faces and edges.
    const VoxelGrid grid = voxel_grid(dense_cube(2, 1));
    for (double y = -0.5; y < 15.5; y += 0.5)
        for (double z = -0.5; z < 15.5; z += 0.5) {
            ASSERT_EQ(optical_depth(grid, {-4, y, z}, {1, 0, 0}), 16) << y << " " << z;
            ASSERT_EQ(optical_depth(grid, {z, y, 20}, {0, 0, -1}), 16) << y << " " << z;
        }
    for (const double start : {-0.5, 0.0, 0.25})
        for (const Vec3d signs : {Vec3d{1, 1, 1}, Vec3d{-1, 1, 1}, Vec3d{1, -1, -1}}) {
            Vec3d origin;
            for (int axis = 0; axis < 3; ++axis)
                origin[axis] = 7.5 - signs[axis] * (8 + start + 0.5);
            ASSERT_NEAR(optical_depth(grid, origin, signs), 16 * std::sqrt(3), kRounding);
        }
    EXPECT_EQ(optical_depth(grid, {15.5, 4, -9}, {0, 0, 1}), 0)
        << "the upper face is not in the cube";
    EXPECT_EQ(optical_depth(grid, {-0.5, 4, -9}, {0, 0, 1}), 16) << "the lower face is";
}

TEST(reference, ray_in_a_face_takes_one_of_the_two_voxels) {
    Volume volume = one_voxel({0, 0, 0}, 1);
    volume.leaves[0].set(leaf_offset(0, 1, 0), 5);
    EXPECT_EQ(optical_depth(voxel_grid(volume), {-3, 0.5, 0}, {1, 0, 0}), 5);
}

TEST(reference, voxelised_ball_has_the_chord_of_a_sphere) {
    Volume volume = dense_cube(8, 1);
    const double radius = 30;
    const Vec3d center{31.5, 31.5, 31.5};
    for (Leaf& leaf : volume.leaves)
        for (int n = 0; n < kLeafVoxels; ++n) {
            const Vec3d d = vec_cast<double>(leaf.origin) +
                            Vec3d{double(n >> 6), double(n >> 3 & 7), double(n & 7)} - center;
            if (length(d) <= radius) continue;
            leaf.mask[static_cast<std::size_t>(n) >> 6] &= ~(std::uint64_t{1} << (n & 63));
            leaf.value[static_cast<std::size_t>(n)] = 0;
        }
    const VoxelGrid grid = voxel_grid(volume);
    double sum = 0, exact_sum = 0;
    for (const auto& [origin, direction] : test_rays(volume, index_box(volume), 2000, 4)) {
        const Vec3d along = normalized(direction), to_center = center - origin;
        const double middle = dot(to_center, along);
        const double miss2 = dot(to_center, to_center) - middle * middle;
        const double half = std::sqrt(std::max(0.0, radius * radius - miss2));
        const double exact = std::max(0.0, middle + half) - std::max(0.0, middle - half);
        const double depth = optical_depth(grid, origin, direction);
        // A voxel is in or out as its centre is: each end is off by half a diagonal along the
        // normal, which a grazing ray stretches to sqrt(2 R sqrt(3)/2) at most.
        ASSERT_NEAR(depth, exact, 2 * std::sqrt(radius * std::sqrt(3)));
        sum += depth, exact_sum += exact;
    }
    EXPECT_NEAR(sum / exact_sum, 1, 5e-3);
}

TEST(reference, random_volumes_match_the_brute_force_under_every_map) {
    for (const auto& [name, map] : test::grid_maps()) {
        SCOPED_TRACE(name);
        Volume volume = test::random_volume(11);
        volume.world_from_index = map;
        expect_brute(volume, {{-9, -9, -9}, {32, 17, 17}}, 250, kRounding);
        expect_brute(volume, index_box(volume), 100, 1e-11);
    }
}

TEST(reference, far_grid_keeps_its_precision) {
    // Index 10^6 of voxels of 1/8: the digits left of positions of 10^6 are 1e-10 voxel.
    Volume near_volume = test::random_volume(3), far_volume = near_volume;
    near_volume.tiles.clear(), far_volume.tiles.clear();
    for (Volume* volume : {&near_volume, &far_volume})
        volume->world_from_index.linear = {
            {Vec3d{0.125, 0, 0}, Vec3d{0, 0.125, 0}, Vec3d{0, 0, 0.125}}};
    const Vec3i far{1'000'000, -1'000'000, 8'000'000};
    for (Leaf& leaf : far_volume.leaves) leaf.origin = leaf.origin + far;
    const VoxelGrid near_grid = voxel_grid(near_volume), far_grid = voxel_grid(far_volume);
    const Vec3d shift = 0.125 * vec_cast<double>(far);
    for (const auto& [origin, direction] : test_rays(near_volume, index_box(near_volume), 400, 6)) {
        const double expected = optical_depth(near_grid, origin, direction);
        ASSERT_NEAR(optical_depth(far_grid, origin + shift, direction), expected, 1e-7);
    }
    expect_brute(far_volume, index_box(far_volume), 100, 1e-7);
}

TEST(reference, depth_does_not_depend_on_the_length_of_the_direction) {
    const VoxelGrid grid = voxel_grid(test::random_volume(1));
    const Vec3d origin{-40, -30, 4}, direction{44, 31, 2};
    const double depth = optical_depth(grid, origin, direction);
    EXPECT_GT(depth, 1);
    EXPECT_NEAR(optical_depth(grid, origin, 1e-3 * direction), depth, kRounding * depth);
}

TEST(reference, inactive_values_do_not_leak) {
    Volume volume = one_voxel({0, 0, 0}, 1);
    volume.leaves[0].value.fill(100);
    volume.leaves[0].value[0] = 1;
    EXPECT_NEAR(optical_depth(voxel_grid(volume), {0, 0, -5}, {0, 0, 1}), 1, kRounding);
}

TEST(reference, empty_volume_gives_zero) {
    const VoxelGrid grid = voxel_grid(Volume{});
    EXPECT_EQ(optical_depth(grid, {0, 0, 0}, {1, 2, 3}), 0);
    Volume hollow;
    hollow.leaves.emplace_back();
    EXPECT_EQ(optical_depth(voxel_grid(hollow), {4, 4, -9}, {0, 0, 1}), 0);
}

TEST(reference, grids_add) {
    Volume a = test::random_volume(21), b = test::random_volume(22);
    b.world_from_index = test::grid_maps()[3].second;
    const std::vector<VoxelGrid> grids{voxel_grid(a), voxel_grid(b)};
    const Camera camera = paper_view({{-9, -9, -9}, {17, 17, 17}});
    const DepthImage both = render_reference(grids, camera, 24, 20);
    const DepthImage first = render_reference({&grids[0], 1}, camera, 24, 20);
    const DepthImage second = render_reference({&grids[1], 1}, camera, 24, 20);
    for (std::size_t i = 0; i < both.depth.size(); ++i)
        ASSERT_NEAR(both.depth[i], first.depth[i] + second.depth[i], 3 * kFloat * both.depth[i]);
}

TEST(reference, pixels_are_the_rays_of_the_camera) {
    const VoxelGrid grid = voxel_grid(test::random_volume(2));
    const Camera camera = paper_view({{-9, -9, -9}, {17, 17, 17}});
    const DepthImage image = render_reference({&grid, 1}, camera, 37, 19);
    const CameraFrame frame = frame_of(camera, 37, 19);
    for (int row = 0; row < 19; ++row)
        for (int column = 0; column < 37; ++column)
            ASSERT_EQ(image.at(column, row),
                      float(optical_depth(grid, frame.eye, frame.direction(column, row))));
    EXPECT_EQ(image.extinction, 1);
}

TEST(reference, same_bytes_for_any_number_of_threads) {
    const VoxelGrid grid = voxel_grid(test::random_volume(2));
    const Camera camera = paper_view({{-9, -9, -9}, {17, 17, 17}});
    const auto render = [&](int threads) {
        const ThreadLimit limit(threads);
        return render_reference({&grid, 1}, camera, 65, 33).depth;
    };
    const auto one = render(1);
    EXPECT_EQ(one, render(2));
    EXPECT_EQ(one, render(0));
}

TEST(reference, progress_grows_to_one_and_may_end_the_call) {
    const VoxelGrid grid = voxel_grid(test::random_volume(2));
    const Camera camera = paper_view({{-9, -9, -9}, {17, 17, 17}});
    double last = 0;
    ReferenceOptions options;
    options.progress = [&](double share) {
        EXPECT_GT(share, last);
        last = share;
    };
    (void)render_reference({&grid, 1}, camera, 70, 40, options);
    EXPECT_EQ(last, 1);
    options.progress = [](double) { throw std::runtime_error("enough"); };
    EXPECT_THROW((void)render_reference({&grid, 1}, camera, 70, 40, options), std::runtime_error);
}

TEST(reference, unusable_input_throws) {
    const VoxelGrid grid = voxel_grid(one_voxel({0, 0, 0}, 1));
    EXPECT_THROW((void)optical_depth(grid, {0, 0, 0}, {0, 0, 0}), Error);
    EXPECT_THROW((void)optical_depth(grid, {NAN, 0, 0}, {0, 0, 1}), Error);
    EXPECT_THROW((void)optical_depth(grid, {0, 0, 0}, {0, INFINITY, 1}), Error);
    EXPECT_THROW((void)render_reference({&grid, 1}, Camera{}, 0, 4), Error);
    Volume volume = dense_cube(1, 1);
    EXPECT_THROW((void)voxel_grid(volume, {Interpolation::linear, -1}), Error);
    EXPECT_THROW((void)voxel_grid(volume, {Interpolation::linear, 1e-4}), Error);
    volume.tiles.push_back({{0, 0, 0}, 8, 1});
    EXPECT_THROW((void)voxel_grid(volume), Error);
    volume.tiles[0].edge = 128;
    EXPECT_THROW((void)voxel_grid(volume), Error);
    volume.tiles[0] = {{1 << 30, 0, 0}, 8, 1};
    EXPECT_THROW((void)voxel_grid(volume), Error);
    volume.tiles.clear();
    volume.world_from_index.linear = {{Vec3d{1, 0, 0}, Vec3d{1, 0, 0}, Vec3d{0, 0, 1}}};
    EXPECT_THROW((void)voxel_grid(volume), Error);
}

TEST(reference, samples_are_the_mean_of_a_larger_picture) {
    // The pixels of a picture n times the size are the n x n parts of this one's.
    const Volume volume = sample_cloud({.size = 64});
    const VoxelGrid grid = voxel_grid(volume);
    const Camera camera = paper_view(world_box(volume));
    constexpr int kWidth = 24, kHeight = 16;
    for (const int n : {1, 2, 5}) {
        const DepthImage fine = render_reference({&grid, 1}, camera, kWidth * n, kHeight * n);
        const DepthImage image =
            render_reference({&grid, 1}, camera, kWidth, kHeight, {.samples = n});
        for (int row = 0; row < kHeight; ++row)
            for (int column = 0; column < kWidth; ++column) {
                double sum = 0;
                for (int part = 0; part < n * n; ++part)
                    sum += double{fine.at(n * column + part % n, n * row + part / n)};
                ASSERT_NEAR(image.at(column, row), sum / (n * n), 1e-5 * (sum / (n * n) + 0.01));
            }
    }
    for (const int bad : {0, -1, 65})
        EXPECT_THROW((void)render_reference({&grid, 1}, camera, 4, 4, {.samples = bad}), Error);
}

/// 64 voxels across a picture of 40 pixels: the model's Gaussians are around a pixel.
TEST(reference, samples_are_what_small_gaussians_are_drawn_as) {
    const Volume volume = sample_cloud({.size = 64});
    const VoxelGrid grid = voxel_grid(volume);
    const Gaussians model = convert_moments(volume, {.block_voxels = 1});
    const Camera camera = paper_view(world_box(volume));
    const DepthImage splat = render_splat(model, camera, 40, 40);
    const DepthImage mean = render_reference({&grid, 1}, camera, 40, 40, {.samples = 8});
    const DepthImage single = render_reference({&grid, 1}, camera, 40, 40);
    const double to_mean = compare(mean, splat).relative_l2;
    EXPECT_LT(to_mean, 0.08);
    EXPECT_LT(to_mean, 0.7 * compare(single, splat).relative_l2);
}

/// One grid of a file of the test data.
struct DataGrid {
    const char *file, *grid;
    friend std::ostream& operator<<(std::ostream& out, const DataGrid& data) {
        return out << data.file << ' ' << data.grid;
    }
};
class reference_data : public testing::TestWithParam<DataGrid> {};

TEST_P(reference_data, real_data_match_the_brute_force_within_1e_5) {
    const auto [file, name] = GetParam();
    VOG_NEEDS_DATA(file);
    VdbOptions options;
    options.grid = name;
    const Volume volume = read_vdb(test::data_dir() / file, options);
    const VoxelGrid grid = voxel_grid(volume);
    const Camera camera = paper_view(world_box(volume));
    const DepthImage image = render_reference({&grid, 1}, camera, 64, 64);
    const CameraFrame frame = frame_of(camera, 64, 64);
    std::vector<double> expected(image.depth.size());
    tbb::parallel_for(0, 64, [&](int row) {
        for (int column = 0; column < 64; ++column)
            expected[static_cast<std::size_t>(64 * row + column)] =
                test::brute_depth(volume, frame.eye, frame.direction(column, row));
    });
    for (std::size_t i = 0; i < expected.size(); ++i)
        ASSERT_NEAR(image.depth[i], expected[i], 1e-5 * expected[i]) << i;
    EXPECT_GT(*std::max_element(expected.begin(), expected.end()), 1);
}

INSTANTIATE_TEST_SUITE_P(files, reference_data,
                         testing::Values(DataGrid{"smoke.vdb", "density"},
                                         DataGrid{"cloud.vdb", "density"},
                                         DataGrid{"fire.vdb", "flames"},
                                         DataGrid{"fire.vdb", "temperature"}));

}  // namespace
}  // namespace vog
