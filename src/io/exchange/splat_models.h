// splat_models.h: Gaussians of the splats of other programs: opacities become densities, colours are not read.
#pragma once

#include <filesystem>
#include <string>

#include "io/exchange/finite_splats.h"
#include "vog/gaussians.h"

namespace vog::exchange {

/// Whether a file is splats, by its extension: .spz, .glb, .usda, .usdc, .usd.
bool is_splats(const std::filesystem::path& file);
/// Gaussians of a file, cut off at 3 standard deviations.
/// throws  vog::Error for another extension, a missing, truncated or corrupt file, or what it holds beside splats alone
Gaussians read_splats(const std::filesystem::path& file, const SplatRules& rules = {});

Gaussians read_spz(const std::filesystem::path& file);
Gaussians read_glb(const std::filesystem::path& file);
Gaussians read_usd(const std::filesystem::path& file);
/// Name of the layer of text that usdcat makes of a layer of OpenUSD: .usda.
std::string text_layer(std::filesystem::path file);

}  // namespace vog::exchange
