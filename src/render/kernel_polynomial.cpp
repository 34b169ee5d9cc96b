// kernel_polynomial.cpp: Near-minimax polynomial of the kernel, in powers of its variable.
#include "render/kernel_polynomial.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "render/chebyshev_fit.h"

namespace vog {

namespace {

/// sqrt(pi) e^{-k²/2} e^u erf(sqrt u) / sqrt u, with its limit 2 e^{u-k²/2} at u = 0.
double kernel(double u, double cutoff) {
    const double scale = std::exp(u - 0.5 * cutoff * cutoff) / std::numbers::inv_sqrtpi;
    constexpr double kSmall = 1e-8;  // erf(x)/x = 2/sqrt(pi) (1 - x²/3 + ...): exact to 3e-9 here
    if (u < kSmall) return scale * 2 * std::numbers::inv_sqrtpi;
    return scale * std::erf(std::sqrt(u)) / std::sqrt(u);
}

/// Coefficients, in powers of v, of the interpolant whose error times sqrt(u) is near-minimax:
/// sqrt((1 + v)/2) V_n(v) = cos((n + 1/2) theta), v = cos theta, for the Chebyshev polynomials V_n
/// of the third kind, so the zeros of V_{degree + 1} are near-minimax nodes for the weight sqrt(u).
std::vector<double> weighted_interpolant(int degree, double cutoff) {
    const auto n = static_cast<std::size_t>(degree) + 1;
    const double half_range = 0.25 * cutoff * cutoff;  // u = half_range (v + 1)

    // Coefficients of V_j, by their discrete orthogonality over the nodes with weight 1 + v.
    const double denominator = 2 * static_cast<double>(n) + 1;
    std::vector<double> chebyshev(n, 0.0);
    for (std::size_t node = 0; node < n; ++node) {
        const double theta = std::numbers::pi * (2 * static_cast<double>(node) + 1) / denominator;
        const double value = kernel(half_range * (std::cos(theta) + 1), cutoff);
        for (std::size_t j = 0; j < n; ++j)
            chebyshev[j] += 4 / denominator * value *
                            std::cos((static_cast<double>(j) + 0.5) * theta) *
                            std::cos(0.5 * theta);
    }

    // Sum of c_j V_j in powers: V_0 = 1, V_1 = 2 v - 1, V_{j+1} = 2 v V_j - V_{j-1}.
    std::vector<double> power(n, 0.0), current(n, 0.0), previous(n, 0.0);
    current[0] = previous[0] = 1;  // V_{-1} = V_0 gives V_1
    for (std::size_t j = 0; j < n; ++j) {
        std::vector<double> next(n, 0.0);
        for (std::size_t i = 0; i < n; ++i) {
            power[i] += chebyshev[j] * current[i];
            if (i + 1 < n) next[i + 1] += 2 * current[i];
            next[i] -= previous[i];
        }
        previous = current;
        current = next;
    }
    return power;
}

/// Coefficients of the same polynomial in powers of w, v = slope w - 1.
std::vector<double> in_powers_of_w(const std::vector<double>& of_v, double slope) {
    std::vector<double> of_w(of_v.size(), 0.0);
    // Horner's rule on polynomials: times (slope w - 1), plus the next coefficient.
    for (auto c = of_v.rbegin(); c != of_v.rend(); ++c) {
        for (std::size_t n = of_w.size(); n-- > 0;)
            of_w[n] = (n > 0 ? slope * of_w[n - 1] : 0) - of_w[n];
        of_w[0] += *c;
    }
    return of_w;
}

}  // namespace

KernelPolynomial fit_kernel(double cutoff, double tolerance) {
    assert(cutoff > 0 && cutoff <= 8);
    const double half_range = 0.25 * cutoff * cutoff;
    const double peak = std::sqrt(2 * half_range) * kernel(2 * half_range, cutoff);
    constexpr int kMaxDegree = 40;  // k = 8 needs 24 for 1e-6
    for (int degree = 2;; ++degree) {
        const std::vector<double> power = weighted_interpolant(degree, cutoff);
        double worst = 0;
        constexpr int kProbes = 500;
        for (int probe = 0; probe <= kProbes; ++probe) {
            const double v = -1 + 2.0 * probe / kProbes, u = half_range * (v + 1);
            worst = std::max(worst, std::sqrt(u) * std::abs(horner(power, v) - kernel(u, cutoff)));
        }
        if (worst > tolerance * peak && degree < kMaxDegree) continue;
        constexpr int kDirect = 8;  // digits lost to the change of basis: 0.8 a degree
        const double slope = 2 / (cutoff * cutoff);
        if (degree > kDirect)
            return {{power.begin(), power.end()}, static_cast<float>(slope), -1, worst / peak};
        const std::vector<double> direct = in_powers_of_w(power, slope);
        return {{direct.begin(), direct.end()}, 1, 0, worst / peak};
    }
}

}  // namespace vog
