// periodic_box.cpp: the box that a periodic model states, and pictures inside it.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "vog/error.h"
#include "vog/periodic.h"

namespace vog {

Box box_of_numbers(std::span<const double> n) {
    Box box;
    if (n.size() == 1) box = {{}, {n[0], n[0], n[0]}};
    if (n.size() == 3) box = {{}, {n[0], n[1], n[2]}};
    if (n.size() == 6) box = {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
    for (int axis = 0; axis < 3; ++axis) {
        const double edge = box.upper[axis] - box.lower[axis];
        if (!(edge > 0) || !std::isfinite(edge))
            throw Error(
                "periodic box: expected its edge, its three edges, or x0,y0,z0,x1,y1,z1 with edges "
                "above 0");
    }
    return box;
}

std::optional<Box> periodic_box(const Gaussians& model) {
    const std::size_t at = model.options.find(kPeriodicOption);
    if (at == std::string::npos) return {};
    const char* text = model.options.c_str() + at + std::string_view(kPeriodicOption).size();
    const char* end = model.options.c_str() + model.options.size();
    std::array<double, 6> n{};
    for (double& number : n) {
        const auto [stop, code] = std::from_chars(text, end, number);
        if (code != std::errc{}) return {};
        text = std::min(stop + 1, end);
    }
    return box_of_numbers(n);
}

Clipping inside_period(Clipping clip, const Gaussians& model) {
    const std::optional<Box> period = periodic_box(model);
    if (!period) return clip;
    if (!clip.box) clip.box = period;
    for (int axis = 0; axis < 3; ++axis) {
        double& lower = clip.box->lower[axis];
        double& upper = clip.box->upper[axis];
        lower = std::max(lower, period->lower[axis]);
        upper = std::min(upper, period->upper[axis]);
        if (!(lower < upper)) throw Error("clip: lies outside the periodic box of the model");
    }
    return clip;
}

}  // namespace vog
