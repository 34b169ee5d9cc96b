// field_conversion.h: fields of a conversion: read at the voxels that were converted, and added to their model.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fields/volume_fields.h"
#include "shared/convert_run.h"
#include "vog/convert_fields.h"
#include "vog/gaussians.h"
#include "vog/volume.h"

namespace vog::cli {

/// throws  CLI::ValidationError for --field with inputs that have no fields, and with --no-fields
void check_fields(const ConvertArguments& arguments, FileKind kind);

/// Fields of a command's conversion.
/// own  own_name of all volumes
FieldTexts field_texts(const ConvertArguments& arguments, const std::string& own);

/// Reads the fields of --field and adds them, and the volumes' own values, to a model.
/// volumes  one, or parts of a mesh: what the model was made of; tiles inside which a field varies are
///          divided
/// cells    of the model, MomentReport::cells
/// notes    receives a line for each field that covers only a part of the volumes
void add_fields_of(const FieldTexts& texts, const std::optional<UniformCells>& cells,
                   std::span<Volume> volumes, Gaussians& model, std::vector<std::string>& notes);

}  // namespace vog::cli
