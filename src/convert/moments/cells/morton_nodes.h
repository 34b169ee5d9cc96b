// morton_nodes.h: leaves and tiles of a volume in Morton order, in which the nodes of any aligned
// cube are contiguous.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "convert/moments/gaussian_moments.h"
#include "core/morton.h"
#include "vog/dense.h"
#include "vog/volume.h"

namespace vog::moments {

/// A leaf or a tile.
struct MortonNode {
    Vec3i origin;
    std::int32_t edge = kLeafEdge;
    std::uint32_t index = 0;  ///< into the volume's leaves or tiles
    bool tile = false;
};

/// All leaves and tiles, sorted.
std::vector<MortonNode> morton_nodes(const Volume& volume);

/// Neighbours of leaves. In Morton order the leaves of an aligned block of 4^3 are consecutive: a bit for each place of
/// the block, and a count of bits, find them. A binary search for each neighbour took a tenth of the time of a conversion
/// by windows with fields.
class LeafNeighbours {
  public:
    /// nodes   of a volume, sorted; must outlive the object
    /// period  voxels of a periodic box, whole leaves: leaves at opposite faces are neighbours; none: open
    explicit LeafNeighbours(std::span<const MortonNode> nodes, std::optional<IndexBox> period = {});
    /// Nodes of kLeafEdge voxels that begin at origin + kLeafEdge * side, sides {-1, 0, 1}^3 with z the
    /// fastest; null where there is none.
    using Around = std::array<const MortonNode*, 27>;
    Around around(Vec3i origin) const;

  private:
    static constexpr int kBlockLog2 = 5;  ///< 4 leaves of 8 voxels
    struct Block {
        Vec3i origin;
        std::uint32_t first = 0;   ///< of its nodes
        std::uint64_t leaves = 0;  ///< bit n: a node at morton_place(n)
    };
    const Block* block_at(Vec3i origin) const;
    std::size_t slot_of(Vec3i origin) const;

    /// Origin of the node beside another; of one at a face of the periodic box at the opposite face.
    /// side  {-1, 0, 1}^3
    Vec3i neighbour(Vec3i origin, Vec3i side) const;

    std::span<const MortonNode> nodes_;
    std::optional<IndexBox> period_;
    std::vector<Block> blocks_;
    std::vector<std::uint32_t> slots_;  ///< hash table: index in blocks_ plus 1; 0: none
};

/// Centre in index space of the cube of `edge` voxels whose first voxel is `origin`.
inline Vec3d cube_center(Vec3i origin, double edge) {
    const double half = 0.5 * (edge - 1);
    return vec_cast<double>(origin) + Vec3d{half, half, half};
}

/// Nodes per parallel task. Results are concatenated in the order of tasks: the same bytes for any
/// number of threads.
inline constexpr std::size_t kNodeChunk = 128;

}  // namespace vog::moments
