// render_run.cpp: one picture from inputs to file, and its report.
#include "pictures/render_run.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "files/outputs.h"
#include "help/version.h"
#include "pictures/request_file.h"
#include "pictures/views.h"
#include "vog/error.h"
#include "vog/picture_record.h"

namespace vog::cli {

namespace {

/// throws UsageError and vog::Error before any work
void check_arguments(const RenderArguments& arguments, bool writes) {
    if (is_field_map(arguments.request.show) && arguments.request.field.empty())
        throw UsageError(fmt::format("--show {} needs --field NAME ({} lists the names)",
                                     word_of(arguments.request.show),
                                     command_line("info", arguments.drawing.inputs)));
    // Folders and names with a number are checked where they are made.
    const auto is_file = [&](const std::string& output) {
        return writes && !output.empty() && !arguments.turntable;
    };
    if (is_file(arguments.values_output))
        check_output(arguments.values_output, arguments.drawing.inputs, {".npy", ".exr"});
    if (is_file(arguments.output) && !arguments.take_picture)
        check_output(arguments.output, arguments.drawing.inputs, {".png", ".exr"});
    if (is_file(arguments.depth_output))
        check_output(arguments.depth_output, arguments.drawing.inputs, {".exr"});
}

/// Share of the values above a limit.
double share_above(std::span<const float> values, double limit) {
    const auto above =
        std::ranges::count_if(values, [&](float value) { return double{value} > limit; });
    return static_cast<double>(above) / static_cast<double>(values.size());
}

/// Number of pixels that show anything.
std::size_t covered_by(const Picture& picture) {
    const Show show = picture.made.request.show;
    const std::span<const float> values =
        is_field_map(show) ? picture.sums.column : picture.values();
    return static_cast<std::size_t>(std::ranges::count_if(values, [&](float value) {
        return show == Show::maximum || show == Show::slice ? !std::isnan(value) : value > 0;
    }));
}

/// Whether a plane almost holds the eye, or the direction of parallel rays: few rays meet it.
bool is_edge_on(const SlicePlane& plane, const Camera& camera) {
    const Vec3d normal = normalized(plane.normal), away = camera.look_at - camera.eye;
    const double above = dot(normal, camera.eye) - *plane.offset / length(plane.normal);
    const double slope = camera.orthographic() ? dot(normal, away) : above;
    return std::abs(slope) < 0.05 * length(away);
}
/// Whether the plane of a slice, or of a layer, is seen like that.
bool has_edge_on(const PictureRequest& request) {
    const auto edge_on = [&](const std::optional<SlicePlane>& plane) {
        return plane && is_edge_on(*plane, *request.camera);
    };
    return (request.show == Show::slice && edge_on(request.plane)) ||
           std::ranges::any_of(request.layers, edge_on, &Layer::plane);
}

/// Figures of the numbers of a picture.
void set_figures(const Picture& picture, RenderedPicture& figures) {
    const Show show = picture.made.request.show;
    const std::span<const float> values = picture.values();
    const auto pixels = static_cast<double>(values.size());
    const auto covered = static_cast<double>(covered_by(picture));
    double sum = 0, most = -HUGE_VAL;
    std::size_t count = 0;
    for (const float value : values) {
        if (std::isnan(value)) continue;
        ++count;
        sum += double{value};
        most = std::max(most, double{value});
    }
    figures.mean_t = count ? sum / static_cast<double>(count) : 0;
    figures.max_t = count ? most : 0;
    figures.covered = covered / pixels;
    figures.extinction = picture.extinction;
    figures.scales = scales_of(picture);
    if (show == Show::depth) return;
    figures.scale = picture.scale;
    if (show != Show::volume) {
        figures.above_range = share_above(values, picture.scale.high);
        return;
    }
    figures.unit_distance = picture.made.chosen.transfer.unit_distance;
    figures.mean_opacity = covered > 0 ? sum / covered : 0;
    figures.layered = !picture.made.layers.empty();
}

/// Figures of a picture, and notes on it.
RenderedPicture figures_of(const RenderArguments& arguments, const SceneInputs& inputs,
                           const Picture& drawn, const DrawReport& report,
                           std::vector<double> render_ms, const Stages& stages) {
    RenderedPicture picture;
    set_figures(drawn, picture);
    const ResolvedPicture& made = drawn.made;
    if (!made.chosen.transfer.gradient.empty() && made.layers.empty())
        picture.steepest_gradient = steepest_gradient(inputs.scene, made.field.field);
    picture.output = arguments.output;
    picture.depth_output = arguments.depth_output;
    picture.values_output = arguments.values_output;
    picture.quantity = drawn.made.name;
    picture.units = drawn.made.unit;
    picture.renderer = info_of(*drawn.made.request.renderer).name;
    picture.primitives_text = inputs.primitives_text;
    picture.width = drawn.sums.width;
    picture.height = drawn.sums.height;
    picture.gaussians = inputs.gaussians;
    picture.active_voxels = inputs.active_voxels;
    picture.threads = thread_count();
    std::ranges::sort(render_ms);
    picture.render_ms = std::move(render_ms);
    picture.cut = report.cut;
    picture.traced = report.traced;
    picture.gpu_ms = report.gpu_ms;
    picture.site = inputs.site;
    picture.stage_ms = stages.times();
    picture.peak_memory = peak_memory();
    picture.notes = inputs.notes;
    // A ray in a thousand: a single object fills a hundredth of a fitted view, however thin.
    const auto pixels =
        static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height);
    const auto covered = static_cast<std::size_t>(std::lround(picture.covered * double(pixels)));
    if (covered < pixels / 1000 && inputs.gaussians + inputs.active_voxels > 0) {
        picture.notes.push_back(
            fmt::format("{}: only {} of {} pixels show anything: {}",
                        arguments.drawing.inputs.front(), count_text(covered), count_text(pixels),
                        has_edge_on(made.request) ? "the plane is seen edge-on; another --view "
                                                    "shows it, and none looks along its normal"
                        : made.request.options.clip.empty()
                            ? "the data are smaller than a pixel or outside the view; --look-at, "
                              "--distance and --orthographic --width change it"
                            : "--clip cuts away what the view shows; another one keeps more"));
        print_notes({picture.notes.back()});
    }
    return picture;
}

/// Draws once, or as --repeat states.
/// returns  times, ms: at least one
std::vector<double> timed(const RenderArguments& arguments, const std::function<void()>& draw) {
    // With --repeat N: one warm-up that is not timed, then N timed renders.
    std::vector<double> render_ms;
    for (int n = arguments.repeat ? -1 : 0; n < std::max(arguments.repeat, 1); ++n) {
        const Clock::time_point start = Clock::now();
        draw();
        if (n >= 0) render_ms.push_back(milliseconds_since(start));
    }
    return render_ms;
}

/// How a picture was made, as its files keep it.
std::string record_of(const RenderArguments& arguments, const Picture& picture) {
    return record_json(
        {picture.made.request,
         picture.made.layers.empty() ? arguments.drawing.inputs : arguments.drawing.layer_inputs,
         arguments.reading, version_number()});
}

/// Writes the files of one picture.
void save(const RenderArguments& arguments, const Picture& picture, const std::string& record,
          Stages& stages) {
    for (const std::string& file :
         {arguments.output, arguments.depth_output, arguments.values_output})
        if (std::error_code code; !arguments.request_file.empty() && !file.empty() &&
                                  std::filesystem::equivalent(file, arguments.request_file, code))
            throw Error(file + " is the picture of --request; choose another output");
    if (!arguments.output.empty())
        stages.run("save", [&] { save_picture(arguments, picture.image, record); });
    if (!arguments.depth_output.empty()) write_exr(arguments.depth_output, picture.depth(), record);
    if (!arguments.values_output.empty()) write_numbers(arguments.values_output, picture, record);
}

}  // namespace

