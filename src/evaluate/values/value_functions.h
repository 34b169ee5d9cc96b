// value_functions.h: transfer functions of values under which evaluations compare pictures by value.
#pragma once

#include <span>
#include <vector>

#include "vog/value_transfer.h"
#include "vog/volume.h"

namespace vog::evaluation {

/// A ramp, three narrow bands and an opaque step over values from 0 to `upper`.
/// upper   > 0: high_value of the data
/// radius  of the data's box, world units, > 0: twelve unit distances
std::vector<ValueTransfer> value_functions(double upper, double radius);

/// 99.9th percentile of the values of active voxels, to 1/65536 of the range from 0 to the largest: single large values
/// do not matter.
/// largest  of the values, > 0
double high_value(std::span<const Volume> volumes, double largest);

}  // namespace vog::evaluation
