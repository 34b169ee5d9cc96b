// option_scene.h: The model, view and looks of the GPU suite's checks of options, the same where the CPU draws what is
// expected (prepare.cpp) and where the GPU is (option_checks.cpp).
#pragma once

#include "render/trace/trace.h"
#include "vog/camera.h"
#include "vog/gaussians.h"
#include "vog/value_transfer.h"
#include "vog/volume_picture.h"

namespace vog::test {

inline constexpr int kOptionWidth = 301, kOptionHeight = 203;
inline constexpr double kBoxSigma = 1, kKappa = 0.1;

/// Rays of `stop.pfm`.
inline TraceOptions stopping_rays() {
    TraceOptions options;
    options.anyhit = AnyHit::collect;
    options.hits_per_slab = 16;
    options.stop_transmittance = 0.001;
    options.extinction = 2;
    return options;
}

inline Camera option_camera(const Gaussians& model) {
    Camera camera = paper_view(view_box(model));
    camera.fov_degrees *= 1.2;
    return camera;
}
inline Clipping option_clip(const Gaussians& model) {
    const Vec3d center = view_box(model).center();
    Clipping clip;
    clip.planes = {{{1, 0.4, -0.2}, dot(Vec3d{1, 0.4, -0.2}, center)}};
    return clip;
}
inline VolumeLook option_look(const Gaussians& model) {
    VolumeLook look;
    look.light = true;
    look.lights = {{{0.3, 1, 0.2}}};
    look.clip = option_clip(model);
    return look;
}
/// A band and a ramp over a field's range.
inline ValueTransfer option_transfer(const ScalarField& field, double unit_distance) {
    const double low = field.lower, range = field.upper - field.lower;
    return {"suite",
            {{low, 0, 0, 1}, {low + 0.4 * range, 0, 1, 0}, {low + range, 1, 0, 0}},
            {{low, 0},
             {low + 0.1 * range, 0.2},
             {low + 0.2 * range, 0.2},
             {low + 0.25 * range, 0},
             {low + range, 0.9}},
            unit_distance};
}

}  // namespace vog::test