double RenderedPicture::median_ms() const {
    const std::size_t middle = render_ms.size() / 2;
    return render_ms.size() % 2 ? render_ms[middle]
                                : 0.5 * (render_ms[middle - 1] + render_ms[middle]);
}

nlohmann::ordered_json to_json(const RenderedPicture& picture) {
    const auto record = nlohmann::ordered_json::parse(picture.record);
    nlohmann::ordered_json json = {{"output", picture.output},
                                   {"depth_output", picture.depth_output},
                                   {"renderer", picture.renderer},
                                   {"width", picture.width},
                                   {"height", picture.height},
                                   {"camera", record["picture"]["camera"]},
                                   {"gaussians", picture.gaussians},
                                   {"active_voxels", picture.active_voxels},
                                   {"threads", picture.threads},
                                   {"covered", picture.covered},
                                   {"quantity", picture.quantity},
                                   {"mean_t", picture.mean_t},
                                   {"max_t", picture.max_t},
                                   {"render_ms",
                                    {{"min", picture.render_ms.front()},
                                     {"median", picture.median_ms()},
                                     {"max", picture.render_ms.back()},
                                     {"repeats", picture.render_ms.size()}}}};
    if (picture.has_extinction()) json["extinction"] = picture.extinction;
    if (!picture.values_output.empty()) json["values_output"] = picture.values_output;
    if (picture.layered) {
        json["mean_opacity"] = picture.mean_opacity;
    } else if (picture.scale) {
        json["units"] = picture.units;
        json["range"] = {picture.scale->low, picture.scale->high};
        json["log"] = picture.scale->kind == ColorScale::Kind::log;
        if (!picture.unit_distance) json["above_range"] = picture.above_range;
    }
    if (picture.unit_distance && !picture.layered) {
        json["unit_distance"] = *picture.unit_distance;
        json["mean_opacity"] = picture.mean_opacity;
    }
    if (picture.steepest_gradient) json["steepest_gradient"] = *picture.steepest_gradient;
    if (picture.cut)
        json["cut"] = {{"drawn", picture.cut->drawn()},
                       {"gaussians", picture.cut->leaves},
                       {"nodes", picture.cut->nodes},
                       {"nodes_visited", picture.cut->visited}};
    if (picture.site)
        json["site"] = {{"chunks", picture.site->chunks}, {"bytes_read", picture.site->bytes_read}};
    if (picture.traced) {
        json["hits"] = picture.traced->hits;
        json["slabs"] = picture.traced->slabs;
        json["most_slabs"] = picture.traced->most_slabs;
    }
    if (picture.gpu_ms) json["gpu_ms"] = *picture.gpu_ms;
    for (const auto& [name, ms] : picture.stage_ms) json["ms"][name] = ms;
    json["peak_memory"] = picture.peak_memory;
    if (!picture.notes.empty()) json["notes"] = picture.notes;
    json["request"] = record;
    return json;
}

