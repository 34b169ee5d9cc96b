// gpu_drawing.cpp: Options of pictures of fields and values on a GPU.
#include "fields/gpu_drawing.h"

#include <fmt/core.h>

namespace vog::cli {

bool on_gpu(Renderer renderer) { return renderer == Renderer::cuda || renderer == Renderer::optix; }

std::shared_ptr<GpuPictures> gpu_pictures(const RenderArguments& arguments, Drawing& drawing,
                                          const std::shared_ptr<const Gaussians>& model) {
    const DrawingArguments& given = arguments.drawing;
    const auto refuse = [&](const char* option, const char* expected) {
        throw CLI::ValidationError(fmt::format("{}: is of T, --show {} with --renderer {} has {}",
                                               option, arguments.quantity.show,
                                               info_of(drawing.renderer).name, expected));
    };
    if (given.samples != 1) refuse("--samples", "one ray a pixel");
    if (given.anyhit != "accumulate") refuse("--anyhit collect", "sums");
    if (given.stop_transmittance > 0) refuse("--stop-transmittance", "no end of rays");
    // The pictures refer to the model.
    struct Kept {
        std::shared_ptr<const Gaussians> model;
        GpuPictures pictures;
    };
    const auto kept = std::make_shared<Kept>(
        Kept{model, {drawing.renderer, *model, {given.aabb_sigma, given.kappa}}});
    const std::shared_ptr<GpuPictures> pictures(kept, &kept->pictures);
    drawing.pictures = pictures;
    return pictures;
}

}  // namespace vog::cli
