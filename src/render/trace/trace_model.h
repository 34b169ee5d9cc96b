// trace_model.h: A model packed for the ray-tracing programs: scene units, whitenings, boxes.
#pragma once

#include <vector>

#include "render/device/any_hit.h"
#include "render/device/camera_ray.h"
#include "render/device/gaussian_hit.h"
#include "render/device/tile_splat.h"
#include "vog/camera.h"
#include "vog/gaussians.h"

namespace vog::trace {

/// Box of one primitive of a hierarchy, relative to TraceModel::center, scene units, rounded
/// outwards. Same layout as OptixAabb.
struct FloatBox {
    float lower[3], upper[3];
};

struct TraceModel {
    Vec3d origin;  ///< Gaussians::origin; all other members are relative to it
    std::vector<device::Gaussian> gaussians;
    std::vector<FloatBox> boxes;
    device::Bounds bounds{};       ///< of all boxes and supports, scene units
    device::Bounds scene{};        ///< box that the paper's boxes are clamped to, scene units
    device::Double3 center{};      ///< of the bounds, scene units
    double unit = 1;               ///< world units of one scene unit: a power of two
    double depth_unit = 1;         ///< T of one unit of the sums over Gaussians: a power of two
    float cutoff2 = 0;             ///< k²
    device::SplatKernel kernel{};  ///< of the Gaussians that are splatted
    bool boxed = false;            ///< rays count only Gaussians whose paper's box they meet
    device::SumRounding rounding{};
};

/// Packs a model.
/// aabb_sigma, kappa  TraceSceneOptions
/// throws             vog::Error as trace_scene does
TraceModel trace_model(const Gaussians& gaussians, double aabb_sigma, double kappa);

/// The camera in scene units.
/// frame  relative to the model's origin
device::Camera scene_camera(const CameraFrame& frame, double unit);

/// Margin of the boxes on every side, scene units. A hierarchy's rays are in floats: origins up to 1
/// and lengths up to 2 have three rounding errors of 2^-23.
inline constexpr double kBoxSlack = 0x1p-20;

}  // namespace vog::trace