void print(const RenderedPicture& picture, bool repeated) {
    if (!picture.output.empty())
        print_line(fmt::format(
            "{}: {}x{}, {}, {:.1f} ms, {}{:.1f} % covered", picture.output, picture.width,
            picture.height, picture.primitives_text, picture.median_ms(),
            picture.has_extinction() ? fmt::format("extinction {:.6g}, ", picture.extinction) : "",
            100 * picture.covered));
    if (picture.layered && !picture.output.empty())
        print_line(fmt::format("{}: mean opacity {:.3f} where covered", picture.quantity,
                               picture.mean_opacity));
    else if (picture.unit_distance && !picture.output.empty())
        print_line(fmt::format(
            "{}{}: values from {:.6g} to {:.6g}, unit distance {:.6g}, mean opacity {:.3f} where "
            "covered",
            picture.quantity, picture.units.empty() ? "" : " [" + picture.units + "]",
            picture.scale->low, picture.scale->high, *picture.unit_distance, picture.mean_opacity));
    else if (picture.scale && !picture.output.empty())
        print_line(
            fmt::format("{}{}: colours from {:.6g} to {:.6g}{}, {:.1f} % of the pixels above",
                        picture.quantity, picture.units.empty() ? "" : " [" + picture.units + "]",
                        picture.scale->low, picture.scale->high,
                        picture.scale->kind == ColorScale::Kind::log ? ", logarithmic" : "",
                        100 * picture.above_range));
    if (!picture.values_output.empty())
        print_line(fmt::format("{}: {}{}, largest {:.6g}", picture.values_output, picture.quantity,
                               picture.units.empty() ? "" : " [" + picture.units + "]",
                               picture.max_t));
    if (picture.cut)
        print_line(fmt::format("cut: {} Gaussians and {} nodes drawn, {} nodes visited",
                               count_text(picture.cut->leaves), count_text(picture.cut->nodes),
                               count_text(picture.cut->visited)));
    if (picture.site)
        print_line(fmt::format("site: {} in {} chunks read", bytes_text(picture.site->bytes_read),
                               count_text(picture.site->chunks)));
    if (!picture.depth_output.empty())
        print_line(fmt::format("{}: T, mean {:.6g}, largest {:.6g}", picture.depth_output,
                               picture.mean_t, picture.max_t));
    if (repeated)
        print_line(fmt::format("render: min {:.2f} ms, median {:.2f} ms, max {:.2f} ms over {}",
                               picture.render_ms.front(), picture.median_ms(),
                               picture.render_ms.back(), picture.render_ms.size()));
}

