// chunk_file.h: a chunk as files: shapes as a compact model, and each field.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "io/site/manifest.h"
#include "io/vogz/rounding.h"
#include "vog/gaussians.h"
#include "vog/vogz.h"

namespace vog::site {

/// Lattices of a model's fields, the same for all of its chunks.
std::vector<vogz::FieldRounding> field_roundings(const Fields& fields, double step);

/// Box of the supports of a chunk's Gaussians, relative to their origin: lower, then upper corner.
/// step  VogzPrecision::step: rounding may move a mean and widen a support by about as many standard deviations
std::array<float, 6> box_of(const Gaussians& chunk, double step);

/// Contents of a chunk's files: shapes, then each field.
/// chunk   nodes, then Gaussians of the model
/// nodes   number of the former
std::vector<std::string> chunk_contents(const Gaussians& chunk, std::size_t nodes,
                                        const VogzPrecision& precision,
                                        const std::vector<vogz::FieldRounding>& fields);

/// A chunk from its files, with all fields.
/// throws  vog::Error for a missing or damaged file
Gaussians read_chunk(const std::filesystem::path& folder, const Row& row,
                     const ManifestModel& model);

/// Allocates the arrays of a model for `count` Gaussians.
void allocate(Gaussians& model, std::size_t count, bool rotated);
/// Copies Gaussians first ... last - 1 of a chunk into a model of allocated arrays, from `slot` on.
void place(const Gaussians& chunk, std::size_t first, std::size_t last, Gaussians& model,
           std::size_t slot);

}  // namespace vog::site
