// vog/dense.h: dense arrays to sparse volumes and back: what simulations and NumPy hold.
// Element (i, j, k) of an array is the voxel at index (i, j, k) = (x, y, z); its value is that of
// the voxel's centre. Strides are free, so that either order of axes is read where it lies.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "vog/volume.h"

namespace vog {

/// A box of voxels in someone else's memory.
struct DenseBlock {
    const float* value = nullptr;            ///< of the voxel at `first`
    Vec3i size;                              ///< voxels along x, y, z
    std::array<std::ptrdiff_t, 3> stride{};  ///< elements to the next voxel along x, y, z
    Vec3i first;                             ///< index of the first voxel
    const std::uint8_t* active = nullptr;    ///< not 0: active; null: the voxels above 0 are
    std::array<std::ptrdiff_t, 3> active_stride{};
};

/// The active voxels of all blocks as one volume; where blocks overlap the later one counts, where
/// it is active.
/// name    of the volume, and what an error begins with
/// throws  vog::Error for a size or index out of range, a singular map, no active voxel, and values
///         that are negative or not finite: how many, and which is the first
/// cost    O(voxels) time, parallel; 2.1 kB for each 8^3 voxels with an active one
[[nodiscard]] Volume volume_from_dense(std::span<const DenseBlock> blocks,
                                       const Affine& world_from_index = {},
                                       const std::string& name = "density");

/// Voxels lower to upper, both included.
struct IndexBox {
    Vec3i lower, upper;
};
/// The least box around all active voxels. throws vog::Error for an empty volume
IndexBox active_box(const Volume& volume);

/// Writes size.x * size.y * size.z values from the voxel `first` on, z fastest; 0 where none is
/// active. throws vog::Error for a size below 1
void copy_dense(const Volume& volume, Vec3i first, Vec3i size, std::span<float> values);

/// Voxels of one size: index 0 is centred on `origin`.
/// throws vog::Error unless the edges are finite and above 0, and the origin finite
Affine affine_from_voxels(Vec3d voxel_size, Vec3d origin = {});
/// 4x4 by rows, for column vectors: world = M (i, j, k, 1). throws vog::Error unless its last row
/// is 0 0 0 1 (a matrix for row vectors has the translation there) and it is invertible
Affine affine_from_matrix(std::span<const double, 16> rows);

}  // namespace vog
