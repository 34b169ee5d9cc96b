// gpu_drawing.h: Models and volumes with fields on a GPU.
#pragma once

#include <functional>
#include <memory>

#include "shared/render_run.h"
#include "vog/gpu_pictures.h"
#include "vog/gpu_volumes.h"

namespace vog::cli {

/// Whether a renderer draws on a GPU.
bool on_gpu(Renderer renderer);

/// The model on the GPU of the drawing's renderer; sets Drawing::picture_ms.
/// throws  CLI::ValidationError for options that pictures of fields and values do not have there; vog::Error as
///         GpuPictures does
std::shared_ptr<GpuPictures> gpu_pictures(const RenderArguments& arguments, Drawing& drawing,
                                          const std::shared_ptr<const Gaussians>& model);
/// Maps of a model's field by the Gaussians of a cut through its hierarchy, which each picture sends to the GPU.
using CutFields = std::function<FieldMaps(const FieldChoice&, const Camera&, Size, const Clipping&,
                                          CutReport* report)>;
/// Maps with --pixel-error, likewise.
CutFields gpu_cut(const RenderArguments& arguments, Drawing& drawing,
                  const std::shared_ptr<const Gaussians>& model,
                  const std::shared_ptr<const Hierarchy>& hierarchy);
/// Volumes with their fields on the GPU, likewise.
std::shared_ptr<GpuVolumes> gpu_volumes(Drawing& drawing, std::span<const Volume> volumes,
                                        std::span<const VoxelField> fields);
std::shared_ptr<GpuVolumes> gpu_volumes(Drawing& drawing, const Levels& levels,
                                        std::span<const VoxelField> fields);

}  // namespace vog::cli
