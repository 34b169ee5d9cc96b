// value_moments.h: Moments of a field's values in a part of a ray, and their light (docs/volume_rendering.md, "Models").
//
// With phi the plane of a Gaussian in the middle of its part tau of the ray, r² and third the central moments of its
// residual, parts have the sums of  tau,  tau phi,  tau (phi² + r²),  tau (phi³ + 3 phi r² + third),  and tau g for light.
// Values are shares of the field's range.
#pragma once

#include "render/device/expected_light.h"
#include "render/device/light/shading.h"

namespace vog::device {

/// Sums of a part; a maximum has the first two, pictures without light and gradient opacity the first four.
enum ValueChannel : int32_t { kTau, kFirst, kSecond, kThird, kGradient };
constexpr int32_t kMaximumChannels = kSecond, kUnlitChannels = kGradient,
                  kLitChannels = kGradient + 3;

/// Central moments.
struct ValueMoments {
    float tau, mean, variance, third;  ///< tau 0: nothing
    Float3 gradient;                   ///< times tau; without light or gradient opacity 0
};
/// sum  [channels]
VOG_HD ValueMoments moments_of(const float* sum, bool lit) {
    ValueMoments m{sum[kTau], 0, 0, 0, {0, 0, 0}};
    if (!(m.tau > 0)) return m;
    const float noise = 1 - 4e-7f;  // rounding of sums of equal values must not spread them
    m.mean = sum[kFirst] / m.tau;
    const float square = sum[kSecond] / m.tau;
    m.variance = fmaxf(square * noise - m.mean * m.mean, 0.0f);
    m.third = sum[kThird] / m.tau - m.mean * (3 * square - 2 * m.mean * m.mean);
    if (lit) m.gradient = {sum[kGradient], sum[kGradient + 1], sum[kGradient + 2]};
    return m;
}

/// Two normal distributions with a mean, a variance and a skewness: with u = skewness / kShare³ they lie
/// kShare (u ± sqrt(u² + 4)) / 2 deviations from the mean, with weights (1 ∓ u / sqrt(u² + 4)) / 2, and have the variance
/// that is left. Narrow, so that the two can have most skewness; narrower ones miss what lies between. Near an end of the
/// range they are no wider than its distance: two values that are the ends stay two.
struct NormalPair {
    static constexpr float kShare = 0.95f, kPerCube = 1 / (kShare * kShare * kShare),
                           kNarrow = 1 - kShare * kShare;
    /// Rounding of sums hides the third moment of less.
    static constexpr float kLeastVariance = 1e-5f;
    static constexpr float kMostSkewness = 3;
    /// Bounds for labels, where the pair are the two labels of a part; a share of one that gives less variance is not seen.
    static constexpr float kLeastOfLabels = 2e-6f, kMostOfLabels = 1000;

