// splats.cpp: opacity of a splat with the optical depth of a Gaussian.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.h"
#include "vog/error.h"
#include "vog/exchange.h"

namespace vog {

namespace {

/// Li2(x) = -integral from 0 to x of ln(1 - t) / t dt, for x in [0, 1].
double dilogarithm(double x) {
    // Li2(x) + Li2(1 - x) = pi^2 / 6 - ln(x) ln(1 - x): the series for the smaller of the two.
    const auto series = [](double z) {
        double sum = 0, power = z;
        for (int n = 1; n <= 60; ++n, power *= z) sum += power / (double(n) * n);
        return sum;
    };
    if (x <= 0.5) return series(x);
    if (x >= 1) return std::numbers::pi * std::numbers::pi / 6;
    return std::numbers::pi * std::numbers::pi / 6 - std::log(x) * std::log1p(-x) - series(1 - x);
}

/// x in (0, kMost] with Li2(x) = y, or kMost.
double inverse_dilogarithm(double y) {
    constexpr double kMost = 0.9999;
    if (y >= dilogarithm(kMost)) return kMost;
    double low = 0, high = kMost;
    for (int n = 0; n < 48; ++n) {
        const double middle = 0.5 * (low + high);
        (dilogarithm(middle) < y ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

/// Mean over directions of the product of the standard deviations across a direction: along the unit vector d it is
/// s0 s1 s2 sqrt(sum (d_k / s_k)^2).
double mean_area(Vec3d s) {
    // Lebedev's rule of 26 points, exact to degree 7, of which opposite ones are equal: axes, edges' and faces' middles of
    // the octahedron.
    const double a = s.y * s.z, b = s.x * s.z, c = s.x * s.y;
    const auto area = [&](double x, double y, double z) {
        return std::sqrt(x * x * a * a + y * y * b * b + z * z * c * c);
    };
    const double half = std::sqrt(0.5), third = std::sqrt(1.0 / 3);
    return (area(1, 0, 0) + area(0, 1, 0) + area(0, 0, 1)) * (2 / 21.0) +
           (area(half, half, 0) + area(half, 0, half) + area(0, half, half)) * (16 / 105.0) +
           area(third, third, third) * (9 / 35.0);
}

}  // namespace

Splats splats_of(const Gaussians& model, std::span<const Vec3f> color,
                 const SplatsOptions& options) {
    validate(model);
    if (!(options.extinction > 0) || !std::isfinite(options.extinction))
        throw Error(fmt::format("extinction {}, expected > 0", options.extinction));
    if (!color.empty() && color.size() != model.size())
        throw Error(fmt::format("{} colours, expected {}", color.size(), model.size()));
    for (const Vec3f c : color)
        for (int axis = 0; axis < 3; ++axis)
            if (!(c[axis] >= 0 && c[axis] <= 1))
                throw Error(fmt::format("colour {},{},{}, expected in [0, 1]", c.x, c.y, c.z));
    const Box box = view_box(model);
    const Vec3d edges = box.upper - box.lower;
    const double edge = std::max({edges.x, edges.y, edges.z});
    const bool moved = options.unit_box && !box.empty() && edge > 0;
    const double unit = moved ? 2 / edge : 1;
    const Vec3d center = moved ? box.center() : Vec3d{};

    Splats splats;
    const std::size_t count = model.size();
    splats.source = model.source;
    splats.world_scale = 1 / unit, splats.world_center = center;
    splats.mean.resize(count), splats.scale.resize(count), splats.rotation.resize(count);
    splats.opacity.resize(count);
    splats.color.assign(color.begin(), color.end());
    if (color.empty()) splats.color.assign(count, {1, 1, 1});
    vog::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
        splats.mean[i] = vec_cast<float>(unit * (world_mean(model, i) - center));
        const Vec3d s = vec_cast<double>(model.scale[i]);
        splats.scale[i] = vec_cast<float>(unit * s);
        splats.rotation[i] =
            model.axis_aligned() ? Quat{} : quat_from_matrix(matrix_from_quat(model.rotation[i]));
        const double depth =
            options.extinction * mass(model, i) / (2 * std::numbers::pi * mean_area(s));
        splats.opacity[i] = static_cast<float>(inverse_dilogarithm(depth));
    });
    return splats;
}

}  // namespace vog
