// vog/volume.h: sparse density volumes as plain data: leaves of 8^3 voxels and constant tiles.
// The layout is OpenVDB's 5-4-3 tree, flattened, so that no stage but reading and writing needs its
// library. A voxel is active where the volume has a value; all other space has density 0. Files are
// read by vog/volume_io.h, OpenVDB grids in memory by vog/openvdb.h.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "vog/linear.h"
#include "vog/memory.h"
#include "vog/subject.h"

namespace vog {

inline constexpr int kLeafEdge = 8;      ///< edge of a leaf, voxels
inline constexpr int kLeafVoxels = 512;  ///< voxels in a leaf, kLeafEdge^3

/// Offset of a voxel inside its leaf, [0, 512), z fastest, as OpenVDB stores it.
/// x, y, z  voxels from the leaf's origin, [0, 8)
constexpr int leaf_offset(int x, int y, int z) { return (x << 6) | (y << 3) | z; }

/// Block of 8x8x8 voxels, each active or not.
struct Leaf {
    Vec3i origin;  ///< index of the voxel at offset 0; multiples of 8
    /// Active voxels: bit n & 63 of word n >> 6 is that of the voxel at offset n.
    std::array<std::uint64_t, 8> mask{};
    std::array<float, kLeafVoxels> value{};  ///< density by leaf_offset, >= 0; 0 where inactive

    /// Whether the voxel at `offset` is active.
    bool active(int offset) const {
        return (mask[static_cast<std::size_t>(offset) >> 6] >> (offset & 63)) & 1;
    }
    /// Makes the voxel at `offset` active, with this density, >= 0.
    void set(int offset, float density) {
        mask[static_cast<std::size_t>(offset) >> 6] |= std::uint64_t{1} << (offset & 63);
        value[static_cast<std::size_t>(offset)] = density;
    }
    /// Number of active voxels, [0, 512].
    int active_count() const {
        int count = 0;
        for (std::uint64_t word : mask) count += std::popcount(word);
        return count;
    }
    /// Whether all 512 voxels are active.
    bool dense() const { return active_count() == kLeafVoxels; }
};

/// Cube of edge^3 active voxels of one density.
struct Tile {
    Vec3i origin;           ///< least index of its voxels; multiples of `edge`
    std::int32_t edge = 8;  ///< voxels: 8, 128 or 4096, the children of OpenVDB's upper nodes
    float value = 0;        ///< density of every voxel, >= 0
};

/// Fog volume: density >= 0, finite, zero outside leaves and tiles. The voxel at index i occupies
/// [i - 1/2, i + 1/2]^3 in index space. Density times the extinction, a factor chosen at render
/// time, is per world unit of length.
struct Volume {
    BigVector<Leaf> leaves;  ///< no two of one origin; sorted by origin (x, then y, then z)
    std::vector<Tile>
        tiles;  ///< disjoint from each other and from the leaves; sorted in the same way
    Affine world_from_index;  ///< any non-singular affine map, from indices to world units
    std::string name;         ///< grid name: "density"
    std::string source;       ///< file of origin, for messages and model headers; empty: none
    Standing standing{};      ///< how the data stand, where the file says or implies it
    Units units{};            ///< as the file states them
    /// Value of empty space in the file, as air in a scan: densities are the file's values minus this.
    double background = 0;
    /// Whether it is a dense image of a scan (vog/scan_io.h): models follow its values by default (resolved_joint_field).
    bool is_image = false;

    /// Whether there is neither a leaf nor a tile.
    bool empty() const { return leaves.empty() && tiles.empty(); }
};

/// Number of active voxels; a tile counts edge^3.
std::uint64_t active_voxels(const Volume& volume);
/// Number of voxels of index_box, the size of a dense grid over leaves and tiles.
std::uint64_t bounding_voxels(const Volume& volume);
/// Volume of one voxel, cubic world units, > 0.
double voxel_volume(const Volume& volume);
/// Mass: the sum over active voxels of density times voxel volume.
double mass(const Volume& volume);
/// Box around all leaves and tiles in index space, to the outer faces of their voxels; a node
/// reaches from origin - 1/2 to origin + edge - 1/2. Empty for an empty volume.
Box index_box(const Volume& volume);
/// Axis-aligned box around index_box in the world, world units. Views are framed by it.
Box world_box(const Volume& volume);
/// Sorts leaves and tiles by origin (x, then y, then z), the order that readers deliver.
void sort_nodes(Volume& volume);
/// Checks order, origins and edges of nodes, values and the transform against the ranges above;
/// overlap of tiles is not checked.
/// throws  vog::Error naming the source and the first offence
void validate(const Volume& volume);

}  // namespace vog
