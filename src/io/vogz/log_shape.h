// log_shape.h: logarithms of shapes. The symmetric matrix R diag(ln s) R^T of a Gaussian's scales s and rotation R is half
// the logarithm of its covariance: an error of e in any entry changes the Gaussian by about e, wherever its axes point, and
// nearly round ones have no rotation that would need bits.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vog/gaussians.h"

namespace vog::vogz {

/// Columns of entries xx, yy, zz, xy, xz, yz, a number a Gaussian; the last three are 0 without rotation.
using ShapeEntries = std::array<std::vector<double>, 6>;
inline constexpr std::size_t kDiagonal = 3;  ///< number of entries on the diagonal, the first ones

/// Logarithms of shapes, and the standard deviations along the world's axes.
struct LogShapes {
    ShapeEntries entry;
    std::array<std::vector<double>, 3> extent;
};
/// log_scale  ln of the scales along the Gaussians' own axes, in the order of `index`
LogShapes log_shapes(const Gaussians& model, std::span<const std::uint32_t> index,
                     const std::array<std::vector<double>, 3>& log_scale);
/// Sets scales and, if the model is rotated, rotations of the Gaussians from `begin` on. Scales beyond the range of
/// floats take its ends.
/// spread  receives the geometric mean of each one's scales
void set_shapes(Gaussians& model, std::size_t begin, const ShapeEntries& shapes,
                std::span<double> spread);

/// exp of numbers, in place, with vector instructions. Exponents beyond +-700 count as these.
void take_exponentials(std::span<double> numbers);
/// The whole numbers nearest to factor * x, even ones at halves.
/// x        [N] times factor at most 2^51 either way
/// nearest  receives [N]
void take_nearest(std::span<const double> x, double factor, std::span<std::int64_t> nearest);
/// ln of positive numbers, in place.
void take_logarithms(std::span<double> numbers);

}  // namespace vog::vogz
