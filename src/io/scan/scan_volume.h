// scan_volume.h: dense images as volumes of leaves, as grids of fields, and described for vog info.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/fields/field_grid.h"
#include "io/grid_choice.h"
#include "vog/scan_io.h"

namespace vog::scan {

/// Reads one grid as density, the value above the background. Voxels of density 0 are inactive; with VdbOptions::ones all voxels with a
/// number are active in an image with negative values, which has no background.
/// throws  vog::Error as read_vdb does
/// departure  receives ScanFile::note behind the file's name; null: not reported
Volume read_scan(const std::filesystem::path& file, const VdbOptions& options, ValueNotes* notes,
                 std::string* departure = nullptr);
/// Names of the grids, in file order.
std::vector<std::string> scan_grid_names(const std::filesystem::path& file);
/// Choice where no grid is named.
DefaultGrid default_grid(const std::filesystem::path& file, const VdbOptions& options);
/// Describes the grids, in file order.
std::vector<VolumeInfo> inspect_scan(const std::filesystem::path& file);
/// Grid of a field: every voxel of the image is active.
field_files::FieldGrid load_scan_field(const FieldSource& source);
/// Name of the grid of a field.
std::string scan_field_name(const FieldSource& source);

}  // namespace vog::scan
