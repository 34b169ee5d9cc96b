// volume_fields.h: fields at the voxels of volumes, by the texts of --field.
#pragma once

#include <string>
#include <vector>

#include "vog/voxel_field.h"

namespace vog::cli {

/// Reads fields of volumes; one that is a volume's own grid needs no values (its component is empty).
/// texts    of --field (options/field_options.h)
/// pattern  --grid; a '*' in a text stands for what that of the pattern matched in a volume's name
/// volumes  tiles inside which a field varies are divided
/// notes    receives a line for each field that covers only a part of a volume
/// returns  [fields][volumes], of one name for all volumes
/// throws   CLI::ValidationError for a text, vog::Error for what cannot be read
std::vector<std::vector<VoxelField>> read_volume_fields(const std::vector<std::string>& texts,
                                                        const std::string& pattern,
                                                        std::vector<Volume>& volumes,
                                                        std::vector<std::string>& notes);

/// The volumes' own values as fields without values.
std::vector<VoxelField> own_values(const std::vector<Volume>& volumes);

/// Whether a field is the volume's own grid, read without its values.
bool without_values(const VoxelField& field);

}  // namespace vog::cli
