// point_grid.h: particles in Morton order, in units of their own spacing.
#pragma once

#include <cstdint>

#include "core/morton.h"
#include "vog/points.h"

namespace vog {

/// Bits of each axis in the 63-bit key of a particle.
inline constexpr int kKeyBits = kMortonAxisBits;

/// Particles in the order of an octree whose cells are aligned with voxels of about one particle.
struct PointGrid {
    Vec3d origin;                    ///< world position of the octree's lower corner
    double voxel_size = 1;           ///< world units
    int root_log2 = 0;               ///< the root's edge is 2^root_log2 voxels
    BigVector<std::uint64_t> key;    ///< [N], sorted; x the most significant of each three bits
    BigVector<std::uint32_t> index;  ///< [N] of the particle with this key

    std::size_t size() const { return key.size(); }
    /// Position of the n-th in order, in voxels from the origin.
    Vec3d place(const Points& points, std::size_t n) const {
        return (1 / voxel_size) * (points.position[index[n]] - origin);
    }
};

/// points  valid
PointGrid point_grid(const Points& points);

/// The order of a PointDataGrid with this voxel size: leaf by leaf, voxel by voxel, then as given.
/// Voxel [0, 0, 0] has its lower corner at the lower corner of all.
struct LeafOrder {
    Vec3d origin;                    ///< world position of the centre of voxel [0, 0, 0]
    BigVector<std::uint64_t> key;    ///< [N], sorted: root's child, its child, leaf, voxel
    BigVector<std::uint32_t> index;  ///< [N] of the particle
    static constexpr int kLeafBits = 9;

    /// Voxel of a key.
    static Vec3i voxel(std::uint64_t key);
};
/// voxel_size  of a PointGrid
LeafOrder leaf_order(const Points& points, double voxel_size);

}  // namespace vog
