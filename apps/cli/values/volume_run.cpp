// volume_run.cpp: pictures by value, emission and absorption, from inputs to files, and their report.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "fields/gpu_drawing.h"
#include "films/views.h"
#include "values/value_inputs.h"
#include "values/value_transfer_run.h"
#include "vog/error.h"

namespace vog::cli {

namespace {

/// Picture of the inputs, with progress, into an earlier one's memory.
using DrawVolume = std::function<void(const ValueTransfer&, const Camera&, int, int,
                                      const Progress&, VolumeImage& picture)>;

/// The renderers of models by value: the one place that knows them.
/// throws  CLI::ValidationError and vog::Error for options and renderers that draw no model by value
DrawVolume model_renderer(const RenderArguments& arguments, ValueInputs& inputs,
                          const RenderRanks& ranks) {
    const std::shared_ptr<const Gaussians> model = inputs.model;
    const std::string field = inputs.label;
    const DrawingArguments& given = arguments.drawing;
    VolumeLook look = look_of(arguments.value);
    look.clip = clip_of(given, *model);
    if (inputs.drawing.renderer == Renderer::trace) {
        const TraceSceneOptions scene{given.aabb_sigma, given.kappa};
        return [=](const ValueTransfer& transfer, const Camera& camera, int width, int height,
                   const Progress& progress, VolumeImage& picture) {
            TraceOptions options;
            options.progress = progress;
            picture = render_volume_trace(*model, field, transfer, camera, width, height, options,
                                          scene, look);
        };
    }
    SlabOptions options;
    if (on_gpu(inputs.drawing.renderer)) {
        const int slabs = arguments.value.slabs.value_or(options.slabs);
        return [=, pictures = gpu_pictures(arguments, inputs.drawing, model)](
                   const ValueTransfer& transfer, const Camera& camera, int width, int height,
                   const Progress& progress, VolumeImage& picture) {
            picture = pictures->volume(field, transfer, camera, width, height, slabs, look);
            if (progress) progress(1);
        };
    }
    options.slabs = arguments.value.slabs.value_or(options.slabs);
    options.kappa = given.kappa;
    options.look = look;
    if (ranks.divided()) options.collective = &ranks.collective;
    // Made with the first transfer function, then kept for pictures under others.
    const auto kept = std::make_shared<std::optional<SlabRenderer>>();
    return [=](const ValueTransfer& transfer, const Camera& camera, int width, int height,
               const Progress& progress, VolumeImage& picture) {
        if (*kept)
            (*kept)->set_transfer(transfer);
        else
            kept->emplace(*model, field, transfer, options);
        (*kept)->render(camera, width, height, picture);
        if (progress) progress(1);
    };
}

DrawVolume volume_renderer(const RenderArguments& arguments, ValueInputs& inputs,
                           const RenderRanks& ranks) {
    ReferenceOptions options;
    if (ranks.divided()) options.collective = &ranks.collective;
    options.samples = arguments.drawing.samples;
    VoxelGridOptions voxels;
    if (arguments.drawing.interpolation == "linear") {
        const std::string& input = arguments.drawing.inputs.front();
        if (inputs.volumes->volumes.size() > 1)
            throw Error(fmt::format(
                "{}: {} volumes or parts of a mesh, --interpolation linear with --show volume is "
                "of one",
                input, inputs.volumes->volumes.size()));
        if (arguments.drawing.step_voxels == 0)
            throw CLI::ValidationError(
                "--step 0: a picture by value has samples, expected a step > 0");
        voxels = {Interpolation::linear, arguments.drawing.step_voxels};
    }
    VolumeLook look = look_of(arguments.value);
    look.clip = clip_of(arguments.drawing);
    if (on_gpu(inputs.drawing.renderer))
        return [=, volumes =
                       gpu_volumes(inputs.drawing, inputs.volumes->volumes, inputs.volumes->field)](
                   const ValueTransfer& transfer, const Camera& camera, int width, int height,
                   const Progress& progress, VolumeImage& picture) {
            picture = volumes->volume(transfer, camera, width, height, options, look);
            if (progress) progress(1);
        };
    return [=, data = inputs.volumes](const ValueTransfer& transfer, const Camera& camera,
                                      int width, int height, const Progress& progress,
                                      VolumeImage& picture) mutable {
        options.progress = progress;
        picture = render_volume_reference(data->volumes, data->field, transfer, camera, width,
                                          height, options, look, voxels,
                                          {data->overlap, data->beside, data->beside_field});
    };
}

/// Mean of alpha over the pixels that have some; 0 where none has.
double mean_opacity(const VolumeImage& picture) {
    double sum = 0;
    std::size_t covered = 0;
    for (const Rgba& pixel : picture.pixel) sum += double{pixel.a}, covered += pixel.a > 0;
    return covered ? sum / static_cast<double>(covered) : 0;
}

/// Alpha of a picture, as the figures of reports take T.
DepthImage alpha_of(const VolumeImage& picture) {
    DepthImage alpha(picture.width, picture.height);
    std::ranges::transform(picture.pixel, alpha.depth.begin(), &Rgba::a);
    return alpha;
}

/// Colours and opacities over the range, as a colour bar takes them.
TransferFunction bar_of(const ChosenTransfer& chosen) {
    constexpr std::size_t kSteps = 1024;  // pixels of a bar, about
    std::vector<Rgba> colors;
    for (std::size_t n = 0; n <= kSteps; ++n) {
        const double share = static_cast<double>(n) / kSteps;
        const auto& [kind, low, high] = chosen.scale;
        const double value = kind == ColorScale::Kind::log ? low * std::pow(high / low, share)
                                                           : std::lerp(low, high, share);
        const ValueLight light = light_of(chosen.transfer, value);
        const double opacity = -std::expm1(-light.extinction * chosen.transfer.unit_distance);
        colors.push_back({static_cast<float>(light.r), static_cast<float>(light.g),
                          static_cast<float>(light.b), static_cast<float>(opacity)});
    }
    return sampled_transfer_function(chosen.transfer.name, colors);
}

}  // namespace

std::vector<RenderedPicture> render_volume(const RenderArguments& arguments,
                                           const CLI::App& command, const RenderRanks& ranks) {
    const Size size = parse_size(arguments.size);
    (void)shading_of(arguments.color);  // checks --background
    const ThreadLimit limit(arguments.threads);
    Stages stages(arguments.verbose && ranks.is_root);
    ValueInputs volume = stages.run("load", [&] { return load_values(arguments, command, ranks); });
    const DrawVolume drawn = volume.model ? model_renderer(arguments, volume, ranks)
                                          : volume_renderer(arguments, volume, ranks);
    Drawing& drawing = volume.drawing;
    std::vector<std::string> notes;
    const ChosenTransfer chosen =
        transfer_of(arguments, command, arguments.drawing.inputs.front(), volume.data, notes);
    if (ranks.is_root) print_notes(notes);
    drawing.notes.insert(drawing.notes.end(), notes.begin(), notes.end());

    VolumeImage image;
    const ColorScale& scale = chosen.scale;
    const auto draw_view = [&](const RenderArguments& one,
                               const Camera& camera) -> std::optional<RenderedPicture> {
        const Progress progress = one.repeat ? Progress{} : stages.progress();
        std::vector<double> render_ms = stages.run("render", [&] {
            return timed(one, [&] {
                drawn(chosen.transfer, camera, size.width, size.height, progress, image);
            });
        });
        if (!ranks.is_root) return std::nullopt;
        if (!one.output.empty()) {
            const Image finished = stages.run("shade", [&] {
                return annotated_picture(
                    one, drawing, camera, over(image, shading_of(one.color).background),
                    bar_of(chosen), scale, quantity_label("volume", volume.label, volume.unit));
            });
            stages.run("save", [&] { save_picture(one, finished); });
        }
        if (!one.view.save_camera.empty()) write_camera(one.view.save_camera, camera);
        RenderedPicture picture =
            figures_of(one, drawing, alpha_of(image), std::move(render_ms), stages, scale);
        picture.quantity = "volume of " + volume.label;
        picture.units = volume.unit;
        picture.scale = scale;
        picture.unit_distance = chosen.transfer.unit_distance;
        picture.mean_opacity = mean_opacity(image);
        picture.camera = camera;
        return picture;
    };
    return render_views(arguments, command, drawing.subject, size, draw_view);
}

}  // namespace vog::cli
