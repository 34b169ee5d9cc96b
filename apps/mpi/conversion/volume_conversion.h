// volume_conversion.h: distributed conversion of volumes: one part of the data, and of the model, a rank.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "conversion/convert_run.h"
#include "model_file.h"
#include "ranks.h"
#include "vog/linear.h"

namespace vog::mpi {

/// Model of all ranks, and figures of the whole, the same on every rank.
struct ConvertedVolumes {
    SharedModel model;
    double data_mass = 0;
    cli::MomentTotals totals;
    std::vector<std::string> notes;  ///< printed about the inputs
    /// Lattice of the cells: of the volume, or of a mesh's finest level.
    std::optional<Affine> index_from_world;
};
/// Reads volumes and converts them by parts, with the fields of the options.
/// throws  cli::UsageError for options that only a single process supports
ConvertedVolumes convert_parts(const cli::ConvertArguments& arguments,
                               const cli::VolumeConversion& given, cli::Stages& stages,
                               const Ranks& ranks);

}  // namespace vog::mpi
