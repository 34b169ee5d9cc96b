// trace_model.h: a model as the ray-tracing programs take it: scene units, whitenings, boxes.
#pragma once

#include <vector>

#include "render/device/any_hit.h"
#include "render/device/camera_ray.h"
#include "render/device/gaussian_hit.h"
#include "vog/camera.h"
#include "vog/gaussians.h"

namespace vog::trace {

/// One primitive's box for a hierarchy: relative to TraceModel::center, in scene units, rounded
/// outwards. The layout of OptixAabb.
struct FloatBox {
    float lower[3], upper[3];
};

struct TraceModel {
    std::vector<device::Gaussian> gaussians;
    std::vector<FloatBox> boxes;
    device::Bounds bounds{};   ///< of all boxes and supports, scene units
    device::Bounds scene{};    ///< what the paper's boxes are clamped to
    device::Double3 center{};  ///< of the bounds
    double unit = 1;           ///< world units of one scene unit: a power of two
    float cutoff2 = 0;         ///< k²
    bool boxed = false;        ///< the paper's boxes decide what is found
    device::SumRounding rounding{};
};

/// aabb_sigma, kappa  as in TraceSceneOptions
/// throws             vog::Error as trace_scene does
TraceModel trace_model(const Gaussians& gaussians, double aabb_sigma, double kappa);

device::Camera scene_camera(const CameraFrame& frame, double unit);

/// Boxes are this much wider on every side than what they bound, in scene units. Rays reach a
/// hierarchy in floats: origins of at most 1 and lengths of at most 2 are 2^-23 off, thrice.
inline constexpr double kBoxSlack = 0x1p-20;

}  // namespace vog::trace
