// inputs_part.h: distributed reading: this rank's part of the inputs, and figures of the whole.
#pragma once

#include <string>
#include <vector>

#include "files/inputs.h"
#include "pictures/divided_volumes.h"
#include "ranks.h"

namespace vog::mpi {

/// Volumes that add up, or levels of a mesh.
struct VolumesPart {
    Overlap overlap = Overlap::add;
    /// No mesh: one set, of one part of each volume this rank has a share in. A mesh: for each
    /// level, finest first, this rank's part of it as read_level_parts has it.
    std::vector<VolumeSet> sets;
    /// Voxels beside those of `sets`, likewise; of no mesh, [volumes of the set].
    std::vector<VolumeSet> beside{};
    std::vector<std::size_t> sources;  ///< no mesh: index of each volume here among all volumes
    bool by_files = false;             ///< no mesh: volumes go to ranks whole
    // Figures of the whole, the same on every rank.
    std::size_t volumes = 0;  ///< number of volumes
    Box box;                  ///< world units
    Content content;
    std::uint64_t active_voxels = 0;  ///< as stored
    std::vector<std::string> notes;   ///< printed about the inputs

    bool is_mesh() const { return overlap == Overlap::hide; }
};
/// Reads this rank's part; parts are aligned to cubes of `align_voxels`. Notes about replaced
/// values go to the root's standard error.
/// beside  whether voxels beside the part are read
VolumesPart read_volumes_part(const std::vector<std::string>& files,
                              const cli::VolumeInputOptions& options, const Ranks& ranks,
                              int align_voxels = kLeafEdge, bool beside = false);
/// The same for pictures of fields and by value, with a failure on any rank as one of all.
cli::DividedVolumes read_divided_volumes(const std::vector<std::string>& files,
                                         const cli::VolumeInputOptions& options, bool beside,
                                         const Ranks& ranks);

/// This rank's part of the particles, one Gaussian each, with the box of the whole. Every rank
/// reads all particles, as adaptive widths depend on neighbours.
/// notes  as of load_points; the root prints them
Gaussians read_particles_part(const std::vector<std::string>& files,
                              const cli::PointInputOptions& options,
                              const cli::VolumeInputOptions& volume, const Ranks& ranks,
                              std::vector<std::string>& notes);

/// This rank's part of all models, joined to one, with the box of the whole.
Gaussians read_models_part(const std::vector<std::string>& files, const Ranks& ranks,
                           const ValueRules& rules);
/// Prints the number of splats that all ranks left out.
void note_left_out(const ValueNotes& notes, const std::vector<std::string>& files,
                   const Ranks& ranks);

}  // namespace vog::mpi
