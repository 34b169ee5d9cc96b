// vogz_bytes.h: compact models in memory.
#pragma once

#include <string>

#include "vog/vogz.h"

namespace vog::vogz {

/// throws  vog::Error for a step out of range
void require_valid(const VogzPrecision& precision);

/// Bytes of the file that write_vogz would write, without texts on the model's source and method.
/// throws  vog::Error as write_vogz
std::string bytes_of(const Gaussians& gaussians, const VogzOptions& options);

}  // namespace vog::vogz
