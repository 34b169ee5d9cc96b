// noise.cpp: gradient noise and cellular humps for the points of a leaf.
#include "sample/noise.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <vector>

namespace vog::sampling {

namespace {

// Odd factors that distribute lattice coordinates over all bits before mixing.
constexpr std::uint32_t kSpreadX = 0x8da6b343u, kSpreadY = 0xd8163841u, kSpreadZ = 0xcb1ab31fu;

/// floor for |value| < 2^31, branch-free, so that loops vectorise.
inline std::int32_t floor_int(float value) {
    const auto truncated = static_cast<std::int32_t>(value);
    return truncated - (value < static_cast<float>(truncated) ? 1 : 0);
}

/// Perlin's interpolant 6t^5 - 15t^4 + 10t^3.
inline float fade(float t) { return t * t * t * (t * (t * 6 - 15) + 10); }

/// Value with its sign flipped if the highest bit of `bits` is set.
inline float flipped(float value, std::uint32_t bits) {
    return std::bit_cast<float>(std::bit_cast<std::uint32_t>(value) ^ (bits & 0x80000000u));
}

/// Dot product of (x, y, z) with a gradient (+-1, +-1, +-1). Perlin's twelve gradients need
/// selects, and a loop four times slower without AVX2.
inline float gradient_dot(std::uint32_t hash, float x, float y, float z) {
    hash = (hash ^ (hash >> 15)) * 0x2c1b3c6du;
    return flipped(x, hash) + flipped(y, hash << 1) + flipped(z, hash << 2);
}

inline float lerp(float a, float b, float t) { return a + t * (b - a); }

/// Gradient noise in [-1.5, 1.5]: each axis adds at most f + u - 2 u f = 1/2, with u = fade(f), at
/// the centre of a cell.
inline float gradient_noise(float x, float y, float z, std::uint32_t seed) {
    const std::int32_t ix = floor_int(x), iy = floor_int(y), iz = floor_int(z);
    const float fx = x - static_cast<float>(ix), fy = y - static_cast<float>(iy),
                fz = z - static_cast<float>(iz);
    const std::uint32_t x0 = static_cast<std::uint32_t>(ix) * kSpreadX + seed, x1 = x0 + kSpreadX;
    const std::uint32_t y0 = static_cast<std::uint32_t>(iy) * kSpreadY, y1 = y0 + kSpreadY;
    const std::uint32_t z0 = static_cast<std::uint32_t>(iz) * kSpreadZ, z1 = z0 + kSpreadZ;
    const float u = fade(fx), v = fade(fy), w = fade(fz);
    const float a =
        lerp(gradient_dot(x0 ^ y0 ^ z0, fx, fy, fz), gradient_dot(x1 ^ y0 ^ z0, fx - 1, fy, fz), u);
    const float b = lerp(gradient_dot(x0 ^ y1 ^ z0, fx, fy - 1, fz),
                         gradient_dot(x1 ^ y1 ^ z0, fx - 1, fy - 1, fz), u);
    const float c = lerp(gradient_dot(x0 ^ y0 ^ z1, fx, fy, fz - 1),
                         gradient_dot(x1 ^ y0 ^ z1, fx - 1, fy, fz - 1), u);
    const float d = lerp(gradient_dot(x0 ^ y1 ^ z1, fx, fy - 1, fz - 1),
                         gradient_dot(x1 ^ y1 ^ z1, fx - 1, fy - 1, fz - 1), u);
    return lerp(lerp(a, b, v), lerp(c, d, v), w);
}

/// Feature point of a lattice cell, in units of cells, and the height of its hump.
struct Feature {
    float x, y, z, height;
};

float distance_outside(float value, Interval interval) {
    return std::max({interval.lower - value, value - interval.upper, 0.0f});
}

float unit(std::uint32_t hash) { return static_cast<float>(hash >> 8) * 0x1p-24f; }

using Intervals = std::array<Interval, 3>;

/// Whether the feature's hump, of radius 1, overlaps the box; units of cells.
bool reaches(const Feature& feature, const Intervals& box) {
    const float dx = distance_outside(feature.x, box[0]);
    const float dy = distance_outside(feature.y, box[1]);
    const float dz = distance_outside(feature.z, box[2]);
    return dx * dx + dy * dy + dz * dz < 1;
}

/// Features whose humps overlap the box: all are in cells within distance 1 of it.
void find_features(const Intervals& box, std::uint32_t seed, std::vector<Feature>& features) {
    features.clear();
    std::array<std::int32_t, 3> first{}, last{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        first[axis] = floor_int(box[axis].lower) - 1;
        last[axis] = floor_int(box[axis].upper) + 1;
    }
    for (std::int32_t ix = first[0]; ix <= last[0]; ++ix)
        for (std::int32_t iy = first[1]; iy <= last[1]; ++iy)
            for (std::int32_t iz = first[2]; iz <= last[2]; ++iz) {
                const std::uint32_t cell =
                    mixed((static_cast<std::uint32_t>(ix) * kSpreadX + seed) ^
                          (static_cast<std::uint32_t>(iy) * kSpreadY) ^
                          (static_cast<std::uint32_t>(iz) * kSpreadZ));
                const Feature feature{static_cast<float>(ix) + unit(mixed(cell + 1)),
                                      static_cast<float>(iy) + unit(mixed(cell + 2)),
                                      static_cast<float>(iz) + unit(mixed(cell + 3)),
                                      0.6f + 0.4f * unit(cell)};
                if (reaches(feature, box)) features.push_back(feature);
            }
}

void add_gradient_noise(const LeafPoints& points, const Octave& octave, LeafValues out) {
    const float frequency = 1 / octave.cell, amplitude = octave.amplitude / 1.5f;
    const std::uint32_t seed = octave.seed;
    for (std::size_t n = 0; n < kLeafVoxels; ++n)
        out[n] += amplitude * gradient_noise(points.x[n] * frequency, points.y[n] * frequency,
                                             points.z[n] * frequency, seed);
}

void add_humps(const LeafPoints& points, const Octave& octave, LeafValues out) {
    const float frequency = 1 / octave.cell;
    LeafPoints scaled;
    for (std::size_t n = 0; n < kLeafVoxels; ++n) {
        scaled.x[n] = points.x[n] * frequency;
        scaled.y[n] = points.y[n] * frequency;
        scaled.z[n] = points.z[n] * frequency;
    }
    thread_local std::vector<Feature> features;
    find_features({interval_of(scaled.x), interval_of(scaled.y), interval_of(scaled.z)},
                  octave.seed, features);

    // Slice by slice: fewer humps overlap a slice than the leaf.
    constexpr std::size_t kSlice = kLeafEdge * kLeafEdge;
    for (std::size_t first = 0; first < kLeafVoxels; first += kSlice) {
        const float* x = &scaled.x[first];
        const float* y = &scaled.y[first];
        const float* z = &scaled.z[first];
        const Intervals box = {interval_of({x, kSlice}), interval_of({y, kSlice}),
                               interval_of({z, kSlice})};
        alignas(64) std::array<float, kSlice> hump{};
        for (const Feature& f : features) {
            if (!reaches(f, box)) continue;
            for (std::size_t n = 0; n < kSlice; ++n) {
                const float dx = x[n] - f.x, dy = y[n] - f.y, dz = z[n] - f.z;
                const float value = f.height * (1 - (dx * dx + dy * dy + dz * dz));
                hump[n] = hump[n] > value ? hump[n] : value;
            }
        }
        for (std::size_t n = 0; n < kSlice; ++n)
            out[first + n] += octave.amplitude * (hump[n] - kHumpMean);
    }
}

/// Octave with its amplitude reduced for the voxel size: full from 6 voxels per cell on, 0 at 3.
Octave band_limited(Octave octave, const Detail& detail) {
    octave.amplitude *= std::clamp(octave.cell / (3 * detail.voxel) - 1, 0.0f, 1.0f);
    octave.seed = mixed(octave.seed ^ detail.seed);
    return octave;
}

void add(const LeafPoints& points, const Octave& octave, LeafValues out) {
    if (octave.amplitude == 0) return;
    if (octave.noise == Noise::gradient)
        add_gradient_noise(points, octave, out);
    else
        add_humps(points, octave, out);
}

}  // namespace

void add_noise(const LeafPoints& points, std::span<const Octave> octaves, const Detail& detail,
               LeafValues out) {
    for (const Octave& octave : octaves) add(points, band_limited(octave, detail), out);
}

bool add_noise_above_zero(const LeafPoints& points, std::span<const Octave> octaves,
                          const Detail& detail, LeafValues out) {
    float remaining = 1e-5f;  // margin for rounding
    for (const Octave& octave : octaves) remaining += upper_bound_of(band_limited(octave, detail));
    for (const Octave& octave : octaves) {
        if (interval_of(out).upper + remaining <= 0) return false;
        const Octave next = band_limited(octave, detail);
        add(points, next, out);
        remaining -= upper_bound_of(next);
    }
    return interval_of(out).upper > 0;
}

void add_warp(const LeafPoints& points, const Octave& octave, const Detail& detail,
              LeafPoints& moved) {
    add(points, band_limited(octave, {mixed(detail.seed + 1), detail.voxel}), moved.x);
    add(points, band_limited(octave, {mixed(detail.seed + 2), detail.voxel}), moved.y);
    add(points, band_limited(octave, {mixed(detail.seed + 3), detail.voxel}), moved.z);
}

Interval interval_of(std::span<const float> values) {
    // Eight lanes, which compilers vectorise; minima do not depend on the order.
    constexpr std::size_t kLanes = 8;
    assert(!values.empty() && values.size() % kLanes == 0);
    std::array<float, kLanes> lower, upper;
    for (std::size_t lane = 0; lane < kLanes; ++lane) lower[lane] = upper[lane] = values[lane];
    for (std::size_t n = kLanes; n < values.size(); n += kLanes)
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const float value = values[n + lane];
            lower[lane] = value < lower[lane] ? value : lower[lane];
            upper[lane] = value > upper[lane] ? value : upper[lane];
        }
    return {*std::min_element(lower.begin(), lower.end()),
            *std::max_element(upper.begin(), upper.end())};
}

}  // namespace vog::sampling
