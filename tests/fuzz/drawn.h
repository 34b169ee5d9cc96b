// drawn.h: Structures drawn from an input, valid or not: volumes, models.
#pragma once

#include "fuzz_target.h"
#include "vog/gaussians.h"
#include "vog/volume.h"

namespace vog::fuzz {

/// Up to 8 leaves and 2 tiles, near each other or far apart, under any transform. Most are valid:
/// sorted, without duplicates.
Volume drawn_volume(Numbers& numbers);

/// Up to 64 Gaussians of any sizes; most are valid.
Gaussians drawn_model(Numbers& numbers);

/// Up to three scalar fields and a vector field of `count` Gaussians; most are valid.
Fields drawn_fields(Numbers& numbers, std::size_t count);

}  // namespace vog::fuzz
