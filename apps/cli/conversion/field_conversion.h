// field_conversion.h: fields of a conversion: read at the voxels that were converted, and added to their model.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "conversion/convert_run.h"
#include "conversion/volume_fields.h"
#include "vog/convert_fields.h"
#include "vog/gaussians.h"
#include "vog/volume.h"

namespace vog::cli {

/// Adds the report of another part of a model.
void add_joint(JointReport& all, const JointReport& one);
/// "fitted to density: measured error 0.031 before, 0.042 after, 3 Gaussians without voxels removed"
std::string joint_text(const std::string& field, const JointReport& report);

/// Fields of a command's conversion.
/// own  own_name of all volumes
FieldTexts field_texts(const ConvertArguments& arguments, const std::string& own);

/// Name of the field of --for, before anything is converted; empty: none.
/// volumes  those of the conversion
/// throws   vog::Error for a field that there will not be, and for grids of --field that are not there
std::string joint_field_of(const ConvertArguments& arguments, const FieldTexts& texts,
                           std::span<const Volume> volumes);

/// Reads the fields of --field and adds them, and the volumes' own values, to a model.
/// volumes  one, or parts of a mesh: what the model was made of; tiles inside which a field varies are
///          divided
/// options  cells of the model (MomentReport::cells)
/// notes    receives a line for each field that covers only a part of the volumes
void add_fields_of(const FieldTexts& texts, const FieldOptions& options, std::span<Volume> volumes,
                   Gaussians& model, std::vector<std::string>& notes);

/// Reads the fields of --field and the volumes' own values, and makes the model of them by convert_for_field.
/// levels  one volume, or the parts of `mesh`; tiles inside which a field varies are divided
/// mesh    null: one volume
/// options field of --for
/// notes   as for add_fields_of
Gaussians convert_for_field_of(const FieldTexts& texts, std::span<Volume> levels,
                               const Composite* mesh, const MomentOptions& moments,
                               const FieldOptions& options, MomentReport& report,
                               std::vector<std::string>& notes);

}  // namespace vog::cli
