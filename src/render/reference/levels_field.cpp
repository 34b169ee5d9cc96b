// levels_field.cpp: Extends a level by one layer of voxels, for interpolation across its edge.
#include "render/reference/levels_field.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <tuple>

#include "core/parallel.h"
#include "data/levels/voxel_lookup.h"

namespace vog::reference {

namespace {

constexpr int kAround = kLeafEdge + 2;  // edge of a leaf with one layer of voxels around it

bool by_origin(Vec3i a, Vec3i b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }

/// Origins of the 8^3 blocks that may contain active voxels or voxels of the layer, sorted.
std::vector<Vec3i> blocks_around(const Volume& volume) {
    std::vector<Vec3i> blocks;
    const auto add_around = [&](Vec3i origin, int edge) {
        for (int x = -kLeafEdge; x <= edge; x += kLeafEdge)
            for (int y = -kLeafEdge; y <= edge; y += kLeafEdge)
                for (int z = -kLeafEdge; z <= edge; z += kLeafEdge) {
                    const bool inside = std::min({x, y, z}) >= 0 && std::max({x, y, z}) < edge;
                    if (inside && edge > kLeafEdge) continue;
                    blocks.push_back(origin + Vec3i{x, y, z});
                }
    };
    for (const Leaf& leaf : volume.leaves) add_around(leaf.origin, kLeafEdge);
    for (const Tile& tile : volume.tiles) add_around(tile.origin, tile.edge);
    std::sort(blocks.begin(), blocks.end(), by_origin);
    blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
    return blocks;
}

/// Value of the composite of all levels at a point in world space.
class LevelSampler {
  public:
    explicit LevelSampler(const Levels& levels) {
        for (const std::size_t n : finest_first(levels.volumes)) {
            const Volume& domain = levels.masks.empty() ? levels.volumes[n] : levels.masks[n];
            places_.push_back(
                {inverse(levels.volumes[n].world_from_index), inverse(domain.world_from_index)});
            fields_.emplace_back(levels.volumes[n]);
            domains_.emplace_back(domain);
        }
    }
    /// returns  true if a level is active there
    bool sample(Vec3d world, float& value) const {
        for (std::size_t n = 0; n < places_.size(); ++n) {
            if (!domains_[n].active(nearest(places_[n].domain_from_world(world)))) continue;
            value = fields_[n].value(nearest(places_[n].index_from_world(world)));
            return true;
        }
        return false;
    }

  private:
    struct Place {
        Affine index_from_world, domain_from_world;
    };
    static Vec3i nearest(Vec3d index) {
        constexpr double kFar = 1 << 30;
        Vec3i voxel;
        for (int axis = 0; axis < 3; ++axis)
            voxel[axis] =
                static_cast<std::int32_t>(std::floor(std::clamp(index[axis] + 0.5, -kFar, kFar)));
        return voxel;
    }
    std::vector<Place> places_;
    std::deque<VoxelLookup> fields_, domains_;
};

/// Fills one block of the extended level. returns true if any voxel is active
bool extend_block(const VoxelLookup& level, const Affine& world_from_index,
                  const LevelSampler& sampler, Leaf& block) {
    std::array<float, kAround * kAround * kAround> value{};
    std::array<bool, kAround * kAround * kAround> active{};
    const auto at = [](int x, int y, int z) {
        return static_cast<std::size_t>(((x + 1) * kAround + y + 1) * kAround + z + 1);
    };
    for (int x = -1; x <= kLeafEdge; ++x)
        for (int y = -1; y <= kLeafEdge; ++y)
            for (int z = -1; z <= kLeafEdge; ++z) {
                const Vec3i index = block.origin + Vec3i{x, y, z};
                active[at(x, y, z)] = level.active(index);
                value[at(x, y, z)] = active[at(x, y, z)] ? level.value(index) : 0;
            }
    bool any = false;
    for (int n = 0; n < kLeafVoxels; ++n) {
        const Vec3i local{n >> 6, n >> 3 & 7, n & 7};
        if (active[at(local.x, local.y, local.z)]) {
            block.set(n, value[at(local.x, local.y, local.z)]);
            any = true;
            continue;
        }
        float sum = 0, outside = 0;
        int touching = 0;
        for (int x = local.x - 1; x <= local.x + 1; ++x)
            for (int y = local.y - 1; y <= local.y + 1; ++y)
                for (int z = local.z - 1; z <= local.z + 1; ++z) {
                    sum += value[at(x, y, z)];
                    touching += active[at(x, y, z)];
                }
        if (touching == 0) continue;
        const Vec3d center = world_from_index(vec_cast<double>(block.origin + local));
        if (!sampler.sample(center, outside)) outside = sum / static_cast<float>(touching);
        if (outside <= 0) continue;
        block.set(n, outside);
        any = true;
    }
    return any;
}

}  // namespace

Volume extended_field(const Levels& levels, std::size_t level) {
    const Volume& volume = levels.volumes[level];
    const VoxelLookup lookup(volume);
    const LevelSampler sampler(levels);
    const std::vector<Vec3i> blocks = blocks_around(volume);

    Volume extended;
    extended.world_from_index = volume.world_from_index;
    extended.name = volume.name;
    extended.source = volume.source;
    extended.tiles = volume.tiles;
    constexpr std::size_t kBatch = 4096;  // leaves; bounds the memory held twice
    for (std::size_t first = 0; first < blocks.size(); first += kBatch) {
        std::vector<Leaf> batch(std::min(kBatch, blocks.size() - first));
        std::vector<char> holds(batch.size());
        vog::parallel_for(std::size_t{0}, batch.size(), [&](std::size_t n) {
            batch[n].origin = blocks[first + n];
            if (lookup.in_tile(batch[n].origin)) return;
            holds[n] = extend_block(lookup, volume.world_from_index, sampler, batch[n]);
        });
        for (std::size_t n = 0; n < batch.size(); ++n)
            if (holds[n]) extended.leaves.push_back(batch[n]);
    }
    return extended;
}

}  // namespace vog::reference
