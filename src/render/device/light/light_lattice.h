// light_lattice.h: Shares of light that reach points of the world, on a lattice (docs/volume_rendering.md, "Shadows").
#pragma once

#include "render/device/vector.h"

namespace vog::device {

/// Shares of light that reach a point, 0 to 1.
struct ReachedLight {
    float direct;   ///< of the light from its direction
    float ambient;  ///< of the light from all directions
};

/// Shares at the centres of cubic cells along the world's axes, linear between them, and beyond the outer ones as there.
/// The lattice knows the place of a surface only to a cell. Points beside opaque matter therefore look their light up in front of it:
/// towards the eye, since nothing in front of what is seen absorbs, and towards the light.
struct LightLattice {
    static constexpr float kTowardsEye = 3, kTowardsLight = 2;  ///< cells

    const float* direct;   ///< [size z][size y][size x]; null: all light reaches every point
    const float* ambient;  ///< the same for ambient light
    /// [size z][size y][size x] how far towards the eye and the light a point looks its light up, 0 to 1; null: nowhere
    const float* opaque;
    int32_t size[3];  ///< at least 2
    Double3 first;    ///< centre of the first cell
    double per_edge;  ///< cells per unit of length
    Double3 towards;  ///< the light; unit length, or 0 0 0
    double shift;     ///< factor of kTowardsEye and kTowardsLight

    VOG_HD bool any() const { return direct || ambient; }
    /// A value between cells.
    /// place  in cells, from the centre of the first
    VOG_HD float between(const float* values, Double3 place) const;
    /// towards_eye  unit length
    VOG_HD ReachedLight at(Double3 point, Double3 towards_eye) const {
        Double3 place = per_edge * (point - first);
        if (opaque) {
            const double away = shift * static_cast<double>(between(opaque, place));
            place = place + (away * static_cast<double>(kTowardsEye)) * towards_eye +
                    (away * static_cast<double>(kTowardsLight)) * towards;
        }
        return {direct ? between(direct, place) : 1, ambient ? between(ambient, place) : 1};
    }
};

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
