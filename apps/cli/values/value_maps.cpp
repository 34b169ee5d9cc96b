// value_maps.cpp: one map of values from inputs to files.
#include "values/value_maps.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "films/views.h"
#include "vog/picture.h"

namespace vog::cli {

namespace {

/// Figures of the shown values in place of T's.
void set_figures(const RenderArguments& arguments, const MapPicture& map,
                 RenderedPicture& picture) {
    picture.quantity = map.name;
    picture.units = map.unit;
    picture.scale = map.scale;
    picture.above_range = share_above(map.values, map.scale.high);
    picture.values_output = arguments.quantity.values_output;
    if (map.cut) picture.cut = map.cut;
    double sum = 0, most = -HUGE_VAL;
    std::size_t count = 0;
    for (const float value : map.values) {
        if (std::isnan(value)) continue;
        ++count;
        sum += double{value};
        most = std::max(most, double{value});
    }
    picture.mean_t = count ? sum / static_cast<double>(count) : 0;
    picture.max_t = count ? most : 0;
}

}  // namespace

std::vector<RenderedPicture> render_map(const RenderArguments& arguments, const CLI::App& command,
                                        const RenderRanks& ranks,
                                        const std::function<MapDrawing()>& load) {
    const Size size = parse_size(arguments.size);
    const TransferFunction tf = load_transfer_function(arguments.color.tf);
    (void)shading_of(arguments.color);  // checks --background
    const ThreadLimit limit(arguments.threads);
    Stages stages(arguments.verbose && ranks.is_root);
    const MapDrawing loaded = stages.run("load", load);
    const Drawing& drawing = loaded.drawing;
    const auto draw = [&](const RenderArguments& one,
                          const Camera& camera) -> std::optional<RenderedPicture> {
        const QuantityArguments& quantity = one.quantity;
        const Progress progress = one.repeat ? Progress{} : stages.progress();
        std::vector<double> render_ms = stages.run(
            "render", [&] { return timed(one, [&] { loaded.draw(camera, size, progress); }); });
        if (!ranks.is_root) return std::nullopt;
        MapPicture map = loaded.picture(quantity);
        if (!quantity.units.empty()) map.unit = quantity.units;
        if (!one.output.empty()) {
            const Image image = stages.run("shade", [&] {
                return annotated_picture(one, drawing, camera,
                                         shade_map(map.shown, tf, map.scale, shading_of(one.color)),
                                         tf, map.scale, with_unit(map.name, map.unit));
            });
            stages.run("save", [&] { save_picture(one, image); });
        }
        if (!quantity.values_output.empty()) loaded.write(quantity.values_output);
        if (!one.view.save_camera.empty()) write_camera(one.view.save_camera, camera);
        RenderedPicture picture =
            figures_of(one, drawing, map.covered, std::move(render_ms), stages, map.scale);
        set_figures(one, map, picture);
        picture.camera = camera;
        return picture;
    };
    return render_views(arguments, command, drawing.subject, size, draw);
}

}  // namespace vog::cli
