// ray_sums.h: Sums along rays through voxels, in double precision: moments of a field, and light from the front to the back.
// Shared by the reference and OptiX's rays through voxels.
#pragma once

#include "render/device/vector.h"

namespace vog::device {

/// Sums along a ray in units of a picture.
struct RaySums {
    double column = 0, first = 0, second = 0;
};

/// Sums of a measure over one ray, or the rays of a pixel, with the field relative to its first value on
/// them: a field that hardly varies keeps its digits.
struct FirstRelative {
    RaySums sums{};
    double reference = 0;
    bool met = false;

    VOG_HD void add(double weight, double value) {
        if (!(weight > 0)) return;
        if (!met) reference = value, met = true;
        const double difference = value - reference;
        sums.column += weight;
        sums.first += weight * difference;
        sums.second += weight * difference * difference;
    }
};

/// Transmittance at which a ray ends: a ten-thousandth of a display step, less than the promised 1e-6.
constexpr double kOpaqueLight = 1e-4 / 255;

/// Light along a ray, front to back.
struct RayLight {
    double r = 0, g = 0, b = 0, transmittance = 1;

    VOG_HD bool opaque() const { return transmittance < kOpaqueLight; }
    /// Adds a piece of constant extinction and colour.
    /// depth  its extinction times its length
    VOG_HD void add(double depth, double red, double green, double blue) {
        const double passed = exp(-depth), weight = transmittance * (1 - passed);
        r += weight * red, g += weight * green, b += weight * blue;
        transmittance *= passed;
    }
};

}  // namespace vog::device
