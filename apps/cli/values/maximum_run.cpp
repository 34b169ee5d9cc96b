// maximum_run.cpp: maximum intensity projections, from inputs to files, and their report.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "fields/gpu_drawing.h"
#include "values/value_inputs.h"
#include "values/value_maps.h"
#include "vog/error.h"
#include "vog/maximum_picture.h"
#include "vog/picture.h"

namespace vog::cli {

namespace {

using DrawMaximum = std::function<ValueMap(const Camera&, Size, const Progress&)>;

/// The renderers of maxima: the one place that knows them.
/// throws  CLI::ValidationError for options that are of others
DrawMaximum maximum_renderer(const RenderArguments& arguments, ValueInputs& inputs,
                             const RenderRanks& ranks) {
    const DrawingArguments& given = arguments.drawing;
    const Clipping clip = inputs.model ? clip_of(given, *inputs.model) : clip_of(given);
    const std::string field = inputs.label;
    if (inputs.volumes) {
        const Collective* processes = ranks.divided() ? &ranks.collective : nullptr;
        if (on_gpu(inputs.drawing.renderer))
            return [=, samples = given.samples,
                    volumes = gpu_volumes(inputs.drawing, inputs.volumes->volumes,
                                          inputs.volumes->field)](const Camera& camera, Size size,
                                                                  const Progress& progress) {
                ValueMap map =
                    volumes->maximum(camera, size.width, size.height, {{}, samples, clip});
                if (progress) progress(1);
                return map;
            };
        return [=, data = inputs.volumes, samples = given.samples](const Camera& camera, Size size,
                                                                   const Progress& progress) {
            return render_maximum_reference(data->volumes, data->field, camera, size.width,
                                            size.height, {progress, samples, clip, processes});
        };
    }
    if (inputs.drawing.renderer == Renderer::trace) {
        const TraceSceneOptions scene{given.aabb_sigma, given.kappa};
        return
            [=, model = inputs.model](const Camera& camera, Size size, const Progress& progress) {
                TraceOptions options;
                options.progress = progress;
                return render_maximum_trace(*model, field, camera, size.width, size.height, options,
                                            scene, clip);
            };
    }
    if (on_gpu(inputs.drawing.renderer))
        return [=, slabs = arguments.value.slabs.value_or(kMaximumSlabs),
                pictures = gpu_pictures(arguments, inputs.drawing, inputs.model)](
                   const Camera& camera, Size size, const Progress& progress) {
            ValueMap map = pictures->maximum(field, camera, size.width, size.height, slabs, clip);
            if (progress) progress(1);
            return map;
        };
    SlabOptions options;
    options.slabs = arguments.value.slabs.value_or(kMaximumSlabs);
    options.kappa = given.kappa;
    options.look.clip = clip;
    if (ranks.divided()) options.collective = &ranks.collective;
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

std::vector<RenderedPicture> render_maximum(const RenderArguments& arguments,
                                            const CLI::App& command, const RenderRanks& ranks) {
    return render_map(arguments, command, ranks, [&] {
        ValueInputs inputs = load_values(arguments, command, ranks);
        const auto map = std::make_shared<ValueMap>();
        MapDrawing made;
        const auto factor = static_cast<float>(units_factor(inputs.unit, arguments.quantity.units));
        made.draw = [=, draw = maximum_renderer(arguments, inputs, ranks)](
                        const Camera& camera, Size size, const Progress& progress) {
            *map = draw(camera, size, progress);
            for (float& value : map->value) value *= factor;
        };
        made.picture = [=, label = inputs.label,
                        unit = inputs.unit](const QuantityArguments& quantity) {
            const auto fixed = fixed_scale(quantity);
            return MapPicture{
                quantity_label("maximum", label),
                unit,
                *map,
                map->value,
                covered_pixels(*map),
                fixed ? *fixed : fitted_scale(map->value, quantity.fit()),
            };
        };
        made.write = [=](const std::string& file) { write_maximum(file, *map); };
        made.drawing = std::move(inputs.drawing);
        return made;
    });
}

}  // namespace vog::cli
