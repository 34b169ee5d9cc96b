// value_functions.h: transfer functions of values under which pictures by value are compared.
#pragma once

#include <span>
#include <vector>

#include "vog/value_transfer.h"
#include "vog/volume.h"
#include "vog/voxel_field.h"

namespace vog::comparison {

/// Values that transfer functions are made for, in the field's unit.
struct ValueRange {
    double lower = 0, upper = 0;
};
/// 0.1st and 99.9th percentile of a scalar field over active voxels, to 1/65536 of its range: single extreme values do not
/// matter. Without negative values 0 is the lower end of a measure.
/// volumes  of the field; a tile counts as its voxels
/// field    [volumes] with its ranges
ValueRange value_range(std::span<const Volume> volumes, std::span<const VoxelField> field);

/// A ramp, three narrow bands and an opaque step over a range.
/// range   lower < upper
/// radius  of the data's box, world units, > 0: twelve unit distances
std::vector<ValueTransfer> value_functions(const ValueRange& range, double radius);

}  // namespace vog::comparison
