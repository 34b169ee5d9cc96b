// volume_picture.cpp: pictures by value over a background, and the checks of their look.
#include "vog/volume_picture.h"

#include <fmt/core.h>

#include <cmath>

#include "vog/error.h"

namespace vog {

Image over(std::span<const Rgba> light, int width, int height, const Rgba& background) {
    for (const float c : {background.r, background.g, background.b, background.a})
        if (!(c >= 0 && c <= 1))
            throw Error(fmt::format("background ({}, {}, {}, {}), expected numbers in [0, 1]",
                                    background.r, background.g, background.b, background.a));
    Image image(width, height);
    for (std::size_t n = 0; n < light.size(); ++n) {
        const Rgba& front = light[n];
        // Porter-Duff over; an Image's colour is not multiplied by alpha.
        const float behind = background.a * (1 - front.a);
        const float alpha = background.a == 1 ? 1 : front.a + behind;
        if (alpha > 0)
            image.pixel[n] = {(front.r + behind * background.r) / alpha,
                              (front.g + behind * background.g) / alpha,
                              (front.b + behind * background.b) / alpha, alpha};
        else
            image.pixel[n] = {background.r, background.g, background.b, 0};
    }
    return image;
}

Vec3d studio_light(const Camera& camera) {
    const CameraFrame frame = frame_of(camera, 1, 1);
    return normalized(-0.6 * frame.right + 0.9 * frame.up - 0.6 * frame.forward);
}

std::vector<DirectionalLight> lights_of(const VolumeLook& look) {
    return look.lights.empty() ? std::vector<DirectionalLight>(1) : look.lights;
}

VolumeLook lights_in_view(VolumeLook look, const CameraFrame& frame) {
    for (auto& [to, of_camera, strength] : look.lights)
        if (of_camera) {
            to = to.x * frame.right + to.y * frame.up - to.z * frame.forward;
            of_camera = false;
        }
    return look;
}

void validate(const VolumeLook& look) {
    validate(look.clip);
    const auto require = [](const char* name, double value, bool valid) {
        if (!valid || !std::isfinite(value))
            throw Error(fmt::format("light: {} {}, expected a number {} 0", name, value,
                                    name == std::string("power") ? ">" : ">="));
    };
    require("ambient", look.ambient, look.ambient >= 0);
    require("diffuse", look.diffuse, look.diffuse >= 0);
    require("specular", look.specular, look.specular >= 0);
    require("power", look.power, look.power > 0);
    if (look.octaves < 1 || look.octaves > kMostOctaves)
        throw Error(fmt::format("light: {} octaves of scattering, expected 1 to {}", look.octaves,
                                kMostOctaves));
    if (!(look.asymmetry > -1 && look.asymmetry < 1))
        throw Error(fmt::format("light: asymmetry {} of scattering, expected between -1 and 1",
                                look.asymmetry));
    if (look.lights.size() > kMostDirectionalLights)
        throw Error(fmt::format("light: {} lights, expected {} at most", look.lights.size(),
                                kMostDirectionalLights));
    for (const auto& [to, of_camera, strength] : look.lights) {
        require("strength", strength, strength >= 0);
        if (!std::isfinite(dot(to, to)))
            throw Error(fmt::format("light: direction {},{},{}, expected finite numbers", to.x,
                                    to.y, to.z));
    }
}

}  // namespace vog
