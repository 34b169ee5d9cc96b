// volume_conversion.h: the conversion of volumes, or of a mesh's levels, by one process.
#pragma once

#include <nlohmann/json.hpp>

#include "conversion/convert_run.h"

namespace vog::cli {

/// Loads volumes, converts them to one model with its fields, and writes it.
/// returns  the report of --json; null where it was printed in words
nlohmann::ordered_json convert_volumes(const ConvertArguments& arguments,
                                       const VolumeConversion& how, Stages& stages);

}  // namespace vog::cli
