// volume_run.cpp: pictures by value, emission and absorption, from inputs to files, and their report.
#include <fmt/core.h>

#include <algorithm>

#include "fields/value_inputs.h"
#include "fields/value_transfer_run.h"
#include "vog/error.h"

namespace vog::cli {

namespace {

/// Picture of the inputs, with progress, into an earlier one's memory.
using DrawVolume = std::function<void(const ValueTransfer&, const Camera&, int, int,
                                      const Progress&, VolumeImage& picture)>;

/// The renderers of models by value: the one place that knows them.
/// throws  CLI::ValidationError and vog::Error for options and renderers that draw no model by value
DrawVolume model_renderer(const RenderArguments& arguments, const ValueInputs& inputs) {
    const std::shared_ptr<const Gaussians> model = inputs.model;
    const std::string field = inputs.label;
    const DrawingArguments& given = arguments.drawing;
    VolumeLook look = look_of(arguments.value);
    look.clip = clip_of(given);
    if (inputs.drawing.renderer == Renderer::trace) {
        if (arguments.value.slabs)
            throw CLI::ValidationError("--slabs: is of splat, trace draws in exact order");
        const TraceSceneOptions scene{given.aabb_sigma, given.kappa};
        return [=](const ValueTransfer& transfer, const Camera& camera, int width, int height,
                   const Progress& progress, VolumeImage& picture) {
            TraceOptions options;
            options.progress = progress;
            picture = render_volume_trace(*model, field, transfer, camera, width, height, options,
                                          scene, look);
        };
    }
    if (given.aabb_sigma != 0)
        throw CLI::ValidationError("--aabb-sigma: is of T, column density and trace");
    SlabOptions options;
    options.slabs = arguments.value.slabs.value_or(options.slabs);
    options.kappa = given.kappa;
    options.look = look;
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

DrawVolume volume_renderer(const RenderArguments& arguments, const ValueInputs& inputs) {
    ReferenceOptions options;
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
    return [=, data = inputs.volumes](const ValueTransfer& transfer, const Camera& camera,
                                      int width, int height, const Progress& progress,
                                      VolumeImage& picture) mutable {
        options.progress = progress;
        picture = render_volume_reference(data->volumes, data->field, transfer, camera, width,
                                          height, options, look, voxels);
    };
}

/// Alpha of a picture, as the figures of reports take T.
DepthImage alpha_of(const VolumeImage& picture) {
    DepthImage alpha(picture.width, picture.height);
    std::ranges::transform(picture.pixel, alpha.depth.begin(), &Rgba::a);
    return alpha;
}

}  // namespace

std::optional<RenderedPicture> render_volume(const RenderArguments& arguments,
                                             const CLI::App& command, const RenderRanks& ranks) {
    const Size size = parse_size(arguments.size);
    const ShadeOptions shading = shading_of(arguments.color);
    const ThreadLimit limit(arguments.threads);
    Stages stages(arguments.verbose);
    ValueInputs volume = stages.run("load", [&] { return load_values(arguments, command, ranks); });
    const DrawVolume drawn =
        volume.model ? model_renderer(arguments, volume) : volume_renderer(arguments, volume);
    Drawing& drawing = volume.drawing;
    const Box box = arguments.box.value_or(drawing.box);
    const Camera camera =
        camera_from(arguments.view, command, box, double(size.width) / size.height);
    const ValueData data{arguments.drawing.inputs.front(), volume.lower, volume.upper,
                         2 * box.radius()};
    const ChosenTransfer chosen = stages.run("transfer function", [&] {
        const auto draw = [&](const ValueTransfer& transfer, const Camera& from, int width,
                              int height) {
            VolumeImage small;
            drawn(transfer, from, width, height, {}, small);
            return small;
        };
        return choose_transfer(arguments, command, data, draw, camera, size);
    });
    print_notes(chosen.notes);
    drawing.notes.insert(drawing.notes.end(), chosen.notes.begin(), chosen.notes.end());

    const Progress progress = arguments.repeat ? Progress{} : stages.progress();
    VolumeImage image;
    std::vector<double> render_ms = stages.run("render", [&] {
        return timed(arguments, [&] {
            drawn(chosen.transfer, camera, size.width, size.height, progress, image);
        });
    });
    if (!arguments.output.empty())
        stages.run("save", [&] { write_image(arguments.output, over(image, shading.background)); });
    if (!arguments.view.save_camera.empty()) write_camera(arguments.view.save_camera, camera);
    const ColorScale scale{ColorScale::Kind::linear, chosen.lower, chosen.upper};
    RenderedPicture picture =
        figures_of(arguments, drawing, alpha_of(image), std::move(render_ms), stages, scale);
    picture.quantity = "volume of " + volume.label;
    picture.units = volume.unit;
    picture.scale = scale;
    picture.unit_distance = chosen.transfer.unit_distance;
    picture.mean_opacity = mean_opacity(image);
    picture.camera = camera;
    return picture;
}

}  // namespace vog::cli
