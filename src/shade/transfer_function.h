// transfer_function.h: validation and names of transfer functions.
#pragma once

#include <string>
#include <vector>

#include "vog/shade.h"

namespace vog::shading {

/// throws vog::Error unless there is a colour, v is sorted, and all numbers are in [0, 1]
void require_valid(const std::string& where, const TransferFunction& tf);

/// The colours from v = first on, < 1, over [0, 1].
std::vector<ColorPoint> colors_from(const std::vector<ColorPoint>& colors, float first);

/// Whether named_transfer_function accepts the name.
bool is_transfer_function_name(const std::string& name);

/// "gray, viridis, ...", for messages.
std::string transfer_function_name_list();

}  // namespace vog::shading
