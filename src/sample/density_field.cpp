// density_field.cpp: sampling of a density field: bounds select the leaves that may be occupied,
// which are evaluated in parallel and kept in order.
#include "sample/density_field.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

#include "core/parallel.h"
#include "vog/error.h"

namespace vog::sampling {

namespace {

constexpr int kBlockEdge = 128;  // voxels; largest tile that fits every size

bool before(Vec3i a, Vec3i b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }

/// Leaves to evaluate, and tiles whose constant density is known from bounds.
struct Plan {
    std::vector<Vec3i> leaves;
    std::vector<Tile> tiles;
};

/// Recursive subdivision by bounds.
class Planner {
  public:
    Planner(const DensityField& field, const Affine& world_from_index)
        : field_(field), world_from_index_(world_from_index) {}

    /// Drops the cube of edge^3 voxels at `origin`, makes it a tile or leaf, or divides it.
    void plan(Vec3i origin, int edge, Plan& result) const {
        const Interval range = range_of(origin, edge);
        if (range.upper <= kFaintestDensity) return;
        const bool constant = range.lower == range.upper;
        if (constant && (edge == kBlockEdge || edge == kLeafEdge)) {
            result.tiles.push_back({origin, edge, range.upper});
        } else if (edge == kLeafEdge) {
            result.leaves.push_back(origin);
        } else {
            const int half = edge / 2;
            for (int octant = 0; octant < 8; ++octant)
                plan(origin +
                         Vec3i{octant & 4 ? half : 0, octant & 2 ? half : 0, octant & 1 ? half : 0},
                     half, result);
        }
    }

  private:
    /// Bounds over the sphere around the cube's voxel centres.
    Interval range_of(Vec3i origin, int edge) const {
        const double half = 0.5 * (edge - 1);
        const Vec3d first = world_from_index_(vec_cast<double>(origin));
        const Vec3d center = world_from_index_(vec_cast<double>(origin) + Vec3d{half, half, half});
        return field_.range(vec_cast<float>(center),
                            static_cast<float>(length(center - first)) + 1e-6f);
    }

    const DensityField& field_;
    const Affine& world_from_index_;
};

/// Plans the cube [-1/2, 1/2]^3, block by block.
Plan plan_blocks(const DensityField& field, const Affine& world_from_index, int size) {
    const int half = (size / 2 + kBlockEdge - 1) / kBlockEdge;  // blocks on either side of zero
    const int across = 2 * half;
    std::vector<Plan> blocks(static_cast<std::size_t>(across * across * across));
    const Planner planner(field, world_from_index);
    vog::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t i) {
        const int n = static_cast<int>(i);
        const Vec3i block{n / (across * across) - half, n / across % across - half,
                          n % across - half};
        planner.plan(kBlockEdge * block, kBlockEdge, blocks[i]);
    });

    Plan plan;
    for (const Plan& block : blocks) {
        plan.leaves.insert(plan.leaves.end(), block.leaves.begin(), block.leaves.end());
        plan.tiles.insert(plan.tiles.end(), block.tiles.begin(), block.tiles.end());
    }
    std::sort(plan.leaves.begin(), plan.leaves.end(), before);
    return plan;
}

LeafPoints points_of(Vec3i origin, const Affine& world_from_index) {
    // Without rotation, each coordinate of a voxel centre depends on its own index only.
    std::array<Vec3f, kLeafEdge> center;
    for (int i = 0; i < kLeafEdge; ++i)
        center[static_cast<std::size_t>(i)] =
            vec_cast<float>(world_from_index(vec_cast<double>(origin + Vec3i{i, i, i})));
    LeafPoints points;
    for (std::size_t n = 0; n < kLeafVoxels; ++n) {
        points.x[n] = center[n >> 6].x;
        points.y[n] = center[(n >> 3) & 7].y;
        points.z[n] = center[n & 7].z;
    }
    return points;
}

Leaf evaluated(const DensityField& field, Vec3i origin, const Affine& world_from_index) {
    std::array<float, kLeafVoxels> density;
    field.evaluate(points_of(origin, world_from_index), density);
    Leaf leaf;
    leaf.origin = origin;
    for (int n = 0; n < kLeafVoxels; ++n) {
        const float value = density[static_cast<std::size_t>(n)];
        if (value > kFaintestDensity) leaf.set(n, value);
    }
    return leaf;
}

bool constant(const Leaf& leaf) {
    return leaf.dense() && std::all_of(leaf.value.begin(), leaf.value.end(),
                                       [&](float value) { return value == leaf.value[0]; });
}

}  // namespace

Volume sample_field(const DensityField& field, const std::string& source,
                    const SampleOptions& options) {
    if (options.size < 64 || options.size > 1024)
        throw Error(fmt::format("{}: size {}, expected 64 to 1024 voxels", source, options.size));

    Volume volume;
    volume.name = "density";
    volume.source = source;
    const double voxel = 1.0 / options.size;
    volume.world_from_index.linear = {{{{voxel, 0, 0}, {0, voxel, 0}, {0, 0, voxel}}}};
    volume.world_from_index.translation = {0.5 * voxel, 0.5 * voxel, 0.5 * voxel};

    Plan plan = plan_blocks(field, volume.world_from_index, options.size);
    volume.tiles = std::move(plan.tiles);

    // Reserved for all planned leaves: growing would hold them twice, and unused pages are never
    // touched. Batches bound the evaluated leaves that are not stored yet (4 MB).
    volume.leaves.reserve(plan.leaves.size());
    constexpr std::size_t kBatch = 2048;
    std::vector<Leaf> batch;
    for (std::size_t begin = 0; begin < plan.leaves.size(); begin += kBatch) {
        batch.resize(std::min(kBatch, plan.leaves.size() - begin));
        vog::parallel_for(std::size_t{0}, batch.size(), [&](std::size_t i) {
            batch[i] = evaluated(field, plan.leaves[begin + i], volume.world_from_index);
        });
        for (const Leaf& leaf : batch) {
            if (constant(leaf))
                volume.tiles.push_back({leaf.origin, kLeafEdge, leaf.value[0]});
            else if (leaf.active_count() > 0)
                volume.leaves.push_back(leaf);
        }
        if (options.progress)
            options.progress(static_cast<double>(begin + batch.size()) /
                             static_cast<double>(plan.leaves.size()));
    }
    // Leaves are already sorted.
    std::sort(volume.tiles.begin(), volume.tiles.end(),
              [](const Tile& a, const Tile& b) { return before(a.origin, b.origin); });
    return volume;
}

}  // namespace vog::sampling
