// gpu_drawing.h: Models with fields on a GPU.
#pragma once

#include <memory>

#include "shared/render_run.h"
#include "vog/gpu_pictures.h"

namespace vog::cli {

/// Whether a renderer draws on a GPU.
bool on_gpu(Renderer renderer);

/// The model on the GPU of the drawing's renderer; sets Drawing::pictures.
/// throws  CLI::ValidationError for options that pictures of fields and values do not have there; vog::Error as
///         GpuPictures does
std::shared_ptr<GpuPictures> gpu_pictures(const RenderArguments& arguments, Drawing& drawing,
                                          const std::shared_ptr<const Gaussians>& model);

}  // namespace vog::cli
