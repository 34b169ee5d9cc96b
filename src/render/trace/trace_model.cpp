// trace_model.cpp: Packs a model for ray tracing: whitenings, boxes and rounding in scene units.
#include "render/trace/trace_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/core.h>

#include "render/shown_field.h"
#include "render/trace/splat_kernel.h"
#include "vog/error.h"

namespace vog::trace {

namespace {

device::Float3 plain_float(Vec3d v) { return device::to_float(plain(v)); }

void check(const Gaussians& gaussians, double aabb_sigma) {
    validate(gaussians);
    if (!(aabb_sigma >= 0 && std::isfinite(aabb_sigma)))
        throw Error(fmt::format("trace: aabb_sigma {}, expected a finite number >= 0, 0: no boxes",
                                aabb_sigma));
    if (gaussians.size() >= std::numeric_limits<std::uint32_t>::max())
        throw Error(fmt::format("trace: {} Gaussians, expected fewer than 2^32", gaussians.size()));
}

/// Half edges of the box around the ellipsoid of `radii` standard deviations.
Vec3d half_edges(const Gaussians& gaussians, std::size_t i, double radii) {
    const Mat3 world_from_own =
        gaussians.axis_aligned() ? Mat3{} : matrix_from_quat(gaussians.rotation[i]);
    const Vec3d s = vec_cast<double>(gaussians.scale[i]);
    Vec3d half;
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3d row = world_from_own.row[static_cast<std::size_t>(axis)];
        half[axis] = radii * length(Vec3d{row.x * s.x, row.y * s.y, row.z * s.z});
    }
    return half;
}

Box clamped(Box box, const Box& to) {
    for (int axis = 0; axis < 3; ++axis) {
        box.lower[axis] = std::clamp(box.lower[axis], to.lower[axis], to.upper[axis]);
        box.upper[axis] = std::clamp(box.upper[axis], to.lower[axis], to.upper[axis]);
    }
    return box;
}

/// T along the longest axis through the peak, the largest of a ray, but for the truncation.
double most_depth(const Gaussians& gaussians, std::size_t i) {
    const Vec3d s = vec_cast<double>(gaussians.scale[i]);
    return std::sqrt(2 * std::numbers::pi) * double{gaussians.density[i]} *
           std::max({s.x, s.y, s.z});
}

/// depth_per_unit  of scene length, at density 1
device::Gaussian packed(const Gaussians& gaussians, std::size_t i, double unit,
                        double depth_per_unit, Vec3d half) {
    // A scale below 1e-30 of the scene would leave the range of floats: it is raised to 1e-30 at the
    // same mass, which changes no pixel.
    constexpr double kThinnest = 1e-30;
    double density = double{gaussians.density[i]} * depth_per_unit;
    Mat3 w = gaussians.axis_aligned() ? Mat3{} : transpose(matrix_from_quat(gaussians.rotation[i]));
    for (int axis = 0; axis < 3; ++axis) {
        const double scale = double{gaussians.scale[i][axis]} / unit;
        const double kept = std::max(scale, kThinnest);
        density *= scale / kept;
        Vec3d& row = w.row[static_cast<std::size_t>(axis)];
        row = (1 / kept) * row;
    }
    device::Gaussian g;
    g.mean = plain_float((1 / unit) * vec_cast<double>(gaussians.mean[i]));
    g.density = static_cast<float>(std::min(density, double{std::numeric_limits<float>::max()}));
    for (std::size_t n = 0; n < 3; ++n) g.w[n] = plain_float(w.row[n]);
    g.half = plain_float((1 / unit) * half);
    return g;
}

FloatBox rounded_outwards(const Box& box, Vec3d center, double unit) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    FloatBox out;
    for (int axis = 0; axis < 3; ++axis) {
        const double lower = (box.lower[axis] - center[axis]) / unit - kBoxSlack;
        const double upper = (box.upper[axis] - center[axis]) / unit + kBoxSlack;
        out.lower[axis] = std::nextafter(static_cast<float>(lower), -kInfinity);
        out.upper[axis] = std::nextafter(static_cast<float>(upper), kInfinity);
    }
    return out;
}

