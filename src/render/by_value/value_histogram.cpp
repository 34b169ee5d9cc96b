// value_histogram.cpp: sums of normal distributions of values.
#include "render/by_value/value_histogram.h"

#include <algorithm>
#include <cmath>

namespace vog::by_value {

std::vector<float> value_histogram(const Gaussians& gaussians, const ScalarField& field,
                                   std::size_t bins) {
    double lower = field.lower, upper = field.upper;
    if (!(upper > lower)) {  // as ExpectedLight has data of one value
        const double margin = std::max(std::abs(lower), 1e-300) * 1e-3;
        upper = lower + margin, lower -= margin;
    }
    const double per_bin = static_cast<double>(bins) / (upper - lower);
    const int last_bin = static_cast<int>(bins) - 1;
    std::vector<double> sum(bins);
    for (std::size_t i = 0; i < gaussians.size(); ++i) {
        const Vec3d g = vec_cast<double>(field.gradient[i]),
                    s = vec_cast<double>(gaussians.scale[i]);
        const Vec3d own =
            gaussians.axis_aligned() ? g : transpose(matrix_from_quat(gaussians.rotation[i])) * g;
        const double along = length(Vec3d{own.x * s.x, own.y * s.y, own.z * s.z});
        const double deviation = std::hypot(along, double{field.deviation[i]}) * per_bin;
        const double mean = (double{field.value[i]} - lower) * per_bin;
        const double mass = double{gaussians.density[i]} * s.x * s.y * s.z;
        const auto below = [&](double edge) {
            return deviation > 1e-3 ? 0.5 * std::erfc((mean - edge) / (deviation * std::sqrt(2.0)))
                                    : double(edge > mean);
        };
        const int first = std::clamp(static_cast<int>(mean - 3 * deviation), 0, last_bin);
        const int last = std::clamp(static_cast<int>(mean + 3 * deviation), 0, last_bin);
        for (int n = first; n <= last; ++n)
            sum[static_cast<std::size_t>(n)] += mass * (below(n + 1) - below(n));
    }
    const double most = std::ranges::max(sum);
    std::vector<float> share(bins);
    for (std::size_t n = 0; n < bins && most > 0; ++n) share[n] = static_cast<float>(sum[n] / most);
    return share;
}

}  // namespace vog::by_value
