// vog/ply.h: Gaussian models as binary PLY files.
// Layout: float32 x y z scale_0..2 [rot_0..3] density per Gaussian, conventions in comment lines; a
// hierarchy (vog/lod.h: coarser Gaussians for distant views) as a second element. docs/formats.md
#pragma once

#include <filesystem>
#include <string>

#include "vog/gaussians.h"
#include "vog/lod.h"

namespace vog {

/// Reads a model: vog's own layout bit for bit, and two others, recognised by property names:
///   3DGS      x y z opacity scale_* rot_* ...: scales are logarithms, opacity a logit of alpha
///   volprim   x y z sigmat scale_* rot_* ...: scales are logarithms, sigmat times a unit-mass pdf
/// These two cut their kernel at 3 standard deviations; their colours are not read.
/// hierarchy  receives the file's hierarchy, or an empty one; null: not read
/// throws     vog::Error for a missing file, ASCII or big-endian data, unknown property sets, a
///            short or long body, values out of range
Gaussians read_ply(const std::filesystem::path& file, Hierarchy* hierarchy = nullptr);

/// Whether a file is a model of the length that its header states; values are not read.
bool is_whole_ply(const std::filesystem::path& file);

/// Writes a model in vog's own layout, beside the file, renamed when whole.
/// hierarchy  hierarchy of this model, written behind it; empty: none
/// throws     vog::Error for an invalid model or hierarchy, or if the file cannot be written
void write_ply(const std::filesystem::path& file, const Gaussians& gaussians,
               const Hierarchy& hierarchy = {});

/// Size of the file that write_ply writes, bytes.
std::size_t ply_bytes(const Gaussians& gaussians, const Hierarchy& hierarchy = {});

}  // namespace vog
