// maximum_run.cpp: maximum intensity projections, from inputs to files, and their report.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "fields/value_inputs.h"
#include "fields/value_maps.h"
#include "vog/error.h"
#include "vog/maximum_picture.h"

namespace vog::cli {

namespace {

using DrawMaximum = std::function<ValueMap(const Camera&, Size, const Progress&)>;

/// The renderers of maxima: the one place that knows them.
/// throws  CLI::ValidationError for options that are of others
DrawMaximum maximum_renderer(const RenderArguments& arguments, const ValueInputs& inputs) {
    const DrawingArguments& given = arguments.drawing;
    const Clipping clip = clip_of(given);
    const std::string field = inputs.label;
    if (inputs.volumes)
        return
            [=, data = inputs.volumes](const Camera& camera, Size size, const Progress& progress) {
                return render_maximum_reference(data->volumes, data->field, camera, size.width,
                                                size.height, {progress, given.samples, clip});
            };
    if (inputs.drawing.renderer == Renderer::trace) {
        if (arguments.value.slabs)
            throw CLI::ValidationError("--slabs: is of splat, trace draws in exact order");
        const TraceSceneOptions scene{given.aabb_sigma, given.kappa};
        return
            [=, model = inputs.model](const Camera& camera, Size size, const Progress& progress) {
                TraceOptions options;
                options.progress = progress;
                return render_maximum_trace(*model, field, camera, size.width, size.height, options,
                                            scene, clip);
            };
    }
    if (given.aabb_sigma != 0)
        throw CLI::ValidationError("--aabb-sigma: is of T, column density and trace");
    SlabOptions options;
    options.slabs = arguments.value.slabs.value_or(kMaximumSlabs);
    options.kappa = given.kappa;
    options.look.clip = clip;
    return [=, model = inputs.model](const Camera& camera, Size size, const Progress& progress) {
        ValueMap map =
            render_maximum_splat(*model, field, camera, size.width, size.height, options);
        if (progress) progress(1);
        return map;
    };
}

/// 1 where a map has a value: the figures of reports are of covered pixels.
DepthImage covered_pixels(const ValueMap& map) {
    DepthImage covered(map.width, map.height);
    std::ranges::transform(map.value, covered.depth.begin(),
                           [](float value) { return std::isnan(value) ? 0.0F : 1.0F; });
    return covered;
}

void write_maximum(const std::string& file, const ValueMap& map) {
    if (file.ends_with(".exr")) {
        const NamedValues channels[] = {{"maximum", map.value}};
        write_channels(file, map.width, map.height, channels);
    } else {
        write_map(file, map);
    }
}

}  // namespace

std::optional<RenderedPicture> render_maximum(const RenderArguments& arguments,
                                              const CLI::App& command, const RenderRanks& ranks) {
    const QuantityArguments& quantity = arguments.quantity;
    const Size size = parse_size(arguments.size);
    const TransferFunction tf = load_transfer_function(arguments.color.tf);
    (void)shading_of(arguments.color);  // checks --background
    const ThreadLimit limit(arguments.threads);
    Stages stages(arguments.verbose);
    const ValueInputs inputs =
        stages.run("load", [&] { return load_values(arguments, command, ranks); });
    const DrawMaximum draw = maximum_renderer(arguments, inputs);
    const Drawing& drawing = inputs.drawing;
    const Camera camera = camera_from(arguments.view, command, arguments.box.value_or(drawing.box),
                                      double(size.width) / size.height);
    const Progress progress = arguments.repeat ? Progress{} : stages.progress();
    ValueMap map;
    std::vector<double> render_ms = stages.run(
        "render", [&] { return timed(arguments, [&] { map = draw(camera, size, progress); }); });
    const auto fixed = fixed_scale(quantity);
    const ColorScale scale = fixed ? *fixed : fitted_scale(map.value, quantity.fit());
    const std::string name = "maximum of " + inputs.label;
    const std::string unit = quantity.units.empty() ? inputs.unit : quantity.units;
    if (!arguments.output.empty()) {
        const std::string label = unit.empty() ? name : fmt::format("{} [{}]", name, unit);
        const Image image =
            stages.run("shade", [&] { return map_picture(arguments, map, tf, scale, label); });
        stages.run("save", [&] { write_image(arguments.output, image); });
    }
    if (!quantity.values_output.empty()) write_maximum(quantity.values_output, map);
    if (!arguments.view.save_camera.empty()) write_camera(arguments.view.save_camera, camera);
    RenderedPicture picture =
        figures_of(arguments, drawing, covered_pixels(map), std::move(render_ms), stages, scale);
    set_figures(arguments, map.value, scale, picture);
    picture.quantity = name;
    picture.units = unit;
    picture.camera = camera;
    return picture;
}

}  // namespace vog::cli
