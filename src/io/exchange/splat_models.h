// splat_models.h: Gaussians of the splats of other programs: opacities become densities, colours are not read.
#pragma once

#include <filesystem>
#include <string>

#include "vog/gaussians.h"
#include "vog/voxel_values.h"

namespace vog::exchange {

/// Whether a file is splats, by its extension: .spz, .glb, .usda, .usdc, .usd.
bool is_splats(const std::filesystem::path& file);
/// Rules for splats with numbers that are not finite, which trainers leave behind.
struct SplatRules {
    ValueRules values;            ///< skip_nonfinite: leave such splats out
    ValueNotes* notes = nullptr;  ///< is increased by their number; null: not counted
};
/// Removes splats with a number that is not finite, or a rotation of length 0.
/// throws  vog::Error for such a splat, unless the rules accept them; for no splat left
void keep_finite(Gaussians& model, const std::string& where, const SplatRules& rules);

/// Gaussians of a file, cut off at 3 standard deviations.
/// throws  vog::Error for another extension, a missing, truncated or corrupt file, or what it holds beside splats alone
Gaussians read_splats(const std::filesystem::path& file, const SplatRules& rules = {});

Gaussians read_spz(const std::filesystem::path& file);
Gaussians read_glb(const std::filesystem::path& file);
Gaussians read_usd(const std::filesystem::path& file);

}  // namespace vog::exchange
