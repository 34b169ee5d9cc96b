// chebyshev_fit.cpp: Interpolants at the zeros of Chebyshev polynomials, in powers.
#include "render/chebyshev_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace vog {

double horner(const std::vector<double>& coefficient, double v) {
    double sum = 0;
    for (auto c = coefficient.rbegin(); c != coefficient.rend(); ++c) sum = sum * v + *c;
    return sum;
}

namespace {

/// The interpolant at the zeros of a Chebyshev polynomial over x = half (v + 1), in powers of v.
std::vector<double> interpolant(const std::function<double(double)>& of, std::size_t count,
                                double half) {
    std::vector<double> series(count, 0.0);
    for (std::size_t node = 0; node < count; ++node) {
        const double theta = std::numbers::pi * (static_cast<double>(node) + 0.5) / double(count);
        const double value = of(half * (std::cos(theta) + 1));
        for (std::size_t j = 0; j < count; ++j)
            series[j] += (j == 0 ? 1.0 : 2.0) / double(count) * value * std::cos(double(j) * theta);
    }
    // T_0 = 1, T_{j+1} = 2 v T_j - T_{j-1}, with T_{-1} = T_1 = v.
    std::vector<double> power(count, 0.0), current(count, 0.0), previous(count, 0.0);
    current[0] = 1;
    if (count > 1) previous[1] = 1;
    for (std::size_t j = 0; j < count; ++j) {
        std::vector<double> next(count, 0.0);
        for (std::size_t i = 0; i < count; ++i) {
            power[i] += series[j] * current[i];
            if (i + 1 < count) next[i + 1] += 2 * current[i];
            next[i] -= previous[i];
        }
        previous = current;
        current = next;
    }
    return power;
}

}  // namespace

ChebyshevFit fit_chebyshev(const std::function<double(double)>& of, double length, double tolerance,
                           std::size_t most) {
    const double half = 0.5 * length;
    for (std::size_t count = 2;; ++count) {
        const std::vector<double> power = interpolant(of, count, half);
        double worst = 0;
        constexpr int kProbes = 500;
        for (int probe = 0; probe <= kProbes; ++probe) {
            const double v = -1 + 2.0 * probe / kProbes;
            worst = std::max(worst, std::abs(horner(power, v) - of(half * (v + 1))));
        }
        if (worst > tolerance && count < most) continue;
        return {{power.begin(), power.end()}, static_cast<float>(1 / half), worst};
    }
}

}  // namespace vog
