// value_histogram.cpp: sums of normal distributions of values.
#include "render/by_value/value_histogram.h"

#include <algorithm>
#include <cmath>

#include "data/fields/field_limits.h"

namespace vog::by_value {

std::vector<double> value_bins(const ScalarField& field, std::size_t bins, bool logarithmic) {
    double lower = field.lower, upper = field.upper;
    if (!(upper > lower)) {  // as value_range()
        const double margin = std::max(std::abs(lower), 1e-300) * 1e-3;
        upper = lower + margin;
        if (!logarithmic) lower -= margin;
    }
    std::vector<double> edges;
    for (std::size_t n = 0; n <= bins; ++n) {
        const double share = static_cast<double>(n) / static_cast<double>(bins);
        edges.push_back(logarithmic ? lower * std::pow(upper / lower, share)
                                    : std::lerp(lower, upper, share));
    }
    return edges;
}

std::vector<float> value_histogram(const Gaussians& gaussians, const ScalarField& field,
                                   std::span<const double> edges) {
    const std::size_t bins = edges.size() - 1;
    std::vector<double> sum(bins);
    const auto bin_of = [&](double value) {
        const auto after = std::ranges::upper_bound(edges, value);
        return static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(
            after - edges.begin() - 1, 0, static_cast<std::ptrdiff_t>(bins) - 1));
    };
    for (std::size_t i = 0; i < gaussians.size(); ++i) {
        const Vec3d s = vec_cast<double>(gaussians.scale[i]);
        const double residual{field.deviation[i]};
        const double deviation =
            std::sqrt(plane_variance(gaussians, field, i) + residual * residual);
        const double mean{field.value[i]};
        const double mass = double{gaussians.density[i]} * s.x * s.y * s.z;
        // A thousandth of a bin is no width.
        const std::size_t own_bin = bin_of(mean);
        if (deviation <= 1e-3 * (edges[own_bin + 1] - edges[own_bin])) {
            sum[own_bin] += mass;
            continue;
        }
        const auto below = [&](double edge) {
            return 0.5 * std::erfc((mean - edge) / (deviation * std::sqrt(2.0)));
        };
        const std::size_t last = bin_of(mean + 3 * deviation);
        for (std::size_t n = bin_of(mean - 3 * deviation); n <= last; ++n)
            sum[n] += mass * (below(edges[n + 1]) - below(edges[n]));
    }
    const double most = std::ranges::max(sum);
    std::vector<float> share(bins);
    for (std::size_t n = 0; n < bins && most > 0; ++n) share[n] = static_cast<float>(sum[n] / most);
    return share;
}

}  // namespace vog::by_value
