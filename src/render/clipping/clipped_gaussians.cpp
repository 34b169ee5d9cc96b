// clipped_gaussians.cpp: Supports of Gaussians beside planes.
#include "render/clipping/clipped_gaussians.h"

#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace vog::clipping {

Box support_box(const Gaussians& gaussians, double cutoff) {
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, gaussians.size(), 1 << 14), Box{},
        [&](const tbb::blocked_range<std::size_t>& range, Box box) {
            for (std::size_t i = range.begin(); i < range.end(); ++i) {
                const Vec3d mean = vec_cast<double>(gaussians.mean[i]);
                const Vec3f s = gaussians.scale[i];
                const double r = cutoff * double{std::max({s.x, s.y, s.z})};
                box.include({mean - Vec3d{r, r, r}, mean + Vec3d{r, r, r}});
            }
            return box;
        },
        [](Box a, const Box& b) {
            a.include(b);
            return a;
        });
}

Clipping cutting(Clipping clip, const Box& box) {
    if (box.empty()) return {};
    std::erase_if(clip.planes, [&](const ClipPlane& plane) {
        double least = 0;
        for (int axis = 0; axis < 3; ++axis)
            least += std::min(plane.normal[axis] * box.lower[axis],
                              plane.normal[axis] * box.upper[axis]);
        return least >= plane.offset;
    });
    bool inside = true;
    for (int axis = 0; axis < 3 && clip.box; ++axis)
        inside = inside && clip.box->lower[axis] <= box.lower[axis] &&
                 clip.box->upper[axis] >= box.upper[axis];
    if (inside) clip.box.reset();
    return clip;
}

GaussianClip::GaussianClip(const Clipping& clip, const Gaussians& gaussians, double cutoff)
    : clip_(relative_to(clip, gaussians.origin)), gaussians_(gaussians), cutoff_(cutoff) {
    validate(clip);
    for (const ClipPlane& plane : clip_.planes) {
        // Squares of a long normal leave the range of doubles.
        const Vec3d n = plane.normal;
        const double largest = std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)});
        const Vec3d scaled = (1 / largest) * n;
        const double per = 1 / length(scaled);
        planes_.push_back({per * scaled, per * (plane.offset / largest)});
    }
    if (!clip_.box) return;
    for (int axis = 0; axis < 3; ++axis) {
        Vec3d normal;
        normal[axis] = 1;
        planes_.push_back({normal, clip_.box->lower[axis]});
        planes_.push_back({-normal, -clip_.box->upper[axis]});
    }
}

Kept GaussianClip::of(std::size_t i) const {
    const Vec3d mean = vec_cast<double>(gaussians_.mean[i]);
    const Vec3d scale = vec_cast<double>(gaussians_.scale[i]);
    // The sphere around the support first: most Gaussians are far from every plane.
    const double radius = cutoff_ * std::max({scale.x, scale.y, scale.z});
    double nearest = std::numeric_limits<double>::infinity();
    for (const ClipPlane& plane : planes_)
        nearest = std::min(nearest, dot(plane.normal, mean) - plane.offset);
    if (nearest >= radius) return Kept::all;
    if (nearest <= -radius) return Kept::none;
    const Mat3 own_from_world =
        gaussians_.axis_aligned() ? Mat3{} : transpose(matrix_from_quat(gaussians_.rotation[i]));
    Kept kept = Kept::all;
    for (const ClipPlane& plane : planes_) {
        const Vec3d own = own_from_world * plane.normal;
        const double reach =
            cutoff_ * length(Vec3d{own.x * scale.x, own.y * scale.y, own.z * scale.z});
        const double inside = dot(plane.normal, mean) - plane.offset;
        if (inside <= -reach) return Kept::none;
        if (inside < reach) kept = Kept::part;
    }
    return kept;
}

double GaussianClip::share_at_mean(std::size_t i, const CameraFrame& frame) const {
    return clipping::share_at_mean(clip_, vec_cast<double>(gaussians_.mean[i]),
                                   whitening(gaussians_, i), cutoff_, frame);
}

double share_at_mean(const Clipping& clip, Vec3d mean, const Mat3& whitening, double cutoff,
                     const CameraFrame& frame) {
    const Vec3d from_eye = mean - frame.eye;
    const Vec3d direction = frame.orthographic ? frame.forward : normalized(from_eye);
    const double depth = dot(from_eye, direction);
    const RayInterval seen = clipped_ray(clip, mean - depth * direction, direction);
    const double per_deviation = length(whitening * direction);
    const auto integral_to = [&](double t) {
        return std::erf(std::clamp((t - depth) * per_deviation, -cutoff, cutoff) /
                        std::numbers::sqrt2);
    };
    const double whole = 2 * std::erf(cutoff / std::numbers::sqrt2);
    return seen.first < seen.last ? (integral_to(seen.last) - integral_to(seen.first)) / whole : 0;
}

}  // namespace vog::clipping
