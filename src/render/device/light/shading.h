// shading.h: Blinn and Phong's shading of a field by its gradient, for every renderer of volume pictures.
#pragma once

#include "render/device/light/light_lattice.h"

namespace vog::device {

/// Shaded colour = body times the colour + shine, at most 1.
struct Shading {
    double body, shine;
};

/// Light and weights of a picture: VolumeLook (vog/volume_picture.h).
struct BlinnPhong {
    int32_t on;             ///< whether surfaces are shaded
    Double3 towards_light;  ///< unit length; 0 0 0: the eye
    double ambient, diffuse, specular, power;
    double asymmetry;  ///< of the phase function, where no surface is

    /// Share of direct light that goes to the eye, of what an even phase function sends there.
    VOG_HD double phase(Double3 towards_eye) const {
        if (asymmetry == 0) return 1;
        const Double3 light = dot(towards_light, towards_light) > 0 ? towards_light : towards_eye;
        const double c = -dot(light, towards_eye), g = asymmetry;
        return (1 - g * g) * pow(1 + g * g - 2 * g * c, -1.5);
    }
    /// gradient     of the field, of any length; 0 is no surface
    /// towards_eye  unit length
    VOG_HD Shading shading(Double3 gradient, Double3 towards_eye, ReachedLight reached) const;
    /// Shading without a surface, which faces no light: the colour itself where all light arrives.
    VOG_HD Shading spread(Double3 towards_eye, ReachedLight reached) const {
        const double whole = ambient + diffuse;
        return {whole > 0 ? (ambient * static_cast<double>(reached.ambient) +
                             diffuse * phase(towards_eye) * static_cast<double>(reached.direct)) /
                                whole
                          : 1,
                0};
    }
};

VOG_HD Shading BlinnPhong::shading(Double3 gradient, Double3 towards_eye,
                                   ReachedLight reached) const {
    const double steepness = sqrt(dot(gradient, gradient));
    if (!on || !(steepness > 0) || !isfinite(steepness)) return spread(towards_eye, reached);
    Double3 normal = (1 / steepness) * gradient;
    if (dot(normal, towards_eye) < 0) normal = -1.0 * normal;
    const Double3 light = dot(towards_light, towards_light) > 0 ? towards_light : towards_eye;
    const double facing = fmax(dot(normal, light), 0.0);
    const Double3 between = light + towards_eye;
    const double mirrored =
        facing > 0 ? fmin(fmax(dot(normal, between) / sqrt(dot(between, between)), 0.0), 1.0) : 0;
    const double direct = reached.direct;
    return {ambient * static_cast<double>(reached.ambient) + diffuse * facing * direct,
            mirrored > 0 ? specular * pow(mirrored, power) * direct : 0};
}

}  // namespace vog::device
