// voxel_lookup.h: random access to the voxels of a sparse volume by index.
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <utility>

#include "vog/volume.h"

namespace vog {

/// Index over one volume, which must outlive it. Thread-safe.
class VoxelLookup {
  public:
    explicit VoxelLookup(const Volume& volume);

    bool active(Vec3i index) const {
        const Block block = find(index);
        return block.tile || (block.leaf && block.leaf->active(offset_of(index)));
    }
    /// Density; 0 for inactive voxels.
    float value(Vec3i index) const {
        const Block block = find(index);
        if (block.tile) return block.tile->value;
        return block.leaf ? block.leaf->value[static_cast<std::size_t>(offset_of(index))] : 0;
    }
    bool in_tile(Vec3i index) const { return find(index).tile != nullptr; }
    /// Whether any of the voxels lower to upper, both included, is active.
    bool meets(Vec3i lower, Vec3i upper) const;
    /// Whether all of these voxels are active.
    bool covers(Vec3i lower, Vec3i upper) const;

    /// Node around a voxel, whose active ones are not all of a leaf; neither: none.
    struct Block {
        const Leaf* leaf = nullptr;
        const Tile* tile = nullptr;
    };
    Block find(Vec3i index) const;
    static int offset_of(Vec3i index) { return leaf_offset(index.x & 7, index.y & 7, index.z & 7); }

  private:
    struct Hash {
        std::size_t operator()(Vec3i v) const;
    };
    template <class Node>
    using Map = std::unordered_map<Vec3i, const Node*, Hash>;

    static Vec3i origin(Vec3i index, int edge) {
        return {index.x & ~(edge - 1), index.y & ~(edge - 1), index.z & ~(edge - 1)};
    }
    const Tile* tile_at(Vec3i index, int edge) const;
    /// lower, upper  relative to the leaf's origin; clipped to the leaf
    static bool covers(const Leaf& leaf, Vec3i lower, Vec3i upper);
    static bool meets(const Leaf& leaf, Vec3i lower, Vec3i upper);
    static std::pair<Vec3i, Vec3i> inside_leaf(Vec3i lower, Vec3i upper);
    /// Bits of a word of Leaf::mask for voxels lower to upper in y and z.
    static std::uint64_t slab_bits(Vec3i lower, Vec3i upper);

    Map<Leaf> leaves_;
    Map<Tile> small_, middle_, large_;  ///< tiles of 8, 128, 4096 voxels
    Vec3i lower_, upper_;               ///< bounding box of all nodes, both included
};

}  // namespace vog
