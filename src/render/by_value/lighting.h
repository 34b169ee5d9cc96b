// lighting.h: Blinn and Phong's shading of a field by its gradient, for every renderer of volume pictures.
#pragma once

#include "render/device/light/shading.h"
#include "vog/linear.h"
#include "vog/volume_picture.h"

namespace vog::by_value {

using device::Shading;

/// Light and weights of a picture for the formulas of device/light/shading.h.
inline device::BlinnPhong blinn_phong(const VolumeLook& look) {
    const Vec3d to =
        length(look.towards_light) > 0 ? normalized(look.towards_light) : Vec3d{0, 0, 0};
    // Without a light from a direction all light is ambient.
    const bool directed = look.light || look.shadows;
    return {look.light ? 1 : 0,
            {to.x, to.y, to.z},
            directed ? look.ambient : look.ambient + look.diffuse,
            directed ? look.diffuse : 0,
            look.specular,
            look.power,
            directed ? look.asymmetry : 0};
}

/// Light and weights of a picture.
class Lighting {
  public:
    explicit Lighting(const VolumeLook& look) : look_(blinn_phong(look)) {}
    bool on() const { return look_.on != 0; }
    /// As BlinnPhong::shading.
    Shading operator()(Vec3d gradient, Vec3d towards_eye, device::ReachedLight reached) const {
        return look_.shading({gradient.x, gradient.y, gradient.z},
                             {towards_eye.x, towards_eye.y, towards_eye.z}, reached);
    }

  private:
    device::BlinnPhong look_;
};

}  // namespace vog::by_value
