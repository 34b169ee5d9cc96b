// kernel_polynomial.h: Line integral of a truncated Gaussian as one square root and a polynomial.
// With u = (k² - m²)/2, m the ray's distance from the mean in standard deviations, and the whole
// segment in front of the eye:
//   integral = e^{-k²/2} sqrt(2 pi / C) e^u erf(sqrt u),   e^u erf(sqrt u) = sqrt(u) P(u)
// with P smooth on [0, k²/2]: neither exponential nor erf is evaluated for a pixel.
#pragma once

#include <vector>

namespace vog {

/// sqrt(pi) e^{-k²/2} P(u) as a polynomial in v = slope · 2u + shift. Times sqrt(2u / C) it is the
/// line integral of a unit peak. Up to degree 8, v is 2u: e^u erf(sqrt u) / sqrt u has a power
/// series of positive terms, so the fit rounds well in these powers and is never negative. For
/// higher degrees v is in [-1, 1]: in powers of 2u the change of basis would lose all digits.
struct KernelPolynomial {
    std::vector<float> coefficient;  ///< of v^0, v^1, ...
    float slope = 1, shift = 0;
    double max_error = 0;  ///< largest error of sqrt(2u) times it, relative to its peak
};

/// Fits the polynomial of lowest degree whose error is below `tolerance` of the peak.
/// cutoff  k, (0, 8]
KernelPolynomial fit_kernel(double cutoff, double tolerance = 2e-6);

}  // namespace vog
