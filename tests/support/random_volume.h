// random_volume.h: random volumes with all kinds of leaves and tiles, and all kinds of transforms.
#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "support/scenes.h"
#include "vog/volume.h"

namespace vog::test {

/// Leaf whose voxels are active with probability `fill`, with values in [low, high).
inline Leaf random_leaf(Random& random, Vec3i origin, double fill, double low = 0.01,
                        double high = 2) {
    Leaf leaf;
    leaf.origin = origin;
    for (int offset = 0; offset < kLeafVoxels; ++offset)
        if (random() < fill) leaf.set(offset, static_cast<float>(random(low, high)));
    return leaf;
}

inline Volume volume_of(BigVector<Leaf> leaves) {
    Volume volume;
    volume.leaves = std::move(leaves);
    sort_nodes(volume);
    return volume;
}

/// 3^3 leaves around index 0, from empty to dense, and a tile of each size. Origins of both signs
/// are in two lower nodes per axis; leaves, and tiles of each size, have similar mass.
inline Volume random_volume(std::uint64_t seed) {
    Random random(seed);
    Volume volume;
    volume.source = "folder/random.vdb";
    volume.name = "density";
    for (int x = -1; x < 2; ++x)
        for (int y = -1; y < 2; ++y)
            for (int z = -1; z < 2; ++z) {
                // A fill above 1 gives a dense leaf.
                const double fill = x == 0 && y == 0 ? 1.1 * (z + 1) / 2 : random(0.05, 1.3);
                volume.leaves.push_back(random_leaf(random, {8 * x, 8 * y, 8 * z}, fill));
            }
    volume.tiles = {
        {{24, -8, 0}, 8, 0.5f}, {{128, 0, -128}, 128, 2e-3f}, {{4096, 0, 0}, 4096, 1e-7f}};
    sort_nodes(volume);
    return volume;
}

/// Named transforms: uniform, anisotropic, swapped and mirrored axes, rotated, sheared.
inline std::vector<std::pair<std::string, Affine>> grid_maps() {
    const Mat3 turn = matrix_from_quat({0.8f, 0.2f, -0.4f, 0.4f});
    const auto scaled = [](Mat3 m, Vec3d s) {
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 3; ++column) m(row, column) *= s[column];
        return m;
    };
    const Mat3 swap{{Vec3d{0, -0.5, 0}, Vec3d{0, 0, 2}, Vec3d{0.25, 0, 0}}};
    const Mat3 shear{{Vec3d{0.5, 0.3, 0}, Vec3d{0, 0.4, 0.1}, Vec3d{0.05, 0, 0.7}}};
    return {{"uniform", {scaled({}, {0.1, 0.1, 0.1}), {5, -3, 2}}},
            {"anisotropic", {scaled({}, {0.1, 0.5, 2}), {0, 1, 0}}},
            {"swapped", {swap, {1, 2, 3}}},
            {"rotated", {scaled(turn, {0.3, 0.6, 0.2}), {-1, 0, 1}}},
            {"rotated_mirror", {scaled(turn, {0.3, -0.6, 0.2}), {0, 0, 0}}},
            {"sheared", {shear, {0, 0, 7}}}};
}

}  // namespace vog::test
