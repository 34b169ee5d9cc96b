// finite_splats.h: splats with numbers that are not finite, which trainers leave behind.
#pragma once

#include <string>

#include "vog/gaussians.h"
#include "vog/voxel_values.h"

namespace vog::exchange {

/// Rules for splats with numbers that are not finite, which trainers leave behind.
struct SplatRules {
    ValueRules values;            ///< skip_nonfinite: leave such splats out
    ValueNotes* notes = nullptr;  ///< is increased by their number; null: not counted
};
/// Removes splats with a number that is not finite, or a rotation of length 0.
/// throws  vog::Error for such a splat, unless the rules accept them; for no splat left
void keep_finite(Gaussians& model, const std::string& where, const SplatRules& rules);

}  // namespace vog::exchange
