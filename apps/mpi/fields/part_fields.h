// part_fields.h: fields of a distributed model, each rank's at its part of the voxels.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "conversion/convert_run.h"
#include "model_file.h"
#include "ranks.h"
#include "vog/convert_moments.h"
#include "vog/voxel_field.h"

namespace vog::mpi {

/// The fields of --field and the volumes' own values at this rank's part of every input, with the ranges of all ranks.
struct PartFields {
    std::vector<std::vector<std::vector<VoxelField>>> values;  ///< [inputs][fields][volumes]
    std::vector<bool>
        divided;  ///< [inputs] whether tiles are divided because a field varies inside
    std::vector<std::vector<CarriedField>> carried;  ///< [inputs] MomentOptions::carried_fields
    std::vector<std::string> notes;  ///< on fields that cover only a part of an input
    Fields described;                ///< names, units, kinds and ranges
    std::map<std::string, ValueSpread> spreads;
};
/// volumes  [inputs] this rank's part of each; empty ones are removed
PartFields read_part_fields(const cli::ConvertArguments& arguments,
                            std::span<std::vector<Volume>* const> volumes, const Ranks& ranks);

/// Adds the fields to this rank's Gaussians of every input, and describes them in the header. Uniform hard cells have
/// the fields of a single process, byte by byte, unless tiles are divided.
/// cells    [inputs] of the model, MomentReport::cells
/// volumes  as they were read
/// period   MomentOptions::periodic
void add_part_fields(const PartFields& fields, std::span<const std::optional<UniformCells>> cells,
                     std::span<std::vector<Volume>* const> volumes,
                     const std::optional<Box>& period, SharedModel& model);

}  // namespace vog::mpi
