// lighting.h: Blinn and Phong's shading of a field by its gradient, for every renderer of volume pictures.
#pragma once

#include "render/device/light/shading.h"
#include "vog/linear.h"
#include "vog/volume_picture.h"

namespace vog::by_value {

using device::Shading;

static_assert(kMostDirectionalLights == device::kMostLights);

/// Lights, fixed in the world, and weights of a picture for the formulas of device/light/shading.h.
inline device::BlinnPhong blinn_phong(const VolumeLook& look) {
    device::BlinnPhong out{
        look.light ? 1 : 0, 0, {}, look.ambient, look.diffuse, look.specular, look.power,
        look.asymmetry};
    // Without a light from a direction all light is ambient.
    if (!look.light && !look.shadows) {
        out.ambient += out.diffuse, out.diffuse = out.asymmetry = 0;
        return out;
    }
    for (const DirectionalLight& light : lights_of(look)) {
        const Vec3d to = light.towards == Vec3d{} ? Vec3d{} : normalized(light.towards);
        out.light[out.lights++] = {{to.x, to.y, to.z}, light.strength};
    }
    return out;
}

/// Light and weights of a picture.
class Lighting {
  public:
    explicit Lighting(const VolumeLook& look) : look_(blinn_phong(look)) {}
    bool on() const { return look_.on != 0; }
    /// As BlinnPhong::shading.
    Shading operator()(Vec3d gradient, Vec3d towards_eye,
                       const device::ReachedLight& reached) const {
        return look_.shading({gradient.x, gradient.y, gradient.z},
                             {towards_eye.x, towards_eye.y, towards_eye.z}, reached);
    }

  private:
    device::BlinnPhong look_;
};

}  // namespace vog::by_value
