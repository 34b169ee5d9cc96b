// lighting.h: Blinn and Phong's shading of a field by its gradient, for every renderer of volume pictures.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "vog/linear.h"
#include "vog/volume_picture.h"

namespace vog::by_value {

/// Shaded colour = body times the colour + shine, at most 1.
struct Shading {
    double body = 1, shine = 0;
};

/// Light and weights of a picture.
class Lighting {
  public:
    explicit Lighting(const VolumeLook& look) : look_(look) {
        if (length(look.towards_light) > 0) towards_light_ = normalized(look.towards_light);
    }
    bool on() const { return look_.light; }
    /// gradient     of the field, of any length; 0 has no shading
    /// towards_eye  unit length
    Shading operator()(Vec3d gradient, Vec3d towards_eye) const {
        const double steepness = length(gradient);
        if (!look_.light || !(steepness > 0) || !std::isfinite(steepness)) return {};
        Vec3d normal = (1 / steepness) * gradient;
        if (dot(normal, towards_eye) < 0) normal = -normal;
        const Vec3d towards_light = towards_light_.value_or(towards_eye);
        const double facing = std::max(dot(normal, towards_light), 0.0);
        const Vec3d between = towards_light + towards_eye;
        const double mirrored =
            facing > 0 ? std::clamp(dot(normal, between) / length(between), 0.0, 1.0) : 0;
        return {look_.ambient + look_.diffuse * facing,
                mirrored > 0 ? look_.specular * std::pow(mirrored, look_.power) : 0};
    }

  private:
    VolumeLook look_;
    std::optional<Vec3d> towards_light_;  ///< nothing: the eye
};

}  // namespace vog::by_value
