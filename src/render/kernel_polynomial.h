// kernel_polynomial.h: the truncated Gaussian's line integral as one square root and a polynomial.
// With u = (k² - m²)/2, m the ray's distance from the mean in standard deviations, the whole
// segment in front of the eye:   integral = e^{-k²/2} sqrt(2 pi / C) · e^u erf(sqrt u),   and e^u
// erf(sqrt u) = sqrt(u) P(u) with P smooth on [0, k²/2]: no exponential, no erf.
#pragma once

#include <vector>

namespace vog {

/// sqrt(pi) e^{-k²/2} P(u), as a polynomial in v = slope · 2u + shift. Times sqrt(2u / C) it is the
/// line integral of a unit peak. Up to degree 8 v is 2u itself: e^u erf(sqrt u) / sqrt u has a
/// power series of positive terms, so the fit rounds well in these powers and is never negative.
/// Beyond, v runs over [-1, 1]: in powers of 2u the change of basis would lose the digits.
struct KernelPolynomial {
    std::vector<float> coefficient;  ///< of v^0, v^1, ...
    float slope = 1, shift = 0;
    double max_error = 0;  ///< of sqrt(2u) times it, relative to its peak, at 2u = k²
};

/// The lowest degree whose error stays below `tolerance` of the peak. cutoff in (0, 8].
KernelPolynomial fit_kernel(double cutoff, double tolerance = 2e-6);

}  // namespace vog
