// divided_volumes.h: volumes whose parts lie on several ranks of vog-mpi, with a field at their voxels.
#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <string>
#include <vector>

#include "vog/levels.h"
#include "vog/voxel_field.h"

namespace vog::cli {

/// This rank's part of volumes.
struct DividedVolumes {
    bool is_mesh = false;
    /// No mesh: one set, of a part of each volume, which may be empty. A mesh: for each level with a node on this rank,
    /// its part as the last volume, behind finer levels whose values are 0 (read_level_parts).
    std::vector<VolumeSet> sets;
    std::vector<VolumeSet> beside;  ///< [sets] voxels beside those parts, likewise; empty: not read
    // The same on every rank.
    std::size_t volumes = 0;          ///< of the whole
    std::uint64_t active_voxels = 0;  ///< of the whole, as stored
    Subject subject;                  ///< of the whole
    std::vector<std::string> notes;   ///< printed already
    std::exception_ptr failure{};     ///< of any rank, by which all have failed
};

/// Volumes of this rank that do not hide each other, with a field at their voxels.
struct PartsWithField {
    std::vector<Volume> volumes;
    std::vector<VoxelField> field;  ///< [volumes]
    std::vector<Volume> beside;     ///< [volumes] voxels next to each on its lattice; empty: none
    std::vector<VoxelField> beside_field;  ///< [beside]
    bool overlap = true;                   ///< whether volumes may overlap those of other ranks
};

/// This rank's volumes without voxels that finer levels hide.
/// returns  volumes with those beside them, without fields; none is empty
PartsWithField visible_volumes(DividedVolumes part);

/// Field of a divided picture, the same on every rank.
struct SharedField {
    std::string name, unit;
    bool is_vector = false;
    double lower = 0, upper = 0;
};
struct RenderRanks;
/// Name, kind and range of a field over all ranks.
/// volumes, fields  [volumes] of this rank
/// coverage         of this rank
/// notes            receives the note on a field that covers a part of the voxels alone
/// throws           vog::Error for a field that is active at no voxel of any rank
SharedField shared_field(const std::vector<Volume>& volumes, const std::vector<VoxelField>& fields,
                         const FieldCoverage& coverage, const RenderRanks& ranks,
                         std::vector<std::string>& notes);

}  // namespace vog::cli
