// volume_fields.h: fields at the voxels of volumes, by the texts of --field.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "vog/convert_fields.h"
#include "vog/voxel_field.h"

namespace vog::cli {

/// Name of the field of volumes' own values: that of their grid, `density` where it has none or they
/// differ.
std::string own_name(std::span<const Volume> volumes);

/// Fields of volumes, and how the volumes were read.
struct FieldTexts {
    std::vector<std::string> texts;  ///< of --field (options/field_options.h)
    /// --grid; a '*' in a text stands for what that of the pattern matched in a volume's name.
    std::string pattern;
    std::vector<std::string> inputs;  ///< files of the volumes, which know their printable names
    bool ones = false;                ///< volumes count voxels: their values are read as a field
    /// Name of a field of the volumes' own values, unless a text names them or has that name; empty: none.
    std::string own{};
    /// The text whose labels divide the volumes, which are parts of one then: fields may miss a part, and labels are 0 beyond their grid.
    std::string labels{};
};
/// Names of the fields that read_volume_fields would return, from the files' lists of grids.
/// throws   as there for texts, and for files and grids that are not there
std::vector<FieldName> names_of(const FieldTexts& fields, std::span<const Volume> volumes);

/// Reads fields of volumes; one that is the measure's own values has an empty component.
/// volumes  tiles inside which a field varies are divided
/// notes    receives a line for each field that covers only a part of a volume
/// coverage [fields] receives sums over the volumes, in place of notes and errors about them; null: whole volumes
/// returns  [fields][volumes], of one name for all volumes
/// throws   UsageError for a text, vog::Error for what cannot be read
std::vector<std::vector<VoxelField>> read_volume_fields(
    const FieldTexts& fields, std::span<Volume> volumes, std::vector<std::string>& notes,
    std::vector<FieldCoverage>* coverage = nullptr);

/// The volumes' own values as fields without values.
std::vector<VoxelField> own_values(const std::vector<Volume>& volumes);

/// Whether a field is the measure's own values, without a copy.
bool without_values(const VoxelField& field);

}  // namespace vog::cli
