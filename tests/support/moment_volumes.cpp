// moment_volumes.cpp: small volumes for tests of conversions.
#include "support/moment_volumes.h"

#include <cmath>

#include "support/scenes.h"

namespace vog::test {

void VolumeMaker::set(Vec3i index, float density) {
    const Vec3i origin{index.x & ~7, index.y & ~7, index.z & ~7};
    Leaf& leaf = leaves_[{origin.x, origin.y, origin.z}];
    leaf.origin = origin;
    leaf.set(leaf_offset(index.x & 7, index.y & 7, index.z & 7), density);
}

void VolumeMaker::box(Vec3i lower, Vec3i upper, float density) {
    for (int x = lower.x; x <= upper.x; ++x)
        for (int y = lower.y; y <= upper.y; ++y)
            for (int z = lower.z; z <= upper.z; ++z) set({x, y, z}, density);
}

Volume VolumeMaker::finish() const {
    Volume finished = volume;
    for (const auto& [origin, leaf] : leaves_) finished.leaves.push_back(leaf);
    sort_nodes(finished);
    return finished;
}

Volume random_volume(std::uint64_t seed, double share) {
    Random random(seed);
    VolumeMaker maker;
    constexpr int kLeaves = 40, kSpread = 6;
    const auto at = [&] { return static_cast<int>(std::floor(random(-kSpread, kSpread))); };
    for (int n = 0; n < kLeaves; ++n) {
        const Vec3i leaf{8 * at(), 8 * at(), 8 * at()};
        for (int voxel = 0; voxel < kLeafVoxels; ++voxel)
            if (random() < share || voxel == n)
                maker.set(leaf + Vec3i{voxel >> 6, voxel >> 3 & 7, voxel & 7},
                          static_cast<float>(std::pow(10, random(-2, 1))));
    }
    maker.volume.tiles = {{{8 * kSpread, 0, 0}, 8, 0.3f}, {{-128, 128, 0}, 128, 0.001f}};
    const Mat3 turn = matrix_from_quat({0.9f, 0.1f, 0.3f, -0.2f});
    maker.volume.world_from_index = {{{0.3 * turn.row[0], 0.2 * turn.row[1], 0.25 * turn.row[2]}},
                                     {3, -1, 2}};
    return maker.finish();
}

Mat3 covariance(const Gaussians& model, std::size_t i) {
    const Mat3 axes = model.axis_aligned() ? Mat3{} : matrix_from_quat(model.rotation[i]);
    Mat3 scaled = axes;
    for (int axis = 0; axis < 3; ++axis)
        for (int row = 0; row < 3; ++row) scaled(row, axis) *= double{model.scale[i][axis]};
    Mat3 result = scaled * transpose(scaled);
    for (Vec3d& row : result.row) row = variance_within(model.cutoff) * row;
    return result;
}

}  // namespace vog::test
