// unit_range.h: A transfer function of V from points that a file states at values.
#pragma once

#include "vog/value_transfer.h"

namespace vog::shading {

/// Points at values become shares of their range, V in [0, 1], clipped with interpolated points where lines cross the
/// ends; points at shares stay as they are.
TransferFunction over_unit_range(const TransferPoints& read);

}  // namespace vog::shading
