// projected_mean.h: A Gaussian's mean and axes as a picture sees them, for planes of fields over its pixels.
#pragma once

#include "render/splat/splat_kernels.h"

namespace vog::splat {

/// The mean as the picture shows it.
struct ShownMean {
    Vec3d from_eye;        ///< p
    double forward;        ///< t0; parallel rays: 1
    Vec3d step_x, step_y;  ///< across the view, world units a pixel at forward component 1
};
template <class Splat>
ShownMean shown_mean(const Gaussians& gaussians, std::size_t i, const FarSplat& splat,
                     const CameraFrame& frame, Splat& out) {
    const Vec3d p = vec_cast<double>(gaussians.mean[i]) - frame.eye;
    const double pixel = 1 / frame.pixels_per_unit;
    const ShownMean at{p, frame.orthographic ? 1 : dot(p, frame.forward), pixel * frame.right,
                       -pixel * frame.up};
    const double pixels = frame.pixels_per_unit / at.forward;
    const AxisPixel axis = axis_pixel(frame);
    const double x = pixels * dot(p, frame.right) + axis.column;
    const double y = -pixels * dot(p, frame.up) + axis.row;
    out.mean_x = static_cast<float>(x - splat.column);
    out.mean_y = static_cast<float>(y - splat.row);
    return at;
}

/// The view direction in the Gaussian's own axes.
inline Vec3d own_forward(const Gaussians& gaussians, std::size_t i, const CameraFrame& frame) {
    if (gaussians.axis_aligned()) return frame.forward;
    // q⁻¹ f q by two cross products.
    const Quat q = gaussians.rotation[i];
    const Vec3d v{double{q.x}, double{q.y}, double{q.z}};
    const double w = double{q.w}, scale = 2 / (w * w + dot(v, v));
    const Vec3d once = cross(frame.forward, v);
    return frame.forward + scale * (w * once + cross(once, v));
}
inline Vec3d times(Vec3d a, Vec3d b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
inline Vec3d over(Vec3d a, Vec3d b) { return {a.x / b.x, a.y / b.y, a.z / b.z}; }

/// A plane over the pixels of parallel rays: the point of a ray nearest to the mean moves along the ray, too.
struct ParallelNearest {
    double depth_x, depth_y;  ///< change of its depth a pixel, world units
    double variance;          ///< along a ray, world units squared
};
inline ParallelNearest parallel_nearest(const Gaussians& gaussians, std::size_t i,
                                        const CameraFrame& frame, const ShownMean& at) {
    // Wᵀ W f is the normal of the plane of nearest points.
    const Vec3d scale = vec_cast<double>(gaussians.scale[i]);
    const Vec3d own = own_forward(gaussians, i, frame), whitened = over(own, scale);
    const Vec3d own_normal = over(whitened, scale);
    const Vec3d normal = gaussians.axis_aligned()
                             ? own_normal
                             : matrix_from_quat(gaussians.rotation[i]) * own_normal;
    const double variance = 1 / dot(whitened, whitened);
    return {-variance * dot(normal, at.step_x), -variance * dot(normal, at.step_y), variance};
}

}  // namespace vog::splat
