// gpu_drawing.cpp: Pictures of fields and values on a GPU, and their options.
#include "fields/gpu_drawing.h"

#include <fmt/core.h>

#include <cmath>

namespace vog::cli {

bool on_gpu(Renderer renderer) { return renderer == Renderer::cuda || renderer == Renderer::optix; }

namespace {

/// throws  CLI::ValidationError for options of T alone
void refuse_options_of_depth(const RenderArguments& arguments, const Drawing& drawing) {
    const DrawingArguments& given = arguments.drawing;
    const auto refuse = [&](const char* option, const char* expected) {
        throw CLI::ValidationError(fmt::format("{}: is of T, --show {} with --renderer {} has {}",
                                               option, arguments.quantity.show,
                                               info_of(drawing.renderer).name, expected));
    };
    if (given.samples != 1) refuse("--samples", "one ray a pixel");
    if (given.anyhit != "accumulate") refuse("--anyhit collect", "sums");
    if (given.stop_transmittance > 0) refuse("--stop-transmittance", "no end of rays");
}

}  // namespace

std::shared_ptr<GpuPictures> gpu_pictures(const RenderArguments& arguments, Drawing& drawing,
                                          const std::shared_ptr<const Gaussians>& model) {
    const DrawingArguments& given = arguments.drawing;
    refuse_options_of_depth(arguments, drawing);
    // The pictures refer to the model.
    struct Kept {
        std::shared_ptr<const Gaussians> model;
        GpuPictures pictures;
    };
    const auto kept = std::make_shared<Kept>(
        Kept{model, {drawing.renderer, *model, {given.aabb_sigma, given.kappa}}});
    const std::shared_ptr<GpuPictures> pictures(kept, &kept->pictures);
    drawing.picture_ms = [pictures] { return pictures->gpu_ms(); };
    return pictures;
}

CutFields gpu_cut(const RenderArguments& arguments, Drawing& drawing,
                  const std::shared_ptr<const Gaussians>& model,
                  const std::shared_ptr<const Hierarchy>& hierarchy) {
    const DrawingArguments& given = arguments.drawing;
    refuse_options_of_depth(arguments, drawing);
    // Cut at the end of the kernels that are drawn; 0: the model's.
    const double cutoff = given.kappa > 0 ? std::sqrt(-2 * std::log(given.kappa)) : 0;
    const auto cut = std::make_shared<ViewCut>(*model, *hierarchy, cutoff);
    const auto ms = std::make_shared<double>(0);
    drawing.picture_ms = [ms] { return *ms; };
    return [=, renderer = drawing.renderer, options = CutOptions{*given.pixel_error, true},
            scene = TraceSceneOptions{0, given.kappa}](const FieldChoice& shown,
                                                       const Camera& camera, Size size,
                                                       const Clipping& clip, CutReport* report) {
        (void)model, (void)hierarchy;  // the cut refers to them
        GpuPictures pictures(
            renderer, cut->choose(frame_of(camera, size.width, size.height), options), scene);
        FieldMaps maps = pictures.fields(shown, camera, size.width, size.height, clip);
        *ms = pictures.gpu_ms();
        if (report) *report = cut->report();
        return maps;
    };
}

namespace {

std::shared_ptr<GpuVolumes> timed_by(Drawing& drawing, std::shared_ptr<GpuVolumes> volumes) {
    drawing.picture_ms = [volumes] { return volumes->gpu_ms(); };
    return volumes;
}

}  // namespace

std::shared_ptr<GpuVolumes> gpu_volumes(Drawing& drawing, std::span<const Volume> volumes,
                                        std::span<const VoxelField> fields) {
    return timed_by(drawing, std::make_shared<GpuVolumes>(volumes, fields));
}

std::shared_ptr<GpuVolumes> gpu_volumes(Drawing& drawing, const Levels& levels,
                                        std::span<const VoxelField> fields) {
    return timed_by(drawing, std::make_shared<GpuVolumes>(levels, fields));
}

}  // namespace vog::cli
