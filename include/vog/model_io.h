// vog/model_io.h: models from and to files, by the file's extension.
#pragma once

#include <filesystem>

#include "vog/gaussians.h"
#include "vog/lod.h"
#include "vog/voxel_values.h"

namespace vog {

struct ModelPart;

/// Reads a model: .ply as read_ply (vog/ply.h), .vogz as read_vogz (vog/vogz.h), and splats: .spz (versions 2 to 4), .glb
/// (glTF with KHR_gaussian_splatting), .usda and .usd of text (OpenUSD's ParticleField3DGaussianSplat), whose opacities become
/// densities as those of 3DGS's PLY do. A site's folder (vog/site.h) gives its whole first model.
/// hierarchy  receives the file's hierarchy, or an empty one; null: not read
/// rules      skip_nonfinite: leaves splats out that have a number that is not finite, an error otherwise
/// notes      is increased by their number; null: not counted
/// throws     vog::Error for another extension, and as those
Gaussians read_model(const std::filesystem::path& file, Hierarchy* hierarchy = nullptr,
                     const ValueRules& rules = {}, ValueNotes* notes = nullptr);
/// The same of a part (vog/distributed.h).
Gaussians read_model(const std::filesystem::path& file, const ModelPart& part,
                     const ValueRules& rules, ValueNotes* notes);

/// Writes a model: .ply exactly as write_ply, .vogz rounded as write_vogz does by default.
/// hierarchy  hierarchy of this model; empty: none
/// throws     vog::Error for another extension, and as those
void write_model(const std::filesystem::path& file, const Gaussians& gaussians,
                 const Hierarchy& hierarchy = {});

}  // namespace vog
