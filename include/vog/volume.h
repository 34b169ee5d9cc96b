// vog/volume.h: a sparse density volume as plain data: leaves of 8^3 voxels and constant tiles.
// The layout is OpenVDB's 5-4-3 tree, flattened: what every stage needs of a grid, without its
// library. Readers are in vog/vdb.h; grids in memory come through vog/openvdb.h.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "vog/linear.h"
#include "vog/memory.h"

namespace vog {

inline constexpr int kLeafEdge = 8;      ///< voxels along a leaf
inline constexpr int kLeafVoxels = 512;  ///< voxels in a leaf

/// Offset of a voxel inside its leaf: z fastest, as OpenVDB stores it. x, y, z in [0, 8).
constexpr int leaf_offset(int x, int y, int z) { return (x << 6) | (y << 3) | z; }

/// 8x8x8 voxels, some of them active.
struct Leaf {
    Vec3i origin;                            ///< index of voxel (0,0,0); multiples of 8
    std::array<std::uint64_t, 8> mask{};     ///< bit n of the 512: voxel at offset n is active
    std::array<float, kLeafVoxels> value{};  ///< density by leaf_offset; 0 where inactive

    bool active(int offset) const {
        return (mask[static_cast<std::size_t>(offset) >> 6] >> (offset & 63)) & 1;
    }
    void set(int offset, float density) {
        mask[static_cast<std::size_t>(offset) >> 6] |= std::uint64_t{1} << (offset & 63);
        value[static_cast<std::size_t>(offset)] = density;
    }
    int active_count() const {
        int count = 0;
        for (std::uint64_t word : mask) count += std::popcount(word);
        return count;
    }
    bool dense() const { return active_count() == kLeafVoxels; }
};

/// A cube of edge^3 active voxels of one value. Edge is 8, 128 or 4096: the child sizes of
/// OpenVDB's lower, upper and root nodes.
struct Tile {
    Vec3i origin;  ///< index of its first voxel; multiples of edge
    std::int32_t edge = 8;
    float value = 0;
};

/// A fog volume: density >= 0, finite, zero outside leaves and tiles. A voxel at index i occupies
/// [i-1/2, i+1/2]^3 in index space; world_from_index maps that to world units.
struct Volume {
    BigVector<Leaf> leaves;   ///< no two share an origin; sorted by origin (x, then y, then z)
    std::vector<Tile> tiles;  ///< disjoint from each other and from the leaves; sorted likewise
    Affine world_from_index;  ///< any non-singular affine map
    std::string name;         ///< grid name, "density"
    std::string source;       ///< file it came from, for messages and model headers

    bool empty() const { return leaves.empty() && tiles.empty(); }
};

/// Active voxels, tiles counted by the voxels they stand for.
std::uint64_t active_voxels(const Volume& volume);
/// Voxels of the leaf-padded bounding box: what a dense grid would hold.
std::uint64_t bounding_voxels(const Volume& volume);
/// World volume of one voxel.
double voxel_volume(const Volume& volume);
/// Sum of density times voxel volume.
double mass(const Volume& volume);
/// Leaf-padded index box, voxel faces included: [origin - 1/2, origin + edge - 1/2].
Box index_box(const Volume& volume);
/// World-axis box around index_box: the box of the `paper` view.
Box world_box(const Volume& volume);
/// Sorts leaves and tiles by origin, the order every reader delivers.
void sort_nodes(Volume& volume);
/// Checks what the struct's comments promise. throws vog::Error naming the first offence
void validate(const Volume& volume);

}  // namespace vog
