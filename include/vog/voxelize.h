// vog/voxelize.h: models back to volumes: averages of the truncated kernels over the cells of a lattice.
//
//   voxel j    = 1 / |cell_j| * integral over cell_j of sigma(x) dx
//   field of j = integral over cell_j of sum_i k_i phi_i dx / integral over cell_j of sum_i k_i dx
//
// sigma, its kernels k_i and their cutoff are those of vog/gaussians.h, phi_i the field's plane inside Gaussian i
// (vog/fields.h), cell_j the voxel at index j, a parallelepiped under a skewed map. Voxels times their volume
// sum up to the model's mass. docs/voxelize.md
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vog/dense.h"
#include "vog/gaussians.h"
#include "vog/progress.h"
#include "vog/volume.h"
#include "vog/voxel_field.h"

namespace vog {

/// Options of voxelize.
struct VoxelizeOptions {
    std::string name = "density";  ///< name of the volume
    /// Sample the model's fields too: all but those that are the measure itself (ScalarField::is_measure).
    bool fields = false;
    std::optional<IndexBox>
        extent{};  ///< voxels outside of it are left out; none: all that mass touches
    /// Largest size of the result, bytes; 0: half of what the system has available, or no limit while a MemoryLimit
    /// (vog/memory.h) is alive.
    std::uint64_t most_bytes = 0;
    Progress progress{};  ///< called with the finished fraction; empty: not
};

/// Result of voxelize.
struct Voxelized {
    Volume volume;                   ///< active where the support of a Gaussian has mass; no tiles
    std::vector<VoxelField> fields;  ///< at the volume's voxels, scalar ones first; empty: none
    double mass = 0;  ///< mass of the model, density times world volume, without periodic images
    double voxel_mass = 0;  ///< mass of the voxels; less than `mass` only outside of the extent
};

/// Map of cubic voxels along the world's axes: the voxel at index 0 is centred on the model's origin, or begins in the lower corner
/// of its periodic box.
/// voxel_size  edge of a voxel, world units, > 0
/// throws      vog::Error unless voxel_size is finite and above 0
Affine voxel_lattice(const Gaussians& model, double voxel_size);

/// Lattice of the finest of some volumes.
/// extent  set to the smallest box of the lattice around the active voxels of all of them; null: not
/// throws  vog::Error for no volume, and with `extent` for one without an active voxel
Affine lattice_like(std::span<const Volume> volumes, std::optional<IndexBox>* extent = nullptr);

/// Volume of a model on a lattice. Each Gaussian's integral over each voxel is in closed form along the axis of the
/// lattice in which it is narrowest, by Gauss-Legendre quadrature along the other two, between the places where faces
/// of voxels meet the surface of the support. The same bytes for any number of threads, with and without a MemoryLimit.
/// model             N Gaussians, valid
/// world_from_index  lattice, any non-singular affine map
/// throws  vog::Error for an invalid or empty model, a singular or non-finite map, voxels beyond index 2^30, a result
///         larger than most_bytes, a density beyond float, no mass within the extent; with options.fields for a model
///         without fields that could be sampled, and for one named as the volume
/// cost    1 us for a Gaussian at a voxel of its support, 0.2 us if wide, on one core; parallel over blocks of voxels
[[nodiscard]] Voxelized voxelize(const Gaussians& model, const Affine& world_from_index,
                                 const VoxelizeOptions& options = {});

/// Volume from which isosurface() (vog/surface.h) cuts a model's smooth surface.
/// voxel_size  edge, world units; 0: one and a half times the median standard deviation of the Gaussians, at least a 256th of the
///             longest edge of the model's box
/// throws      vog::Error as voxelize does
[[nodiscard]] Volume surface_volume(const Gaussians& model, double voxel_size = 0);

/// Difference between two volumes of one lattice, voxel by voxel; densities outside of active voxels are 0.
struct VoxelError {
    double relative_l2 = 0;  ///< sqrt(sum (b - a)^2 / sum a^2) over all voxels
    /// 20 log10(largest a / root mean square of b - a), dB, infinite for equal volumes: squares of all voxels over the
    /// number of active ones of a.
    double psnr_db = 0;
    double mean = 0;   ///< sum |b - a| over a's number of active voxels, divided by the largest a
    double worst = 0;  ///< largest |b - a|, divided by the largest a
};
/// Compares the volume `b` with `a`, the reference. Leaves of `b` may lie in tiles of `a`, its tiles are among those of `a`.
/// throws  vog::Error for different lattices, other tiles, and for an `a` whose densities are all 0
/// cost    O(leaves and tiles)
[[nodiscard]] VoxelError voxel_error(const Volume& a, const Volume& b);
/// Compares a model with volumes of any lattices that do not overlap, the parts of a mesh (Composite, vog/levels.h), in their active
/// voxels alone: the model's averages over the voxels of each. Differences, and the number of voxels, count by the voxels' volumes.
/// throws  vog::Error as voxelize, for a part where the model has no mass, and for densities that are all 0
[[nodiscard]] VoxelError voxel_error(std::span<const Volume> parts, const Gaussians& model);

}  // namespace vog
