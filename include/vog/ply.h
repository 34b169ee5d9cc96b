// vog/ply.h: Gaussian models as binary PLY files.
// Layout: float32 x y z scale_0..2 [rot_0..3] density, conventions in comment lines; the hierarchy,
// if there is one, as a second element (docs/formats.md).
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "vog/gaussians.h"
#include "vog/hierarchy.h"

namespace vog {

/// Reads vog's own layout bit for bit, and by property name the two neighbours:
///   3DGS      x y z opacity scale_* rot_* ...: scales are logarithms, opacity a logit of alpha
///   volprim   x y z sigmat scale_* rot_* ...: scales are logarithms, sigmat times a unit-mass pdf
/// Both cut their kernel at 3 standard deviations. Their colours are not density and are not read.
/// throws vog::Error for a missing file, ASCII or big-endian data, unknown property sets, a short
/// or long body, values out of range
/// hierarchy  becomes the one in the file, or empty where there is none; null: not read
Gaussians read_ply(const std::filesystem::path& file, Hierarchy* hierarchy = nullptr);

/// One of `count` runs of about as many Gaussians: this is run `index`.
struct ModelPart {
    int index = 0, count = 1;
};
/// A part of a model: the rest of the body is not read. Box and source voxels are the whole's.
/// throws vog::Error as read_ply does, and for an index outside
Gaussians read_ply(const std::filesystem::path& file, const ModelPart& part);

/// What write_ply writes, for those who write one file together: the header of a model of `count`
/// Gaussians that this one describes, and the rows behind it, Gaussian by Gaussian.
std::string ply_header(const Gaussians& description, std::uint64_t count, bool rotated);
std::vector<float> ply_rows(const Gaussians& gaussians, std::size_t first, std::size_t count,
                            bool rotated);

/// A model in several files: {"vog_models": ["model.0.ply", ...]}, beside the index or below it.
void write_model_index(const std::filesystem::path& file, std::span<const std::string> models);
/// throws vog::Error for a missing file, anything else than such an index
std::vector<std::filesystem::path> read_model_index(const std::filesystem::path& file);

/// Written beside the file and renamed when whole.
/// hierarchy  of the model, written after it, unless it is empty
void write_ply(const std::filesystem::path& file, const Gaussians& gaussians,
               const Hierarchy& hierarchy = {});

/// Bytes write_ply will write.
std::size_t ply_bytes(const Gaussians& gaussians, const Hierarchy& hierarchy = {});

}  // namespace vog