    float high, low;  ///< means, within the range
    float high_variance, low_variance;
    float of_high;  ///< weight
};
VOG_HD NormalPair normal_pair(const ValueMoments& m, bool labels) {
    const float mean = fminf(fmaxf(m.mean, 0.0f), 1.0f);
    if (!(m.variance > (labels ? NormalPair::kLeastOfLabels : NormalPair::kLeastVariance)))
        return {mean, mean, labels ? 0 : m.variance, labels ? 0 : m.variance, 0.5f};
    const float most = labels ? NormalPair::kMostOfLabels : NormalPair::kMostSkewness;
    const float deviation = sqrtf(m.variance);
    const float skewness = fminf(fmaxf(m.third / (m.variance * deviation), -most), most);
    const float u = (labels ? 1 : NormalPair::kPerCube) * skewness, root = sqrtf(u * u + 4);
    const float half = 0.5f * (labels ? 1 : NormalPair::kShare) * deviation;
    const float high = fminf(fmaxf(m.mean + half * (u + root), 0.0f), 1.0f);
    const float low = fminf(fmaxf(m.mean + half * (u - root), 0.0f), 1.0f);
    if (labels) return {high, low, 0, 0, 0.5f * (1 - u / root)};
    const float above = fminf(high, 1 - high), below = fminf(low, 1 - low);
    return {high, low, fminf(NormalPair::kNarrow * m.variance, above * above),
            fminf(NormalPair::kNarrow * m.variance, below * below), 0.5f * (1 - u / root)};
}

/// Optical depth of a cell below which that is the same to 1 %.
constexpr float kThinCell = 0.02f;

/// Share of the light of a pair that is seen in a cell: -ln of the cell's mean transmittance, by its mean optical depth.
/// high, low  optical depths of cells of one value
VOG_HD float seen_share(float high, float low, float of_high) {
    const float mean = low + of_high * (high - low);
    if (!(mean > kThinCell)) return 1;
    const float passed = of_high * expf(-high) + (1 - of_high) * expf(-low);
    return -logf(fmaxf(passed, 1e-30f)) / mean;
}

/// Factor of the light by the mean gradient.
/// m  tau > 0
VOG_HD float gradient_factor(const MeanLight& light, const ValueMoments& m) {
    if (!light.gradient.any()) return 1;
    const float steep = sqrtf(dot(m.gradient, m.gradient));
    return light.gradient.at(light.per_gradient * steep / m.tau);
}
/// Mean light per unit of tau.
/// m         tau > 0
/// division  of the part that has parts_per_cell: how many of these it would take
VOG_HD void mean_light_of(const MeanLight& light, const ValueMoments& m, float division,
                          float out[4]) {
    const NormalPair pair = normal_pair(m, light.labels);
    float low[4];
    light.light(pair.high, pair.high_variance, out);
    light.light(pair.low, pair.low_variance, low);
    const float factor = gradient_factor(light, m);
    const float cell = factor * m.tau * light.parts_per_cell * division;
    const float seen = factor * seen_share(out[3] * cell, low[3] * cell, pair.of_high);
    for (int c = 0; c < 4; ++c) out[c] = seen * (low[c] + pair.of_high * (out[c] - low[c]));
}
/// Shades mean light.
/// towards_eye  unit length
/// reached      at the part
VOG_HD void shade(const BlinnPhong& look, const ValueMoments& m, Double3 towards_eye,
                  const ReachedLight& reached, float out[4]) {
    const Shading by = look.shading(to_double(m.gradient), towards_eye, reached);
    const float body = static_cast<float>(by.body), shine = static_cast<float>(by.shine);
    for (int c = 0; c < 3; ++c) out[c] = fminf(body * out[c] + shine * out[3], out[3]);
}

/// Colour in front, premultiplied, and the transmittance of that.
struct SeenLight {
    float color[3], passed;
};
/// Composites a part behind those before.
/// light  per unit of tau
VOG_HD void composite(const float light[4], float tau, SeenLight& seen) {
    const float depth = light[3] * tau;
    if (!(depth > 0)) return;
    const float absorbed = -expm1f(-depth), weight = seen.passed * absorbed / light[3];
    for (int c = 0; c < 3; ++c) seen.color[c] += weight * light[c];
    seen.passed *= 1 - absorbed;
}

/// Steps of a slab that absorbs much, in which the moments go over to those of its neighbours: surfaces are found
/// between means of slabs.
constexpr int32_t kSurfaceSteps = 6;
/// A slab is divided into steps from an optical depth on, where the change of means from slab to slab makes up a share of
/// the variance in it.
constexpr float kSurfaceDepth = 0.2f, kSurfaceShare = 0.5f;
/// How far the steps go towards the neighbours; not above 0: no steps. All the way at twice those, so that pictures have
/// no edge where they are passed.
/// trend  trend_between() of the neighbour that has more
/// lit    by depth alone: normals change from slab to slab where means do not
VOG_HD float division_of(float depth, float trend, float variance, bool lit) {
    const float sloped = lit ? 2 : trend / fmaxf(kSurfaceShare * variance, 1e-12f);
    return fminf(fminf(depth / kSurfaceDepth, sloped) - 1, 1.0f);
}
/// Variance in a slab of means that change linearly from slab to slab; towards one with less tau by its share, so that there
/// is no edge where a Gaussian ends.
/// own  tau > 0
VOG_HD float trend_between(const ValueMoments& own, const ValueMoments& other) {
    const float change = fminf(other.tau / own.tau, 1.0f) * (other.mean - own.mean);
    return change * change * (1.0f / 12);
}
/// Transmittance that hides everything behind.
constexpr float kDarkTransmittance = 1e-6f;

/// Step k of a slab, before scale and shift: between the means of slabs weights, means and spreads are linear.
/// division  0 to 1, of the way to the neighbours
VOG_HD ValueMoments step_between(const ValueMoments& own, const ValueMoments& before,
                                 const ValueMoments& behind, float division, int32_t k) {
    const float at = division * ((static_cast<float>(k) + 0.5f) / kSurfaceSteps - 0.5f);
    const ValueMoments& other = at < 0 ? before : behind;
    const float share = fabsf(at), rest = 1 - share;
    const float beside = other.tau * share, tau = own.tau * rest + beside;
    const float of = beside / tau, left = 1 - of;
    const float variance =
        of * other.variance + left * own.variance - division * division * trend_between(own, other);
    return {tau, of * other.mean + left * own.mean, fmaxf(variance, 0.0f),
            of * other.third + left * own.third, share * other.gradient + rest * own.gradient};
}

/// Mean place in a part of even extinction, weighted by what is seen of it: 0 its front, 1 its back.
VOG_HD float seen_at(float depth) {
    if (depth < 0.1f) return 0.5f - depth * (1.0f / 12);
    return 1 / depth - 1 / expm1f(fminf(depth, 80.0f));
}

/// A ray through slabs, and the light that reaches them.
struct LitRay {
    const BlinnPhong* look;
    const LightLattice* lattice;
    Double3 towards_eye;   ///< unit length
    Double3 middle, step;  ///< of the first slab, and from slab to slab

