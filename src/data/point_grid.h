// point_grid.h: particles sorted in Morton order, on a lattice of their mean spacing.
#pragma once

#include <cstdint>

#include "core/morton.h"
#include "vog/points.h"

namespace vog {

/// Bits of each axis in the 63-bit key of a particle.
inline constexpr int kKeyBits = kMortonAxisBits;

/// Particles sorted by the cells of an octree whose finest level subdivides voxels of about one
/// particle each.
struct PointGrid {
    Vec3d origin;                    ///< world position of the octree's lower corner
    double voxel_size = 1;           ///< world units
    int root_log2 = 0;               ///< the root's edge is 2^root_log2 voxels
    BigVector<std::uint64_t> key;    ///< [N], ascending Morton codes (core/morton.h)
    BigVector<std::uint32_t> index;  ///< [N], particle of each key

    std::size_t size() const { return key.size(); }
    /// Position of the n-th particle in this order, voxels from the origin.
    Vec3d place(const Points& points, std::size_t n) const {
        return (1 / voxel_size) * (points.position[index[n]] - origin);
    }
};

/// points  valid, see validate()
PointGrid point_grid(const Points& points);

/// Particles in the order of OpenVDB's PointDataGrid: by leaf, voxel, then index. The lower corner
/// of voxel [0, 0, 0] is that of the particles' bounding box.
struct LeafOrder {
    Vec3d origin;                        ///< world position of the centre of voxel [0, 0, 0]
    BigVector<std::uint64_t> key;        ///< [N], ascending: node of 4096^3, of 128^3, leaf, voxel
    BigVector<std::uint32_t> index;      ///< [N], particle of each key
    static constexpr int kLeafBits = 9;  ///< lower bits of a key: voxel within its leaf

    /// Voxel index of a key.
    static Vec3i voxel(std::uint64_t key);
};
/// voxel_size  world units, that of a PointGrid
LeafOrder leaf_order(const Points& points, double voxel_size);

}  // namespace vog
