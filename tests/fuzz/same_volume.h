// same_volume.h: Equality of volumes, and their way through a file.
#pragma once

#include "vog/volume.h"

namespace vog::fuzz {

/// Ends the process unless the volume is valid, or refused for a property that files may have and
/// volumes may not (overlap), by validate().
void expect_valid(const Volume& volume);

/// Ends the process unless write_vdb and read_vdb give the volume again: leaves, masks, values,
/// tiles and transform the same bytes.
void expect_round_trip(const Volume& volume);

}  // namespace vog::fuzz
