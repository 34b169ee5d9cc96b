// vog/levels.h: Levels of an adaptive mesh (AMR): volumes of different voxel size form one field, in
// which only the finest active volume counts at every point.
// Levels are compared in world space and may lie at any offset, angle and ratio to each other.
// docs/amr.md has the rules and their accuracy.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "vog/subject.h"
#include "vog/volume.h"

namespace vog {

/// Levels of one mesh.
struct Levels {
    std::vector<Volume> volumes;  ///< in any order; of equal voxel size, the first one counts
    /// None, or one for each volume, whose active voxels are the domain of that volume. Outside its
    /// domain a volume's own voxels (ghost cells) do not count; inside, it hides coarser volumes,
    /// also where it has no active voxel. Without masks the domain is the active voxels.
    std::vector<Volume> masks;
};

/// Rule for the space where volumes overlap.
enum class Overlap {
    add,   ///< densities, and so optical depths, add up
    hide,  ///< levels of an adaptive mesh: only the finest active one counts at every point
};

/// Volumes that are drawn or converted together, and how they combine.
struct VolumeSet : Levels {
    Overlap overlap = Overlap::add;  ///< masks count only where volumes hide each other

    bool is_mesh() const { return overlap == Overlap::hide; }
};

/// throws vog::Error for no volume, a number of masks that is neither 0 nor that of volumes, a
///        volume that validate() refuses
void validate(const Levels& levels);

/// Indices of the volumes by voxel volume, finest first; equal ones (to 1e-4) keep their order.
std::vector<std::size_t> finest_first(std::span<const Volume> volumes);

/// Whether two voxel volumes are equal, to 1e-4: transforms are often float32.
bool same_voxel_volume(double a, double b);

/// Arrangement of several volumes in space.
struct Arrangement {
    enum class Kind {
        levels,       ///< each finer volume divides coarser voxels evenly and lies within their box
        parts,        ///< no two volumes overlap: parts of one field
        quantities,   ///< grid names that differ in more than digits
        overlapping,  ///< an overlap that levels do not have: time steps, copies
    };
    Kind kind = Kind::levels;
    std::string text;  ///< one line: "3 volumes are 3 levels of one mesh: ..."

    /// Whether volumes may hide each other: nothing but coarser levels is hidden.
    bool is_mesh() const { return kind == Kind::levels || kind == Kind::parts; }
};

/// Finds how volumes lie to each other by names, lattices and active voxels. Levels have voxels
/// that divide those of all coarser levels into whole numbers, faces on faces, and lie within the
/// box of the coarser levels, to a leaf; volumes of one voxel size must not overlap. Masks are
/// not considered.
/// throws vog::Error as validate() does
/// cost   O(nodes); the voxels of nodes that may overlap, up to the first that do
[[nodiscard]] Arrangement arrangement_of(const Levels& levels);

/// Levels as volumes that do not overlap, so that T, mass and models of the parts add.
struct Composite {
    /// Visible voxels of each level, finest first; after each level those of its voxels that a
    /// finer level hides in part, divided into 2^3 to 8^3 smaller ones. Empty parts are left out.
    std::vector<Volume> parts;
    Box box;                          ///< world box of all levels, for the paper view
    Content content;                  ///< Part of all levels that is shown
    std::uint64_t voxels = 0;         ///< voxels of the levels that are visible at least in part
    std::uint64_t hidden = 0;         ///< voxels hidden by another level, or outside their mask
    std::uint64_t partly_hidden = 0;  ///< voxels counted in `voxels` that are hidden in part
};

/// Removes from every level the space that finer levels hide. A partly hidden voxel is divided
/// along the lattice of the finest level over it, where that fits at up to 8 to 1; the density of
/// each piece is multiplied by its uncovered fraction, which is exact to 1e-4 of a fine voxel
/// where the levels' axes are parallel, for any ratio and offset; else sampled at 16^3 points
/// of the voxel (error 0.2 %). Mass is the integral over uncovered space, to the same accuracy.
/// throws vog::Error as validate() does
/// cost   O(voxels), and some microseconds for each voxel that another level overlaps
[[nodiscard]] Composite composite(const Levels& levels);

}  // namespace vog
