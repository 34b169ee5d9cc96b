// slab_sums.h: Depth slabs of pictures by value on a GPU (docs/volume_rendering.md): the parts of chords in slabs, light of
// Gaussians, and compositing. Slabs are those of the CPU's splat.
#pragma once

#include "render/device/chord.h"
#include "render/device/shading.h"

namespace vog::device {

/// Light of a Gaussian: LightQuadratic (render/by_value/value_light.h), in units of a picture. Four loads of 16 bytes.
struct alignas(16) SplatLight {
    float c[4][3];    ///< red, green, blue, extinction; in powers of z
    Float3 gradient;  ///< of z, per scene unit
    float explained;  ///< share of the values' variance that the plane explains

    VOG_HD bool dark() const;
};
static_assert(sizeof(SplatLight) == 64, "four loads");

VOG_HD bool SplatLight::dark() const {
    for (int n = 0; n < 4; ++n)
        for (int power = 0; power < 3; ++power)
            if (c[n][power] != 0) return false;
    return true;
}

/// The light as the eye sees it.
VOG_HD SplatLight shaded(SplatLight light, const BlinnPhong& look, Double3 towards_eye) {
    const Shading by = look.shading(to_double(light.gradient), towards_eye);
    const double share = light.explained;
    const float body = static_cast<float>(1 + share * (by.body - 1));
    const float shine = static_cast<float>(share * by.shine);
    for (int n = 0; n < 3; ++n)
        for (int power = 0; power < 3; ++power)
            light.c[n][power] = body * light.c[n][power] + shine * light.c[3][power];
    return light;
}

/// Tiles of pixels whose slabs have one range of depths: the CPU splat's.
constexpr int kSlabTileWidth = 64, kSlabTileHeight = 32;
/// Transmittance that hides everything behind.
constexpr float kDarkSlabs = 1e-6f;

/// What slabs add up to.
enum class SlabKind : int32_t { light, maximum };

/// Part of ChordPicture.
struct SlabPicture {
    SlabKind kind;
    int32_t count;            ///< slabs
    const SplatLight* light;  ///< of the Gaussians; null: a picture of sums
    const uint32_t*
        ranges;  ///< [tiles + 1][2] order_of(-near), order_of(far); the last: of Gaussians at the eye's plane
    int32_t tile_columns, tiles;
    float most_share;   ///< of a maximum: largest share per density, per scene unit of depth
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
    int32_t count;       ///< 0: nothing is in the tile
    float front;         ///< t of the first slab's front
    float thickness;     ///< t from slab to slab
    float first, depth;  ///< depth of the first slab's front, and from slab to slab
};
VOG_HD RaySlabs ray_slabs(const SlabPicture& p, const ChordRay& ray, int32_t column, int32_t row) {
    const int32_t tile = row / kSlabTileHeight * p.tile_columns + column / kSlabTileWidth;
    const uint32_t* own = p.ranges + 2 * tile;
    const uint32_t* all = p.ranges + 2 * p.tiles;
    const uint32_t near_order = own[0] > all[0] ? own[0] : all[0];
    const uint32_t far_order = own[1] > all[1] ? own[1] : all[1];
    RaySlabs out{0, 0, 0, 0, 0};
    if (near_order == 0) return out;
    const float near = -float_of(near_order), far = float_of(far_order);
    // A margin keeps rounded depths inside.
    const float margin = 1e-5f * (far - near) + 1.17549435e-38f;
    out.count = p.count;
    out.first = near - margin;
    out.depth = (far - near + 2 * margin) / static_cast<float>(p.count);
    out.front = (out.first - ray.depth) * ray.slant;
    out.thickness = out.depth * ray.slant;
    return out;
}

/// Light along a chord.
struct ChordLight {
    float z, z_step;  ///< of SplatLight at u = 0, and its change with u
    float within;     ///< mean of z² beside that; 0 of a point of the kernel
};
VOG_HD ChordLight light_along(const SplatLight& light, const Chord& chord, Float3 direction) {
    return {dot(light.gradient, chord.from_mean), dot(light.gradient, direction) * chord.deviation,
            0};
}
/// Light of a Gaussian drawn wider than it is: its mean over the kernel.
/// within  SplatKernel::variance
VOG_HD ChordLight widened_light(float within) { return {0, 0, within}; }

/// Adds the parts of a chord to slabs first + begin ... first + end - 1.
/// sums  [n][4] of slab first + n
VOG_HD void add_parts(const Chord& chord, const SplatLight& light, const ChordLight& at,
                      const RaySlabs& slabs, int32_t first, int32_t begin, int32_t end,
                      float (*sums)[4]) {
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
        const float z = at.z + 0.5f * (from + to) * at.z_step;
        for (int channel = 0; channel < 4; ++channel) {
            const float* q = light.c[channel];
            const float expected = (q[2] * z + q[1]) * z + q[0] + at.within * q[2];
            // Colour is limited by what is absorbed in the end, for all Gaussians at once.
            sums[n][channel] += tau * (channel == 3 ? fmaxf(expected, 0.0f) : expected);
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

/// Colour in front, and the transmittance of that.
struct SeenLight {
    float color[3], passed;
};
/// Composites a slab behind those before.
VOG_HD void composite(const float* sum, SeenLight& seen) {
    const float depth = sum[3];
    if (!(depth > 0)) return;
    const float absorbed = -expm1f(-depth), weight = seen.passed * absorbed / depth;
    // Quadratics are fitted one by one: light is at most all that is absorbed.
    for (int n = 0; n < 3; ++n) seen.color[n] += weight * fmaxf(fminf(sum[n], depth), 0.0f);
    seen.passed *= 1 - absorbed;
}

/// The largest mean over slabs.
struct LargestMean {
    float densest, largest;  ///< largest sum of a slab; largest share, -1: none
};
/// In a first sweep over all slabs the densest, in a second the largest mean of those that count.
VOG_HD void include(const float* sum, const SlabPicture& p, const RaySlabs& slabs, float slant,
                    bool second, LargestMean& of) {
    const float weight = sum[3];
    if (!second) {
        of.densest = fmaxf(of.densest, weight);
        return;
    }
    if (!(weight > 0 && weight >= p.least_share * of.densest)) return;
    const float most = p.most_share * weight / (slabs.depth * slant);
    of.largest = fmaxf(of.largest, fminf(fmaxf(fminf(sum[0] / weight, most), 0.0f), 1.0f));
}

/// Writes a pixel.
VOG_HD void write_color(const SlabPicture& p, uint32_t pixel, const SeenLight& seen,
                        const LargestMean& largest) {
    float* out = p.colors + 4 * static_cast<uint64_t>(pixel);
    const bool maximum = p.kind == SlabKind::maximum;
    for (int n = 0; n < 3; ++n) out[n] = maximum ? largest.largest : seen.color[n];
    out[3] = 1 - seen.passed;
}

}  // namespace vog::device