    /// Mean light of a slab, or of one of its parts, shaded; the light that reaches it is that where it is seen.
    /// slab   place of its middle
    /// parts  of a slab
    VOG_HD void light_of(const MeanLight& light, const ValueMoments& m, float slab, float parts,
                         float out[4]) const {
        mean_light_of(light, m, parts, out);
        if (!lattice->any()) {
            if (look->on) shade(*look, m, towards_eye, {nullptr, middle, 0, 1}, out);
            return;
        }
        const float seen = slab + (seen_at(out[3] * m.tau) - 0.5f) / parts;
        shade(*look, m, towards_eye,
              reached_at(*lattice, middle + static_cast<double>(seen) * step, towards_eye), out);
    }
};

/// Composites a slab between its neighbours, behind those before.
VOG_HD void composite_slab(const MeanLight& light, const LitRay& ray, int32_t slab,
                           const ValueMoments& own, const ValueMoments& before,
                           const ValueMoments& behind, SeenLight& seen) {
    if (!(own.tau > 0) || seen.passed < kDarkTransmittance) return;
    float color[4];
    const float at = static_cast<float>(slab);
    ray.light_of(light, own, at, 1, color);
    const float trend = fmaxf(trend_between(own, before), trend_between(own, behind));
    const float division =
        division_of(color[3] * own.tau, trend, own.variance, ray.look->on || light.gradient.any());
    if (light.labels || !(division > 0)) return composite(color, own.tau, seen);
    // Steps together have the slab's weight and mean.
    float whole = 0, first = 0;
    for (int32_t k = 0; k < kSurfaceSteps; ++k) {
        const ValueMoments step = step_between(own, before, behind, division, k);
        whole += step.tau, first += step.tau * step.mean;
    }
    const float scale = own.tau / whole, shift = own.mean - first / whole;
    for (int32_t k = 0; k < kSurfaceSteps && seen.passed >= kDarkTransmittance; ++k) {
        ValueMoments step = step_between(own, before, behind, division, k);
        step.tau *= scale, step.mean += shift;
        if (light.gradient.any()) step.gradient = scale * step.gradient;
        const float of_slab = (static_cast<float>(k) + 0.5f) / kSurfaceSteps - 0.5f;
        ray.light_of(light, step, at + of_slab, kSurfaceSteps, color);
        composite(color, step.tau, seen);
    }
}

/// Slabs along a ray, composited front to back, each as soon as the one behind it is known.
struct SlabLine {
    ValueMoments before, own;
    SeenLight seen;
    int32_t slab;  ///< of `own`

    VOG_HD void add(const MeanLight& light, const LitRay& ray, const ValueMoments& behind) {
        composite_slab(light, ray, slab, own, before, behind, seen);
        before = own, own = behind, ++slab;
    }
};
VOG_HD SlabLine empty_line() {
    const ValueMoments nothing{0, 0, 0, 0, {0, 0, 0}};
    return {nothing, nothing, {{0, 0, 0}, 1}, -1};
}

}  // namespace vog::device
