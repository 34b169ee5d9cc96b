// vog/dense.h: conversion between dense arrays (simulations, NumPy) and sparse volumes.
// Element (i, j, k) of an array is the voxel at index (x, y, z) = (i, j, k), its value the density
// at the voxel's centre. Strides are free: either order of axes is read in place, without a copy.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "vog/volume.h"
#include "vog/voxel_values.h"

namespace vog {

/// View of a dense array of density in the caller's memory: a box of voxels.
struct DenseBlock {
    const float* value = nullptr;            ///< density of the voxel at `first`, >= 0
    Vec3i size;                              ///< voxels along x, y, z, >= 1
    std::array<std::ptrdiff_t, 3> stride{};  ///< floats to the next voxel along x, y, z
    Vec3i first;                             ///< least index of the box, within +-2^30
    /// Mask of the same box: a voxel is active where it is not 0. Null: where density is above 0.
    const std::uint8_t* active = nullptr;
    std::array<std::ptrdiff_t, 3> active_stride{};  ///< bytes to the next voxel of `active`
};

/// Sparse volume of the active voxels of all blocks. Where blocks overlap, the last one that is
/// active at a voxel counts.
/// world_from_index  from voxel indices to world units, not singular
/// name              name of the volume; error messages begin with it
/// rules             values to accept though they are no density; without a mask, voxels that
///                   become 0 are inactive
/// notes             receives the numbers of changed values; null: not reported
/// throws            vog::Error for a size or index out of range, a singular map, no active voxel,
///                   or densities that are negative or not finite (their count and the first)
/// cost              O(voxels) time, parallel; 2.1 kB for each 8^3 voxels with an active one
[[nodiscard]] Volume volume_from_dense(std::span<const DenseBlock> blocks,
                                       const Affine& world_from_index = {},
                                       const std::string& name = "density",
                                       const ValueRules& rules = {}, ValueNotes* notes = nullptr);

/// Box of voxels.
struct IndexBox {
    Vec3i lower, upper;  ///< least and largest voxel index, both inside
};
/// Smallest box around all active voxels. throws vog::Error for an empty volume
IndexBox active_box(const Volume& volume);

/// Copies a box of voxels into a dense array.
/// first   least index of the box
/// size    voxels along x, y, z, >= 1
/// values  [size.x * size.y * size.z] density, z fastest; 0 where no voxel is active
/// throws  vog::Error for a size below 1, or one that `values` does not fit
void copy_dense(const Volume& volume, Vec3i first, Vec3i size, std::span<float> values);

/// Map from indices to world units for axis-aligned voxels.
/// voxel_size  edges of a voxel, world units, > 0
/// origin      centre of the voxel at index (0, 0, 0), world units
/// throws      vog::Error unless the edges are finite and above 0, and the origin is finite
Affine affine_from_voxels(Vec3d voxel_size, Vec3d origin = {});
/// Map from indices to world units by a 4x4 matrix M: world = M (i, j, k, 1).
/// rows    M by rows, for column vectors: the last row is 0 0 0 1
/// throws  vog::Error for another last row (a matrix for row vectors has its translation there), or
///         a matrix that is singular or not finite
Affine affine_from_matrix(std::span<const double, 16> rows);

}  // namespace vog
