// affine_maps_test.cpp: moments under any affine map; translated, mirrored and rotated volumes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "render/splat/splat.h"
#include "support/moment_volumes.h"
#include "support/random_volume.h"
#include "vog/camera.h"
#include "vog/convert_moments.h"

namespace vog {
namespace {

/// Mass, mean and covariance of a whole.
struct Whole {
    double mass = 0;
    Vec3d mean;
    Mat3 covariance{{Vec3d{}, Vec3d{}, Vec3d{}}};
};

template <class ForEach>
Whole whole_of(const ForEach& for_each) {
    Whole whole;
    for_each([&](double mass, Vec3d at, const Mat3&) {
        whole.mass += mass, whole.mean = whole.mean + mass * at;
    });
    whole.mean = (1 / whole.mass) * whole.mean;
    for_each([&](double mass, Vec3d at, const Mat3& own) {
        const Vec3d d = at - whole.mean;
        for (std::size_t row = 0; row < 3; ++row)
            for (int column = 0; column < 3; ++column)
                whole.covariance.row[row][column] +=
                    mass / whole.mass *
                    (d[static_cast<int>(row)] * d[column] + own.row[row][column]);
    });
    return whole;
}

Whole whole_of_voxels(const Volume& volume) {
    const Mat3& map = volume.world_from_index.linear;
    return whole_of([&](const auto& take) {
        const auto add = [&](Vec3d center, double edge, double value) {
            const double variance = edge * edge / 12;
            const Mat3 box{{Vec3d{variance, 0, 0}, {0, variance, 0}, {0, 0, variance}}};
            take(value * edge * edge * edge * std::abs(determinant(map)),
                 volume.world_from_index(center), map * box * transpose(map));
        };
        for (const Leaf& leaf : volume.leaves)
            for (int n = 0; n < kLeafVoxels; ++n)
                if (leaf.active(n))
                    add(vec_cast<double>(leaf.origin + Vec3i{n >> 6, n >> 3 & 7, n & 7}), 1,
                        double{leaf.value[static_cast<std::size_t>(n)]});
        for (const Tile& tile : volume.tiles) {
            const double middle = 0.5 * (tile.edge - 1);
            add(vec_cast<double>(tile.origin) + Vec3d{middle, middle, middle}, tile.edge,
                double{tile.value});
        }
    });
}

Whole whole_of_model(const Gaussians& model) {
    return whole_of([&](const auto& take) {
        for (std::size_t i = 0; i < model.size(); ++i)
            take(mass(model, i), vec_cast<double>(model.mean[i]), test::covariance(model, i));
    });
}

/// Maps of random_volume.h, times scales from 1e-30 to 1e30 about the origin.
std::vector<std::pair<std::string, Affine>> maps() {
    std::vector<std::pair<std::string, Affine>> all;
    for (const double scale : {1e-30, 1e-10, 1.0, 1e10, 1e30})
        for (auto [name, map] : test::grid_maps()) {
            for (Vec3d& row : map.linear.row) row = scale * row;
            map.translation = scale * map.translation;
            all.emplace_back(name + ' ' + std::to_string(std::log10(scale)), map);
        }
    return all;
}

TEST(affine_maps, mass_mean_and_covariance_are_conserved_by_any) {
    Volume volume = test::random_volume(21, 0.1);
    for (const auto& [name, map] : maps()) {
        volume.world_from_index = map;
        const Whole voxels = whole_of_voxels(volume);
        const double size =
            std::sqrt(voxels.covariance(0, 0) + voxels.covariance(1, 1) + voxels.covariance(2, 2));
        for (const auto& [block, budget] :
             std::vector<std::pair<int, std::size_t>>{{1, 0}, {4, 0}, {32, 0}, {0, 200}}) {
            MomentOptions options;
            options.block_voxels = block, options.budget = budget;
            options.soft_steps = 0, options.mass_threshold = 0;
            const Whole model = whole_of_model(convert_moments(volume, options));
            // Floats of means, scales and densities.
            EXPECT_NEAR(model.mass / voxels.mass, 1, 1e-5) << name << ' ' << block;
            EXPECT_LT(length(model.mean - voxels.mean) / size, 1e-5) << name << ' ' << block;
            for (int row = 0; row < 3; ++row)
                for (int column = 0; column < 3; ++column)
                    EXPECT_NEAR(model.covariance(row, column) / (size * size),
                                voxels.covariance(row, column) / (size * size), 1e-5)
                        << name << ' ' << block;
        }
    }
}

/// Gaussians in the order of their means, with world covariances.
struct Sorted {
    Vec3d mean;
    float density;
    Mat3 covariance;
};
std::vector<Sorted> sorted(const Gaussians& model, const Affine& map) {
    std::vector<Sorted> all;
    for (std::size_t i = 0; i < model.size(); ++i)
        all.push_back({map(vec_cast<double>(model.mean[i])), model.density[i],
                       map.linear * test::covariance(model, i) * transpose(map.linear)});
    std::ranges::sort(all, {}, [](const Sorted& one) {
        // To a thousandth: rounding must not change the order.
        const auto near = [](double at) { return std::llround(1e3 * at); };
        return std::tuple(near(one.mean.x), near(one.mean.y), near(one.mean.z));
    });
    return all;
}

/// Voxels of the volume at new indices.
template <class Map>
Volume moved(const Volume& volume, const Map& map) {
    test::VolumeMaker maker;
    for (const Leaf& leaf : volume.leaves)
        for (int n = 0; n < kLeafVoxels; ++n)
            if (leaf.active(n))
                maker.set(map(leaf.origin + Vec3i{n >> 6, n >> 3 & 7, n & 7}),
                          leaf.value[static_cast<std::size_t>(n)]);
    return maker.finish();
}

TEST(affine_maps, a_moved_mirrored_or_turned_volume_gives_the_moved_model) {
    Volume volume = test::random_volume(22, 0.1);
    volume.tiles.clear();
    volume.world_from_index = {};
    const Mat3 none{};
    const Mat3 mirror{{Vec3d{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    const Mat3 turn{{Vec3d{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}};
    const std::vector<std::tuple<std::string, Affine, Volume>> cases{
        {"moved",
         {none, {64, -128, 8}},
         moved(volume,
               [](Vec3i v) {
                   return v + Vec3i{64, -128, 8};
               })},
        // Index i to -1 - i: faces between cells stay faces.
        {"mirrored",
         {mirror, {-1, 0, 0}},
         moved(volume,
               [](Vec3i v) {
                   return Vec3i{-1 - v.x, v.y, v.z};
               })},
        {"turned", {turn, {-1, 0, 0}}, moved(volume, [](Vec3i v) {
             return Vec3i{-1 - v.y, v.x, v.z};
         })}};
    for (const auto& [name, map, other] : cases)
        for (const int block : {1, 4, 8}) {
            MomentOptions options;
            options.block_voxels = block, options.mass_threshold = 0;
            options.soft_steps = 0;
            const std::vector<Sorted> a = sorted(convert_moments(volume, options), map);
            const std::vector<Sorted> b = sorted(convert_moments(other, options), {});
            ASSERT_EQ(a.size(), b.size()) << name;
            for (std::size_t i = 0; i < a.size(); ++i) {
                ASSERT_LT(length(a[i].mean - b[i].mean), 1e-4) << name << ' ' << block;
                ASSERT_NEAR(a[i].density / b[i].density, 1, 1e-4) << name << ' ' << block;
                for (int row = 0; row < 3; ++row)
                    for (int column = 0; column < 3; ++column)
                        ASSERT_NEAR(a[i].covariance(row, column), b[i].covariance(row, column),
                                    1e-4)
                            << name << ' ' << block;
            }
        }
}

TEST(affine_maps, t_of_a_union_is_the_sum_of_the_parts) {
    const Volume volume = test::random_volume(23, 0.2);
    Volume parts[2];
    for (Volume& part : parts) part.world_from_index = volume.world_from_index;
    for (std::size_t n = 0; n < volume.leaves.size(); ++n)
        parts[n % 2].leaves.push_back(volume.leaves[n]);
    parts[0].tiles = volume.tiles;
    MomentOptions options;
    options.block_voxels = 8, options.soft_steps = 0, options.mass_threshold = 0;
    const Camera camera = orbit_view(world_box(volume), {});
    const auto depth = [&](const Volume& one) {
        return render_splat(convert_moments(one, options), camera, 96, 96);
    };
    const DepthImage all = depth(volume), first = depth(parts[0]), second = depth(parts[1]);
    const float most = *std::ranges::max_element(all.depth);
    for (std::size_t n = 0; n < all.depth.size(); ++n)
        ASSERT_NEAR(all.depth[n], first.depth[n] + second.depth[n], 2e-6f * most);
}

}  // namespace
}  // namespace vog
