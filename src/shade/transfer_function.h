// transfer_function.h: what shading and its files share about transfer functions.
#pragma once

#include <string>

#include "vog/shade.h"

namespace vog::shading {

/// throws vog::Error unless there is a colour, points are sorted by v, and every number is in [0,
/// 1]
void require_valid(const std::string& where, const TransferFunction& tf);

/// Whether named_transfer_function takes it.
bool is_transfer_function_name(const std::string& name);

/// "gray, viridis, ...", for messages.
std::string transfer_function_name_list();

}  // namespace vog::shading
