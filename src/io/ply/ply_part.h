// ply_part.h: a part of a PLY model, with rules for splats that other programs left without finite numbers.
#pragma once

#include <filesystem>

#include "io/exchange/finite_splats.h"
#include "vog/distributed.h"
#include "vog/lod.h"

namespace vog::ply {

/// Gaussians of a run of the vertices; ModelPart{}: all.
/// hierarchy  receives the nodes of the file; null: not read, as for a part
/// throws     vog::Error as read_ply does
Gaussians read_part(const std::filesystem::path& file, const ModelPart& part, Hierarchy* hierarchy,
                    const exchange::SplatRules& rules);

}  // namespace vog::ply
