// same_volume.h: Validity of volumes that are read, and their way through a file.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "vog/volume_io.h"

namespace vog::fuzz {

/// Reads every grid of a file, strictly and with all values accepted; ends the process unless each is
/// refused or a valid volume with active voxels.
/// names  of the grids; the first three are read, and the default
/// read   reader of one grid
void expect_valid_grids(std::vector<std::string> names,
                        const std::function<Volume(const VdbOptions&)>& read);

/// Reads every grid of a file as a field at a few voxels, and with ones as density; ends the process
/// unless each is refused or finite.
/// names  of the grids; the first three are read
void expect_finite_fields(const std::filesystem::path& file, std::vector<std::string> names);

/// Ends the process unless write_vdb and read_vdb give the volume again: leaves, masks, values,
/// tiles and transform the same bytes.
void expect_round_trip(const Volume& volume);

}  // namespace vog::fuzz
