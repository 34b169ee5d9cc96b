// slab_sums.h: Depth slabs of pictures by value on a GPU (docs/volume_rendering.md): the parts of chords in slabs, and
// their moments. Slabs are those of the CPU's splat.
#pragma once

#include "render/device/chord.h"
#include "render/device/value_moments.h"

namespace vog::device {

/// A field in a Gaussian, shares of its range, per scene unit. Two loads of 16 bytes.
struct alignas(16) SplatValue {
    ScalarPlane plane;
    float third;  ///< central moment of the residual
};
static_assert(sizeof(SplatValue) == 32, "two loads");

/// Part of ChordPicture.
struct SlabPicture {
    int32_t count;             ///< slabs
    const SplatValue* values;  ///< of the Gaussians; null: a picture of sums
    int32_t channels;          ///< of ValueChannel; kMaximumChannels: a maximum
    const uint32_t* range;     ///< [2] of depths: order_of(-near), order_of(far)
    MeanLight light;
    BlinnPhong look;
    LightLattice lattice;  ///< scene units
    float most_share;      ///< of a maximum: largest share for a sum of 1 in a scene unit of a ray
    float least_share;  ///< and of the largest density on the ray, below which means do not count
    float*
        colors;  ///< [height * width][4] premultiplied colour and alpha; maximum: the share, -1: none
};

/// Unsigned numbers in the order of floats, above 0.
VOG_HD uint32_t order_of(float value) {
    union {
        float value;
        uint32_t bits;
    } as;
    as.value = value;
    return as.bits & 0x80000000u ? ~as.bits : as.bits | 0x80000000u;
}
VOG_HD float float_of(uint32_t order) {
    union {
        uint32_t bits;
        float value;
    } as;
    as.bits = order & 0x80000000u ? order & 0x7fffffffu : ~order;
    return as.value;
}

/// Slabs along one ray.
struct RaySlabs {
    int32_t count;       ///< 0: nothing is in the picture
    float front;         ///< t of the first slab's front
    float thickness;     ///< t from slab to slab
    float first, depth;  ///< depth of the first slab's front, and from slab to slab
};
VOG_HD RaySlabs ray_slabs(const SlabPicture& p, const ChordRay& ray) {
    RaySlabs out{0, 0, 0, 0, 0};
    if (p.range[0] == 0) return out;
    const float near = -float_of(p.range[0]), far = float_of(p.range[1]);
    // A margin keeps rounded depths inside.
    const float margin = 1e-5f * (far - near) + 1.17549435e-38f;
    out.count = p.count;
    out.first = near - margin;
    out.depth = (far - near + 2 * margin) / static_cast<float>(p.count);
    out.front = (out.first - ray.depth) * ray.slant;
    out.thickness = out.depth * ray.slant;
    return out;
}

/// A field along a chord.
struct ValueAlong {
    float share, step;  ///< at u = 0, and its change with u
    float variance;     ///< of the residual
};
VOG_HD ValueAlong value_along(const SplatValue& v, const Chord& chord, Float3 direction) {
    return {v.plane.value + dot(v.plane.gradient, chord.from_mean),
            dot(v.plane.gradient, direction) * chord.deviation, v.plane.variance};
}
/// In a Gaussian drawn wider than it is: constant, with its whole variance.
/// within  SplatKernel::variance
VOG_HD ValueAlong widened_value(const SplatValue& v, const Gaussian& g, float within) {
    return {v.plane.value, 0, constant(v.plane, g, within).variance};
}

/// Adds the moments of the parts of a chord to slabs first + begin ... first + end - 1.
/// sums  [n][kChannels] of slab first + n
template <int kChannels>
VOG_HD void add_parts(const Chord& chord, const SplatValue& value, const ValueAlong& at,
                      const RaySlabs& slabs, int32_t first, int32_t begin, int32_t end,
                      float* sums) {
    const float per_deviation = 1 / chord.deviation;
    const float front = (slabs.front - chord.nearest) * per_deviation;
    const float step = slabs.thickness * per_deviation;
    const int32_t from_slab = first + begin;
    float from =
        from_slab == 0
            ? chord.first
            : fminf(fmaxf(front + static_cast<float>(from_slab) * step, chord.first), chord.last);
    float before = normal_integral(from);
    VOG_UNROLL
    for (int32_t n = begin; n < end; ++n) {
        const int32_t next = first + n + 1;
        const float to =
            next >= slabs.count
                ? chord.last
                : fminf(fmaxf(front + static_cast<float>(next) * step, from), chord.last);
        if (!(to > from)) continue;
        const float after = normal_integral(to), tau = chord.tau * (after - before);
        // In the middle of the part.
        const float phi = at.share + 0.5f * (from + to) * at.step;
        float* sum = sums + n * kChannels;
        sum[kTau] += tau;
        sum[kFirst] += tau * phi;
        if (kChannels >= kUnlitChannels) {
            const float square = phi * phi;
            sum[kSecond] += tau * (square + at.variance);
            sum[kThird] += tau * ((square + 3 * at.variance) * phi + value.third);
        }
        if (kChannels == kLitChannels) {
            sum[kGradient] += tau * value.plane.gradient.x;
            sum[kGradient + 1] += tau * value.plane.gradient.y;
            sum[kGradient + 2] += tau * value.plane.gradient.z;
        }
        from = to;
        before = after;
    }
}

/// Slabs before which a chord begins and behind which it ends, from `first` on, within [0, count].
struct SlabRun {
    int32_t begin, end;
};
VOG_HD SlabRun run_of(const Chord& chord, const RaySlabs& slabs, int32_t first, int32_t count) {
    const float per_slab = 1 / slabs.thickness, most = static_cast<float>(count);
    const float start = chord.nearest + chord.first * chord.deviation - slabs.front;
    const float stop = chord.nearest + chord.last * chord.deviation - slabs.front;
    const float before = static_cast<float>(first) + 1;
    // A slab more on either side: rounding.
    return {static_cast<int32_t>(fminf(fmaxf(start * per_slab - before, 0.0f), most)),
            static_cast<int32_t>(fminf(fmaxf(stop * per_slab - before + 3, 0.0f), most))};
}

/// The largest mean over slabs.
struct LargestMean {
    float densest, largest;  ///< largest sum of a slab; largest share, -1: none
};
/// In a first sweep over all slabs the densest, in a second the largest mean of those that count.
VOG_HD void include(const float* sum, const SlabPicture& p, const RaySlabs& slabs, float slant,
                    bool second, LargestMean& of) {
    const float weight = sum[kTau];
    if (!second) {
        of.densest = fmaxf(of.densest, weight);
        return;
    }
    if (!(weight > 0 && weight >= p.least_share * of.densest)) return;
    const float most = p.most_share * weight / (slabs.depth * slant);
    of.largest = fmaxf(of.largest, fminf(fmaxf(fminf(sum[kFirst] / weight, most), 0.0f), 1.0f));
}

/// The slabs of a picture along one ray.
struct SlabsOfRay {
    RaySlabs slabs;
    float slant;
    LitRay ray;
    SlabLine line;
    LargestMean largest;