namespace {

/// The view of a single picture, for which sites are read as fine as its pixels; empty: they are read whole.
ViewOfSites view_of_sites(const RenderArguments& arguments, const GivenOptions& command,
                          const RenderRanks& ranks) {
    const PictureRequest& request = arguments.request;
    if (arguments.turntable || ranks.divided() || request.show == Show::slice) return {};
    return [&](const Subject& subject) -> SiteView {
        const Camera camera = first_camera(arguments, command, subject);
        // Nodes have means of values, below the largest ones.
        const double pixel_error = request.show == Show::maximum ? 0 : 1;
        return {frame_of(camera, request.width, request.height),
                request.options.pixel_error.value_or(pixel_error)};
    };
}

/// Makes the view of a slice the stored one, which --up, --set roll and --width change.
/// throws  UsageError for options that it has no use for
void place_slice(const ResolvedPicture& picture, const GivenOptions& command, ViewArguments& view) {
    const bool of_request = view.stored.has_value();
    if (!of_request) view.stored = picture.camera();
    const Camera& camera = *view.stored;
    const Vec3d forward = normalized(camera.look_at - camera.eye),
                normal = normalized(picture.request.plane->normal);
    view.along_plane = camera.orthographic() && length(cross(forward, normal)) < 1e-6;
    if (!view.along_plane || !keeps_stored(view, command)) return;
    if (view.orthographic && !of_request)
        throw UsageError(
            "--orthographic has no effect with --show slice, which is always orthographic");
    if (command.has("--frame"))
        throw UsageError(
            "--frame has no effect with --show slice, which frames the section of the data");
}

}  // namespace

std::vector<RenderedPicture> render(const RenderArguments& given, const GivenOptions& command,
                                    const RenderRanks& ranks) {
    PictureRequest request = given.request;
    check_arguments(given, ranks.is_root);
    RenderArguments arguments = given;
    const bool layered = !request.layers.empty();
    if (!layered)
        request.renderer =
            renderer_of(request, arguments.drawing,
                        common_kind(arguments.drawing.inputs, arguments.drawing.volume.grid));
    if (arguments.shared) share(*arguments.shared, request);
    const ThreadLimit limit(arguments.threads);
    Stages stages(arguments.verbose && ranks.is_root);
    const ViewOfSites view = view_of_sites(given, command, ranks);
    SceneInputs inputs = stages.run("load", [&] {
        return layered ? load_layers(arguments.drawing, request, ranks, view)
                       : load_scene(arguments.drawing, request, ranks, view);
    });
    // Without a field a slice shows densities; values below 0 are a field.
    if (!inputs.field.empty() && (!request.field.empty() || request.show == Show::slice))
        request.field = inputs.field;
    if (arguments.subject) inputs.scene.subject = *arguments.subject;
    PictureRenderer renderer(inputs.scene);
    // Light from the upper left is that of the first view.
    if (request.look.is_lit() && !request.camera)
        request.camera = first_camera(arguments, command, inputs.scene.subject);
    ResolvedPicture picture = resolve(request, inputs.scene);
    if (request.show == Show::slice) place_slice(picture, command, arguments.view);
    if (picture.unit_is_label && ranks.is_root)
        print_notes({fmt::format("{}: states no unit of {}; --units {} is only a label",
                                 arguments.drawing.inputs.front(), picture.name, request.unit)});
    if (request.show == Show::volume && ranks.is_root) {
        const std::vector<std::string> notes =
            layered ? layer_notes(picture) : transfer_notes(request, picture);
        print_notes(notes);
        inputs.notes.insert(inputs.notes.end(), notes.begin(), notes.end());
    }
    stages.run("prepare", [&] { renderer.prepare(picture); });
    Sums sums;
    const auto draw = [&](const RenderArguments& one,
                          const Camera& camera) -> std::optional<RenderedPicture> {
        picture.request.camera = camera;
        if (one.shared) share(*one.shared, picture.request);
        const Progress progress = one.repeat ? Progress{} : stages.progress();
        std::vector<double> render_ms = stages.run(
            "render", [&] { return timed(one, [&] { renderer.draw(picture, sums, progress); }); });
        if (!ranks.is_root) return std::nullopt;
        Picture finished =
            stages.run("shade", [&] { return finish(std::move(sums), picture, inputs.scene); });
        const std::string record = record_of(one, finished);
        save(one, finished, record, stages);
        RenderedPicture figures =
            figures_of(one, inputs, finished, ranks.divided() ? DrawReport{} : renderer.report(),
                       std::move(render_ms), stages);
        figures.record = record;
        sums = std::move(finished.sums);
        return figures;
    };
    return render_views(arguments, command, inputs.scene.subject, draw);
}

}  // namespace vog::cli
