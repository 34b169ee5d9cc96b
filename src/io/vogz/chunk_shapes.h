// chunk_shapes.h: means, shapes and masses of a run of Gaussians as bytes.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io/vogz/columns.h"
#include "io/vogz/rounding.h"

namespace vog::vogz {

/// Most Gaussians of a chunk: 50 to 70 kB.
inline constexpr std::size_t kChunk = 8192;

/// A chunk's bytes, and what else follows from its words.
struct ShapeChunk {
    std::string bytes;
    std::vector<double> spread;  ///< geometric mean of each rounded Gaussian's scales
    std::array<std::vector<double>, 3> extent;  ///< standard deviations along the world's axes
};
/// index  Gaussians with density > 0, in the order of the chunk
ShapeChunk shape_chunk(const Gaussians& model, std::span<const std::uint32_t> index,
                       const ShapeRounding& rounding, Compression compression);

/// Sets Gaussians [begin, begin + spread.size()) of a model of allocated arrays from a chunk's bytes.
/// spread  receives the geometric mean of the scales
/// throws  vog::Error for corrupt bytes
void read_shapes(MemoryBytes& in, const ShapeRounding& rounding, Compression compression,
                 Gaussians& model, std::size_t begin, std::span<double> spread);

}  // namespace vog::vogz