    VOG_HD int32_t sweeps(const SlabPicture& p) const {
        return p.channels == kMaximumChannels ? 2 : 1;
    }
    VOG_HD bool dark() const { return line.seen.passed < kDarkTransmittance; }
    /// Takes the sums of the next slab of a sweep.
    VOG_HD void add(const SlabPicture& p, const float* sum, int32_t sweep) {
        if (p.channels == kMaximumChannels)
            include(sum, p, slabs, slant, sweep == 1, largest);
        else
            line.add(p.light, ray, moments_of(sum, p.channels == kLitChannels));
    }
    /// Writes a pixel when all slabs are taken.
    VOG_HD void write(const SlabPicture& p, uint32_t pixel) {
        float* out = p.colors + 4 * static_cast<uint64_t>(pixel);
        const bool maximum = p.channels == kMaximumChannels;
        if (!maximum) line.add(p.light, ray, empty_line().own);  // the last one
        for (int n = 0; n < 3; ++n) out[n] = maximum ? largest.largest : line.seen.color[n];
        out[3] = 1 - line.seen.passed;
    }
};
VOG_HD SlabsOfRay slabs_of_ray(const SlabPicture& p, const ChordRay& ray) {
    const RaySlabs slabs = ray_slabs(p, ray);
    const Double3& along = ray.ray.direction;
    const double thickness = slabs.thickness, front = slabs.front;
    const LitRay lit{&p.look, &p.lattice, -1.0 * along,
                     ray.ray.origin + (front + 0.5 * thickness) * along, thickness * along};
    return {slabs, ray.slant, lit, empty_line(), {0, -1}};
}

}  // namespace vog::device