/// Quanta of 2^-50 and 2^-80 of an upper bound on any ray's T.
device::SumRounding rounding_for(double bound) {
    const int exponent = bound > 0 ? std::ilogb(bound) + 1 : 0;
    const double coarse = std::ldexp(1.0, exponent - 50), fine = std::ldexp(1.0, exponent - 80);
    return {1.5 * 0x1p52 * coarse, 1.5 * 0x1p52 * fine, fine};
}

}  // namespace

TraceModel trace_model(const Gaussians& gaussians, double aabb_sigma, double kappa) {
    check(gaussians, aabb_sigma);
    const double cutoff = cutoff_of_kappa(kappa, gaussians.cutoff);
    TraceModel model;
    model.origin = gaussians.origin;
    model.boxed = aabb_sigma > 0;
    model.cutoff2 = static_cast<float>(cutoff * cutoff);
    model.kernel = splat_kernel(cutoff);

    // Boxes in world units from the origin, and their common bounds.
    const double radii = model.boxed ? aabb_sigma * std::numbers::sqrt2 : cutoff;
    const Box scene = moved(view_box(gaussians), -model.origin);
    std::vector<Box> boxes(gaussians.size());
    Box bounds;
    for (std::size_t i = 0; i < gaussians.size(); ++i) {
        const Vec3d mean = vec_cast<double>(gaussians.mean[i]);
        const Vec3d half = half_edges(gaussians, i, radii);
        boxes[i] = {mean - half, mean + half};
        if (model.boxed) boxes[i] = clamped(boxes[i], scene);
        bounds.include(boxes[i]);
        // A Gaussian whose box is met counts in full, also outside the box: rays must start before
        // its whole support.
        if (model.boxed) {
            const Vec3d support = half_edges(gaussians, i, cutoff);
            bounds.include({mean - support, mean + support});
        }
    }
    if (bounds.empty()) bounds = {{0, 0, 0}, {0, 0, 0}};
    const double radius = bounds.radius();
    if (radius > 0) model.unit = std::ldexp(1.0, std::ilogb(radius) + 1);
    const double per_unit = 1 / model.unit;
    const auto in_scene = [&](const Box& box) {
        return device::Bounds{plain(per_unit * box.lower), plain(per_unit * box.upper)};
    };
    model.center = plain(per_unit * bounds.center());
    // Margin, so that the rim of a support on the face of the bounds is not clipped away.
    model.bounds = in_scene(bounds);
    const device::Double3 slack{kBoxSlack, kBoxSlack, kBoxSlack};
    model.bounds = {model.bounds.lower - slack, model.bounds.upper + slack};
    model.scene = in_scene(scene.empty() ? bounds : scene);

    // Sums are in units of the largest tau of a Gaussian: densities of 1e-40 or 1e38 would leave the
    // range of floats, times the scene unit.
    double most = 0;
    for (std::size_t i = 0; i < gaussians.size(); ++i)
        most = std::max(most, most_depth(gaussians, i));
    if (most > 0) model.depth_unit = std::ldexp(1.0, std::ilogb(most));

    // Shares of small Gaussians (small_gaussians.h) are below 2: the ball that small cutoffs tend to has at least
    // half its mass on any lattice at kLeastDeviationPx.
    constexpr double kMostShare = 2;
    double bound = 0;
    model.gaussians.resize(gaussians.size());
    model.boxes.resize(gaussians.size());
    for (std::size_t i = 0; i < gaussians.size(); ++i) {
        model.gaussians[i] = packed(gaussians, i, model.unit, model.unit / model.depth_unit,
                                    half_edges(gaussians, i, radii));
        model.boxes[i] = rounded_outwards(boxes[i], bounds.center(), model.unit);
        bound += most_depth(gaussians, i) / model.depth_unit;
    }
    model.rounding = rounding_for(kMostShare * bound);
    return model;
}

device::Camera scene_camera(const CameraFrame& frame, double unit) {
    const double per_unit = 1 / unit;
    return {plain(per_unit * frame.first_origin),
            plain(per_unit * frame.shift_x),
            plain(per_unit * frame.shift_y),
            plain(frame.corner),
            plain(frame.step_x),
            plain(frame.step_y),
            frame.width,
            frame.height,
            frame.orthographic ? 1 : 0};
}

}  // namespace vog::trace
