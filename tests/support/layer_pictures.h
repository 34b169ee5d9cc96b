// layer_pictures.h: volume pictures of layers, light by pixel.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "vog/picture.h"
#include "vog/scene.h"

namespace vog::test {

/// Along -z, parallel rays through the middles of 32^2 pixels over 2 units.
inline PictureRequest request_of(std::vector<Layer> layers) {
    PictureRequest request;
    request.show = Show::volume;
    request.layers = std::move(layers);
    Camera camera;
    camera.eye = {0, 0, 5}, camera.look_at = {0, 0, 0}, camera.orthographic_width = 2;
    request.camera = camera;
    request.width = request.height = 32;
    return request;
}
inline std::vector<Rgba> light_of(std::vector<vog::Scene> scenes, const PictureRequest& request) {
    return render(scene_of_layers(std::move(scenes)), request).sums.light;
}
inline double largest_difference(const std::vector<Rgba>& a, const std::vector<Rgba>& b) {
    double most = a.size() == b.size() ? 0 : HUGE_VAL;
    for (std::size_t n = 0; n < std::min(a.size(), b.size()); ++n)
        for (const auto part : {&Rgba::r, &Rgba::g, &Rgba::b, &Rgba::a})
            most = std::max(most, std::abs(double{a[n].*part} - double{b[n].*part}));
    return most;
}

}  // namespace vog::test
