// shading.h: Blinn and Phong's shading of a field by its gradient, for every renderer of volume pictures.
#pragma once

#include "render/device/light/light_lattice.h"

namespace vog::device {

/// Shaded colour = body times the colour + shine, at most 1.
struct Shading {
    double body, shine;
};

/// A light of a picture.
struct DirectLight {
    Double3 towards;  ///< unit length; 0 0 0: the eye
    double strength;  ///< factor of the weights of direct light
};

/// Lights and weights of a picture: VolumeLook (vog/volume_picture.h).
struct BlinnPhong {
    int32_t on;      ///< whether surfaces are shaded
    int32_t lights;  ///< none: all light is ambient
    DirectLight light[kMostLights];
    double ambient, diffuse, specular, power;
    double asymmetry;  ///< of the phase function, where no surface is

    VOG_HD Double3 towards(int32_t n, Double3 towards_eye) const {
        return dot(light[n].towards, light[n].towards) > 0 ? light[n].towards : towards_eye;
    }
    /// Share of a light that goes to the eye, of what an even phase function sends there.
    VOG_HD double phase(int32_t n, Double3 towards_eye) const {
        if (asymmetry == 0) return 1;
        const double c = -dot(towards(n, towards_eye), towards_eye), g = asymmetry;
        return (1 - g * g) * pow(1 + g * g - 2 * g * c, -1.5);
    }
    /// gradient     of the field, of any length; 0 is no surface
    /// towards_eye  unit length
    VOG_HD Shading shading(Double3 gradient, Double3 towards_eye,
                           const ReachedLight& reached) const;
    /// Shading without a surface, which faces no light: the colour itself where all light of one of strength 1 arrives.
    VOG_HD Shading spread(Double3 towards_eye, const ReachedLight& reached) const {
        const double whole = ambient + diffuse;
        if (!(whole > 0)) return {1, 0};
        double direct = 0;
        for (int32_t n = 0; n < lights; ++n)
            direct +=
                light[n].strength * phase(n, towards_eye) * static_cast<double>(reached.direct(n));
        return {(ambient * static_cast<double>(reached.ambient()) + diffuse * direct) / whole, 0};
    }
};

VOG_HD Shading BlinnPhong::shading(Double3 gradient, Double3 towards_eye,
                                   const ReachedLight& reached) const {
    const double steepness = sqrt(dot(gradient, gradient));
    if (!on || !(steepness > 0) || !isfinite(steepness)) return spread(towards_eye, reached);
    Double3 normal = (1 / steepness) * gradient;
    if (dot(normal, towards_eye) < 0) normal = -1.0 * normal;
    Shading sum{ambient * static_cast<double>(reached.ambient()), 0};
    for (int32_t n = 0; n < lights; ++n) {
        const Double3 to = towards(n, towards_eye), between = to + towards_eye;
        const double facing = dot(normal, to);
        if (!(facing > 0)) continue;
        const double direct = light[n].strength * static_cast<double>(reached.direct(n));
        sum.body += diffuse * facing * direct;
        const double mirrored =
            fmin(fmax(dot(normal, between) / sqrt(dot(between, between)), 0.0), 1.0);
        if (mirrored > 0) sum.shine += specular * pow(mirrored, power) * direct;
    }
    return sum;
}

}  // namespace vog::device
