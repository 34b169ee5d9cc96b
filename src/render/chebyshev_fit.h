// chebyshev_fit.h: A smooth function on an interval as a polynomial of low degree.
#pragma once

#include <functional>
#include <vector>

namespace vog {

/// Value at v of the polynomial whose coefficients of v^0, v^1, ... these are.
double horner(const std::vector<double>& coefficient, double v);

/// Polynomial in v = slope x - 1, which is in [-1, 1]: powers of x itself would lose all digits.
struct ChebyshevFit {
    std::vector<float> coefficient;  ///< of v^0, v^1, ...
    float slope = 1;
    double max_error = 0;
};
/// Interpolates a function over [0, length] at the zeros of a Chebyshev polynomial.
/// length     > 0
/// tolerance  of the error between them
/// most       coefficients at which the fit ends, whatever its error
/// returns    the fit of lowest degree within the tolerance
ChebyshevFit fit_chebyshev(const std::function<double(double)>& of, double length, double tolerance,
                           std::size_t most);

}  // namespace vog
