// vog/ply.h: Gaussian models as binary PLY files.
// Layout: float32 x y z scale_0..2 [rot_0..3] density, conventions in comment lines; the hierarchy,
// if there is one, as a second element (docs/formats.md).
#pragma once

#include <filesystem>
#include <string>

#include "vog/gaussians.h"
#include "vog/lod.h"

namespace vog {

/// Reads vog's own layout bit for bit, and by property name the two neighbours:
///   3DGS      x y z opacity scale_* rot_* ...: scales are logarithms, opacity a logit of alpha
///   volprim   x y z sigmat scale_* rot_* ...: scales are logarithms, sigmat times a unit-mass pdf
/// Both cut their kernel at 3 standard deviations. Their colours are not density and are not read.
/// throws vog::Error for a missing file, ASCII or big-endian data, unknown property sets, a short
/// or long body, values out of range
/// hierarchy  becomes the one in the file, or empty where there is none; null: not read
Gaussians read_ply(const std::filesystem::path& file, Hierarchy* hierarchy = nullptr);

/// Written beside the file and renamed when whole.
/// hierarchy  of the model, written after it, unless it is empty
void write_ply(const std::filesystem::path& file, const Gaussians& gaussians,
               const Hierarchy& hierarchy = {});

/// Bytes write_ply will write.
std::size_t ply_bytes(const Gaussians& gaussians, const Hierarchy& hierarchy = {});

}  // namespace vog
