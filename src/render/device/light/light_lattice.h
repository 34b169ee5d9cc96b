// light_lattice.h: Shares of light that reach points of the world, on a lattice (docs/volume_rendering.md, "Shadows").
#pragma once

#include "render/device/vector.h"

namespace vog::device {

/// Directional lights of a picture.
constexpr int32_t kMostLights = 8;

/// Shares at the centres of cubic cells along the world's axes, linear between them, and beyond the outer ones as there.
/// The lattice knows the place of a surface only to a cell. Points beside opaque matter therefore look their light up in front of it:
/// towards the eye, since nothing in front of what is seen absorbs, and towards the light. What is seen of matter without surfaces
/// lies a little inside: 1 / (1 + m) of the light is left there, on whose way lies m times as much matter as on that to the eye.
struct LightLattice {
    static constexpr float kTowardsEye = 3, kTowardsLight = 2;  ///< cells
    static constexpr double kInside = 1.5;  ///< of a light about 50 degrees aside

    const float* direct;   ///< [light][size z][size y][size x]; null: all light reaches every point
    const float* ambient;  ///< [size z][size y][size x] the same for ambient light
    /// [size z][size y][size x] how far towards the eye and the light a point looks its light up, 0 to 1; null: nowhere
    const float* opaque;
    int32_t size[3];               ///< at least 2
    Double3 first;                 ///< centre of the first cell
    double per_edge;               ///< cells per unit of length
    Double3 towards[kMostLights];  ///< the lights of `direct`; unit length, or 0 0 0
    Double3 middle;                ///< mean of these, of ambient light
    double shift;                  ///< factor of kTowardsEye and kTowardsLight
    double inside;                 ///< m: kInside, less with octaves; 0: light falls on surfaces

    VOG_HD bool any() const { return direct || ambient; }
    /// A value between cells.
    /// place  in cells, from the centre of the first
    VOG_HD float between(const float* values, Double3 place) const;
    VOG_HD int64_t cells() const { return static_cast<int64_t>(size[0]) * size[1] * size[2]; }
};

/// Shares of light that reach a point, 0 to 1.
struct ReachedLight {
    const LightLattice* lattice;  ///< null: all light
    Double3 place;                ///< in cells, towards the eye from the point
    double away;                  ///< cells from there towards a light
    float left;                   ///< share that is left inside of opaque matter

    /// Share of a light from its direction.
    VOG_HD float direct(int32_t light) const {
        return !lattice || !lattice->direct
                   ? 1
                   : left * lattice->between(lattice->direct + light * lattice->cells(),
                                             place + away * lattice->towards[light]);
    }
    /// Share of the light from all directions.
    VOG_HD float ambient() const {
        return !lattice || !lattice->ambient
                   ? 1
                   : left * lattice->between(lattice->ambient, place + away * lattice->middle);
    }
};
/// towards_eye  unit length
VOG_HD ReachedLight reached_at(const LightLattice& lattice, Double3 point, Double3 towards_eye) {
    if (!lattice.any()) return {nullptr, point, 0, 1};
    const Double3 place = lattice.per_edge * (point - lattice.first);
    if (!lattice.opaque) return {&lattice, place, 0, 1};
    const double opaque{lattice.between(lattice.opaque, place)}, away = lattice.shift * opaque;
    return {&lattice, place + (away * static_cast<double>(LightLattice::kTowardsEye)) * towards_eye,
            away * static_cast<double>(LightLattice::kTowardsLight),
            static_cast<float>(1 / (1 + opaque * lattice.inside))};
}

VOG_HD float LightLattice::between(const float* values, Double3 place) const {
    const double along[3] = {place.x, place.y, place.z};
    int64_t at = 0, stride = 1;
    float beyond[3];
    for (int c = 0; c < 3; ++c) {
        const double within = fmin(fmax(along[c], 0.0), static_cast<double>(size[c] - 1));
        const int32_t floor = static_cast<int32_t>(within);
        const int32_t cell = floor < size[c] - 2 ? floor : size[c] - 2;
        beyond[c] = static_cast<float>(within - static_cast<double>(cell));
        at += cell * stride;
        stride *= size[c];
    }
    const int64_t row = size[0], layer = row * size[1];
    float of_layer[2];
    for (int z = 0; z < 2; ++z) {
        const float* p = values + at + z * layer;
        const float low = p[0] + beyond[0] * (p[1] - p[0]);
        const float high = p[row] + beyond[0] * (p[row + 1] - p[row]);
        of_layer[z] = low + beyond[1] * (high - low);
    }
    return of_layer[0] + beyond[2] * (of_layer[1] - of_layer[0]);
}

}  // namespace vog::device
