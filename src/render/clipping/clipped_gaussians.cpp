// clipped_gaussians.cpp: Supports of Gaussians beside planes.
#include "render/clipping/clipped_gaussians.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace vog::clipping {

GaussianClip::GaussianClip(const Clipping& clip, const Gaussians& gaussians, double cutoff)
    : clip_(relative_to(clip, gaussians.origin)), gaussians_(gaussians), cutoff_(cutoff) {
    validate(clip);
    planes_ = clip_.planes;
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
    const Vec3d mean = vec_cast<double>(gaussians_.mean[i]), from_eye = mean - frame.eye;
    const Vec3d direction = frame.orthographic ? frame.forward : normalized(from_eye);
    const double depth = dot(from_eye, direction);
    const RayInterval seen = ray(mean - depth * direction, direction);
    const double per_deviation = length(whitening(gaussians_, i) * direction);
    const auto integral_to = [&](double t) {
        return std::erf(std::clamp((t - depth) * per_deviation, -cutoff_, cutoff_) /
                        std::numbers::sqrt2);
    };
    const double whole = 2 * std::erf(cutoff_ / std::numbers::sqrt2);
    return seen.first < seen.last ? (integral_to(seen.last) - integral_to(seen.first)) / whole : 0;
}

}  // namespace vog::clipping
