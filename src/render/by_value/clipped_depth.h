// clipped_depth.h: T of a model where a clip cuts its chords, by the loops of pictures by value.
#pragma once

#include "render/trace/trace.h"
#include "vog/camera.h"
#include "vog/clip.h"
#include "vog/gaussians.h"
#include "vog/image.h"

namespace vog::by_value {

/// A field of a model without one: value 0 everywhere.
ScalarField still_field(const Gaussians& gaussians);
/// T at extinction 1 of the parts of all Gaussians that the clip leaves, exact on each ray.
/// throws  vog::Error as render_volume_splat and render_volume_trace do
DepthImage clipped_depth_splat(const Gaussians& gaussians, const Clipping& clip, double kappa,
                               const Camera& camera, int width, int height);
DepthImage clipped_depth_trace(const Gaussians& gaussians, const Clipping& clip, double kappa,
                               const Camera& camera, int width, int height,
                               const TraceOptions& options);

}  // namespace vog::by_value
