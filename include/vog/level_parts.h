// vog/level_parts.h: levels of a mesh shared out among processes.
// Levels hide each other, so a part of one needs what finer ones have over it, and no more.
#pragma once

#include <span>
#include <vector>

#include "vog/files.h"
#include "vog/levels.h"
#include "vog/volume_part.h"

namespace vog {

/// Of every level this part of its leaves, the last volume of a Levels; before it what of finer
/// levels lies over it, all values 0: it hides and adds nothing. So the T of the results, for all
/// parts, is the T of the levels; so is what composite() leaves of their last volumes. Levels
/// without a leaf in the part are left out.
/// volumes  in any order, as Levels has them
/// masks    none, or one for each volume
/// throws   vog::Error as the readers do
std::vector<Levels> read_level_parts(std::span<VolumeReader> volumes, std::span<VolumeReader> masks,
                                     const VolumePart& part, std::uint64_t* negative = nullptr);

}  // namespace vog
