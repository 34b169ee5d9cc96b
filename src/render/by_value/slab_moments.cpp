// slab_moments.cpp: Light of values with given moments, by the closed form.
#include "render/by_value/slab_moments.h"

#include <algorithm>
#include <cmath>

namespace vog::by_value {

NormalPair normal_pair(const ValueMoments& m) {
    const double deviation = std::sqrt(m.variance);
    if (!(m.variance > double{NormalPair::kLeastVariance})) return {m.mean, m.mean, deviation, 0.5};
    constexpr double kMost = NormalPair::kMostSkewness, kShare = NormalPair::kShare;
    const double u = double{NormalPair::kPerCube} *
                     std::clamp(m.third / (m.variance * deviation), -kMost, kMost);
    const double root = std::sqrt(u * u + 4), half = 0.5 * kShare * deviation;
    return {m.mean + half * (u + root), m.mean + half * (u - root),
            deviation * std::sqrt(1 - kShare * kShare), 0.5 * (1 - u / root)};
}

StepLight::StepLight(const ValueTransfer& transfer, const ScalarField& field,
                     const VolumeLook& look)
    : light_(transfer, value_range(field), field.is_measure), lighting_(look) {}

std::array<float, 4> StepLight::operator()(const MomentSums& sums, Vec3d towards_eye) const {
    const NormalPair pair = normal_pair(sums.moments());
    const auto mean_of = [&](double mean) {
        return light_.exact(static_cast<float>(std::clamp(mean, 0.0, 1.0)),
                            static_cast<float>(pair.deviation));
    };
    const std::array<float, 4> high = mean_of(pair.high), low = mean_of(pair.low);
    std::array<float, 4> s;
    for (std::size_t c = 0; c < 4; ++c)
        s[c] = low[c] + static_cast<float>(pair.of_high) * (high[c] - low[c]);
    if (!lighting_.on()) return s;
    const Shading by = lighting_(sums.gradient, towards_eye);
    for (std::size_t c = 0; c < 3; ++c)
        s[c] = std::min(static_cast<float>(by.body) * s[c] + static_cast<float>(by.shine) * s[3],
                        s[3]);
    return s;
}

}  // namespace vog::by_value
