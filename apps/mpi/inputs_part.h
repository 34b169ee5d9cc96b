// inputs_part.h: this rank's part of the inputs, and what is known of the whole.
#pragma once

#include <string>
#include <vector>

#include "ranks.h"
#include "shared/inputs.h"

namespace vog::mpi {

/// Volumes that add up, or levels of a mesh.
struct VolumesPart {
    Overlap overlap = Overlap::add;
    /// No mesh: one set, of one part of each volume this rank has a share in. A mesh: for each
    /// level, finest first, this rank's part of it as read_level_parts has it.
    std::vector<VolumeSet> sets;
    std::vector<std::size_t> sources;  ///< no mesh: of each volume here, which of them all it is
    bool by_files = false;             ///< no mesh: volumes go to ranks whole
    // Of the whole, the same on every rank.
    std::size_t volumes = 0;  ///< how many
    Box box;
    std::uint64_t active_voxels = 0;  ///< as stored

    bool is_mesh() const { return overlap == Overlap::hide; }
};
/// Reads this rank's part, in parts aligned to cubes of `align_voxels`; the first rank says on
/// standard error what reading changed.
VolumesPart read_volumes_part(const std::vector<std::string>& files,
                              const cli::VolumeInputOptions& options, const Ranks& ranks,
                              int align_voxels = kLeafEdge);

/// One Gaussian a particle, this rank's run of them; the box is the whole's. Every rank reads all
/// particles, since widths come from neighbours, and keeps them until its own are converted.
Gaussians read_particles_part(const std::vector<std::string>& files,
                              const cli::PointInputOptions& options, const std::string& grid,
                              const Ranks& ranks);

/// This rank's part of models joined to one; its box is the whole's.
Gaussians read_models_part(const std::vector<std::string>& files, const Ranks& ranks);

}  // namespace vog::mpi
