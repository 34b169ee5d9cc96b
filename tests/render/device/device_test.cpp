// device_test.cpp: Device code that only the GPU uses, run on the host: traversal of voxels, lists of
// hits, sums.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "render/device/any_hit.h"
#include "render/device/launch.h"
#include "render/device/voxels/voxel_walk.h"
#include "render/reference/reference.h"
#include "render/reference/reference_grid.h"
#include "support/scenes.h"
#include "vog/sample.h"

namespace vog::test {

using namespace vog::reference;

namespace {

device::Double3 plain(Vec3d v) { return {v.x, v.y, v.z}; }

/// T along a ray as __closesthit__voxels and __raygen__voxels have it.
double walked(const VoxelGrid& grid, const Volume& volume, Vec3d origin, Vec3d direction) {
    const Affine index_from_world = inverse(volume.world_from_index);
    const Vec3d from = index_from_world(origin) + Vec3d{0.5, 0.5, 0.5};
    const device::NanoVoxels& voxels = grid.data().tree.grid();
    device::VoxelWalk walk = device::walk_of(
        voxels, plain(from), plain(index_from_world.linear * direction), device::RayPart{});
    const device::VoxelAccessor accessor = voxels.getAccessor();
    double sum = 0;
    device::VoxelPiece piece;
    while (walk.next(accessor, piece)) sum += piece.density * (piece.last - piece.first);
    return sum * length(direction);
}

void expect_the_references_depth(const Volume& volume, std::uint64_t seed) {
    const VoxelGrid grid = voxel_grid(volume);
    const Box box = world_box(volume);
    Random random(seed);
    int met = 0;
    for (int n = 0; n < 3000; ++n) {
        const Vec3d target = box.center() + 0.9 * box.radius() * random.in_cube(1);
        const Vec3d origin = n % 3 ? box.center() + 3 * box.radius() * random.in_cube(1)
                                   : box.center() + 0.2 * box.radius() * random.in_cube(1);
        Vec3d direction = target - origin;
        if (n % 5 == 0) direction[n % 3] = 0;
        if (n % 10 == 0) direction[(n + 1) % 3] = 0;
        if (length(direction) == 0) continue;
        const double expected = optical_depth(grid, origin, direction);
        met += expected > 0;
        ASSERT_NEAR(walked(grid, volume, origin, direction), expected, 1e-9 * (1 + expected))
            << "ray " << n;
    }
    EXPECT_GT(met, 500);
}

}  // namespace

TEST(device, voxels_are_walked_to_the_references_depth) {
    expect_the_references_depth(sample_cloud({.size = 64}), 1);
    expect_the_references_depth(sample_explosion({.size = 96}), 2);
}

TEST(device, voxels_of_a_skewed_transform_are_walked_to_the_references_depth) {
    Volume volume = sample_cloud({.size = 64});
    Mat3 skewed;
    skewed.row = {Vec3d{0.3, 0.1, 0}, Vec3d{-0.1, 0.5, 0.05}, Vec3d{0, 0.02, 0.2}};
    volume.world_from_index = {skewed, {100, -7, 3}};
    expect_the_references_depth(volume, 3);
}

TEST(device, a_list_hands_out_every_hit_once_and_in_order) {
    Random random(7);
    std::vector<device::CollectedHit> all;
    for (std::uint32_t n = 0; n < 1000; ++n)  // many entries are equal
        all.push_back({static_cast<float>(static_cast<int>(20 * random())), n});
    for (const int capacity : {1, 7, 64, 256}) {
        device::HitList list;
        list.capacity = capacity;
        std::vector<device::CollectedHit> got;
        while (true) {
            const device::CollectedHit last = got.empty() ? device::CollectedHit{} : got.back();
            device::begin_slab(list, got.empty() ? nullptr : &last);
            for (const auto& hit : all) device::collect(list, hit);
            if (list.count == 0) break;
            device::sort_by_entry(list);
            got.insert(got.end(), list.hit, list.hit + list.count);
        }
        ASSERT_EQ(got.size(), all.size()) << capacity;
        for (std::size_t n = 1; n < got.size(); ++n)
            ASSERT_TRUE(device::before(got[n - 1], got[n])) << capacity;
    }
}

TEST(device, sums_do_not_depend_on_their_order) {
    const double bound = 1e4;
    const int exponent = std::ilogb(bound) + 1;
    const double fine = std::ldexp(1.0, exponent - 80);
    const device::SumRounding rounding{1.5 * 0x1p52 * std::ldexp(1.0, exponent - 50),
                                       1.5 * 0x1p52 * fine, fine};
    Random random(8);
    std::vector<float> taus;
    for (int n = 0; n < 10000; ++n)
        taus.push_back(static_cast<float>(std::exp(random(-40, 0))));  // 1e-17 to 1
    const auto sum = [&] {
        device::DepthSum total{};
        for (const float tau : taus) device::add_depth(total, tau, rounding);
        return total.depth();
    };
    const double forwards = sum();
    std::sort(taus.begin(), taus.end());
    EXPECT_EQ(sum(), forwards);
    std::reverse(taus.begin(), taus.end());
    EXPECT_EQ(sum(), forwards);
    double plain_sum = 0;
    for (const float tau : taus) plain_sum += double{tau};
    EXPECT_NEAR(forwards, plain_sum, 1e-12 * plain_sum);
    // A tau below the finest quantum still gives T > 0.
    device::DepthSum faint{};
    device::add_depth(faint, 1e-30f, rounding);
    EXPECT_GT(faint.depth(), 0);
}

}  // namespace vog::test
