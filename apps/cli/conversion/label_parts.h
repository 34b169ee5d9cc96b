// label_parts.h: --labels: a volume in parts, one for each label.
#pragma once

#include <cstdint>
#include <vector>

#include "conversion/convert_run.h"

namespace vog::cli {

/// Replaces the volume by its parts by --labels, whose field `label` is then one of --field.
/// returns  the share of each in the volume's active voxels
/// throws   UsageError for several volumes, vog::Error for what are no labels of the volume
std::vector<double> divide_by_labels(ConvertArguments& arguments, LoadedVolumes& set);

}  // namespace vog::cli
