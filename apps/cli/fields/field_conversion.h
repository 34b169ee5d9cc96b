// field_conversion.h: fields of a conversion: read at the voxels that were converted, and added to their model.
#pragma once

#include <string>
#include <vector>

#include "shared/convert_run.h"
#include "vog/gaussians.h"
#include "vog/volume.h"

namespace vog::cli {

/// throws  CLI::ValidationError for --field with inputs that have no fields, and with --no-fields
void check_fields(const ConvertArguments& arguments, FileKind kind);

/// Reads the fields of --field and adds them, and the volumes' own values, to a model.
/// volumes  what the model was made of; tiles inside which a field varies are divided
/// notes    receives a line for each field that covers only a part of the volumes
void add_fields_of(const ConvertArguments& arguments, const MomentOptions& moments,
                   std::vector<Volume>& volumes, Gaussians& model, std::vector<std::string>& notes,
                   const Progress& progress);

}  // namespace vog::cli
