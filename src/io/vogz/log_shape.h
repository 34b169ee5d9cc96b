// log_shape.h: logarithms of shapes. The symmetric matrix R diag(ln s) R^T of a Gaussian's scales s and rotation R is half
// the logarithm of its covariance: an error of e in any entry changes the Gaussian by about e, wherever its axes point, and
// nearly round ones have no rotation that would need bits.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "vog/gaussians.h"

namespace vog::vogz {

/// Entries xx, yy, zz, xy, xz, yz; the last three are 0 without rotation.
using LogShape = std::array<double, 6>;
inline constexpr std::size_t kDiagonal = 3;  ///< number of entries on the diagonal, the first ones

LogShape log_shape(const Gaussians& model, std::size_t i);
/// Sets scales and, if the model is rotated, rotations of the Gaussians from `begin` on. Scales beyond the range of
/// floats take its ends.
void set_shapes(Gaussians& model, std::size_t begin, std::span<const LogShape> shapes);

}  // namespace vog::vogz
