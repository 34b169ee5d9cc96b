// vog/levels.h: adaptive meshes. Several volumes of different voxel size make one field: at every
// point the finest one that is active there counts, and no other.
// Everything happens in world space, so levels may lie at any offset, angle and ratio to each
// other. docs/amr.md has the rules and their accuracy.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vog/volume.h"

namespace vog {

struct Levels {
    std::vector<Volume> volumes;  ///< in any order; equal voxels: the first given counts
    /// None, or one for each volume: its active voxels say where that volume counts. Outside, its
    /// own voxels (ghost cells) are not counted; inside, it hides coarser ones, even where none of
    /// its voxels is active. Without masks a volume counts where it is active.
    std::vector<Volume> masks;
};

/// How volumes combine where they overlap.
enum class Overlap {
    add,   ///< densities, and so optical depths, add up
    hide,  ///< levels of an adaptive mesh: at every point the finest active one counts alone
};

/// Volumes that are drawn or converted together, and how they combine.
struct VolumeSet : Levels {
    Overlap overlap = Overlap::add;  ///< masks count only where volumes hide each other

    bool is_mesh() const { return overlap == Overlap::hide; }
};

/// throws vog::Error for no volume, a number of masks that is neither 0 nor that of volumes, a
///        volume that validate() refuses
void validate(const Levels& levels);

/// Indices of the volumes by voxel volume, finest first; equal ones (to 1e-4) as they are given.
std::vector<std::size_t> finest_first(std::span<const Volume> volumes);

/// Levels as volumes that do not overlap: T, mass and models of the parts add.
struct Composite {
    /// For each level what is left of it, finest first, and after it, where a finer level cuts
    /// through its voxels, those voxels in 2^3 to 8^3 smaller ones. Parts with nothing in them are
    /// left out.
    std::vector<Volume> parts;
    Box box;                          ///< of all levels: their paper view
    std::uint64_t voxels = 0;         ///< of the levels, at least partly seen
    std::uint64_t hidden = 0;         ///< wholly hidden by another level, or outside their mask
    std::uint64_t partly_hidden = 0;  ///< of `voxels`
};

/// Takes from every level what finer ones hide. A voxel that is partly hidden is divided so that
/// the lattice of the finest level over it fits, where it does up to 8 to 1; the density of each
/// piece is weighted with its uncovered share. That share is exact to 1e-4 of a fine voxel where
/// the levels' axes are parallel, whatever their ratio and offset; else it is sampled at 16^3
/// points of the voxel (0.2 % of it). Mass is the sum over uncovered space, to the same accuracy.
/// throws vog::Error as validate() does
/// cost   O(voxels), and some microseconds for each voxel that another level meets
[[nodiscard]] Composite composite(const Levels& levels);

}  // namespace vog
