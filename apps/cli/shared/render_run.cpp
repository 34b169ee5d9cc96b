// render_run.cpp: one picture from inputs to file, and its report.
#include "shared/render_run.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "films/views.h"
#include "shared/outputs.h"
#include "shared/terminal.h"
#include "shared/validators.h"
#include "vog/error.h"
#include "vog/picture.h"

namespace vog::cli {

namespace {

/// throws CLI::ValidationError and vog::Error before any work
void check_arguments(const RenderArguments& arguments, bool writes) {
    const QuantityArguments& quantity = arguments.quantity;
    check_quantity_options(quantity);
    check_value_options(arguments.value);
    // Folders and names with a number are checked where they are made.
    const auto is_file = [&](const std::string& output) {
        return writes && !output.empty() && !arguments.turntable;
    };
    if (is_file(quantity.values_output))
        check_output(quantity.values_output, arguments.drawing.inputs, {".npy", ".exr"});
    if (is_file(arguments.output) && !arguments.take_picture)
        check_output(arguments.output, arguments.drawing.inputs, {".png", ".exr"});
    if (is_file(arguments.depth_output))
        check_output(arguments.depth_output, arguments.drawing.inputs, {".exr"});
    if (arguments.drawing.stop_transmittance > 0 && !fixed_extinction(arguments.color))
        throw CLI::ValidationError(
            "--stop-transmittance: transmittance depends on the extinction, and auto is known only "
            "after the render; expected --extinction with a number");
}

/// Name of the shown quantity: "T", "column density", of particles "mass per area".
std::string quantity_text(const RenderArguments& arguments, FileKind kind) {
    if (!arguments.quantity.column()) return "T";
    if (kind != FileKind::points) return quantity_label("column", "");
    const std::string& value = arguments.drawing.points.value;
    return (value.empty() || value == "count" ? "number" : value) + " per area";
}

/// Scale of the shown quantity.
ColorScale scale_of(const QuantityArguments& quantity, const DepthImage& depth) {
    if (!quantity.column()) return {};
    if (const auto fixed = fixed_scale(quantity)) return *fixed;
    return automatic_scale({&depth, 1}, quantity.fit());
}

/// The picture with all that is drawn over it and around it.
Image pictured(const RenderArguments& arguments, const Drawing& drawing, const Camera& camera,
               const DepthImage& depth, const TransferFunction& tf, const ColorScale& scale,
               const std::string& quantity) {
    const ShadeOptions shading = shading_of(arguments.color);
    const QuantityArguments& given = arguments.quantity;
    return annotated_picture(
        arguments, drawing, camera,
        scale.kind == ColorScale::Kind::visibility ? shade(depth, tf, shading)
                                                   : shade_values(depth, tf, scale, shading),
        tf, scale, with_unit(given.column() ? quantity : quantity_label("T", ""), given.units));
}

}  // namespace

double share_above(std::span<const float> values, double limit) {
    const auto above =
        std::ranges::count_if(values, [&](float value) { return double{value} > limit; });
    return static_cast<double>(above) / static_cast<double>(values.size());
}

RenderedPicture figures_of(const RenderArguments& arguments, const Drawing& drawing,
                           const DepthImage& depth, std::vector<double> render_ms,
                           const Stages& stages, const ColorScale& scale) {
    RenderedPicture picture;
    picture.values_output = arguments.quantity.values_output;
    picture.quantity = quantity_text(arguments, drawing.kind);
    picture.units = arguments.quantity.units;
    if (arguments.quantity.column()) {
        picture.scale = scale;
        picture.above_range = share_above(depth.depth, scale.high);
    }
    picture.output = arguments.output;
    picture.depth_output = arguments.depth_output;
    picture.renderer = info_of(drawing.renderer).name;
    picture.primitives_text = drawing.primitives_text;
    picture.width = depth.width;
    picture.height = depth.height;
    picture.gaussians = drawing.gaussians;
    picture.active_voxels = drawing.active_voxels;
    picture.threads = thread_count();
    picture.extinction = depth.extinction;
    std::size_t covered = 0;
    double sum = 0;
    for (const float t : depth.depth) {
        covered += t > 0;
        sum += t;
        picture.max_t = std::max(picture.max_t, double{t});
    }
    const auto pixels = static_cast<double>(depth.depth.size());
    picture.covered = static_cast<double>(covered) / pixels;
    picture.mean_t = sum / pixels;
    std::ranges::sort(render_ms);
    picture.render_ms = std::move(render_ms);
    picture.cut = drawing.cut();
    if (arguments.drawing.site_view) picture.site = *arguments.drawing.site_view->report;
    picture.traced = drawing.traced();
    picture.gpu_ms = drawing.gpu_ms();
    picture.stage_ms = stages.times();
    picture.peak_memory = peak_memory();
    picture.notes = drawing.notes;
    // A ray in a thousand: a single object fills a hundredth of a fitted view, however thin.
    if (covered < depth.depth.size() / 1000 && drawing.gaussians + drawing.active_voxels > 0) {
        const std::string input = arguments.drawing.inputs.front();
        picture.notes.push_back(fmt::format(
            "{}: {} of {} pixels show anything: the parts of the data are smaller than pixels, or "
            "outside the view; --look-at, --distance and --orthographic --width choose another",
            input, count_text(covered), count_text(depth.depth.size())));
        print_notes({picture.notes.back()});
    }
    return picture;
}

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

double RenderedPicture::median_ms() const {
    const std::size_t middle = render_ms.size() / 2;
    return render_ms.size() % 2 ? render_ms[middle]
                                : 0.5 * (render_ms[middle - 1] + render_ms[middle]);
}

nlohmann::ordered_json to_json(const RenderedPicture& picture) {
    const Camera& c = picture.camera;
    const auto array = [](Vec3d v) { return nlohmann::ordered_json{v.x, v.y, v.z}; };
    nlohmann::ordered_json camera = {
        {"eye", array(c.eye)}, {"look_at", array(c.look_at)}, {"up", array(c.up)}};
    if (c.orthographic())
        camera["orthographic_width"] = c.orthographic_width;
    else
        camera["fov_degrees"] = c.fov_degrees;
    nlohmann::ordered_json json = {{"output", picture.output},
                                   {"depth_output", picture.depth_output},
                                   {"renderer", picture.renderer},
                                   {"width", picture.width},
                                   {"height", picture.height},
                                   {"camera", camera},
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
    if (picture.scale) {
        json["units"] = picture.units;
        json["range"] = {picture.scale->low, picture.scale->high};
        json["log"] = picture.scale->kind == ColorScale::Kind::log;
        if (!picture.unit_distance) json["above_range"] = picture.above_range;
    }
    if (picture.unit_distance) {
        json["unit_distance"] = *picture.unit_distance;
        json["mean_opacity"] = picture.mean_opacity;
    }
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
    return json;
}

void print(const RenderedPicture& picture, bool repeated) {
    if (!picture.output.empty())
        print_line(fmt::format(
            "{}: {}x{}, {}, {:.1f} ms, {}{:.1f} % covered", picture.output, picture.width,
            picture.height, picture.primitives_text, picture.median_ms(),
            picture.has_extinction() ? fmt::format("extinction {:.6g}, ", picture.extinction) : "",
            100 * picture.covered));
    if (picture.unit_distance && !picture.output.empty())
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

void add_render_options(CLI::App& command, RenderArguments& arguments) {
    command.add_option(
        "-o,--output", arguments.output,
        "Picture to write, .png or float .exr; default: the input's name with .png in the working "
        "folder, "
        "-2, -3, ... added where that exists. A folder (or a name that ends in /), a "
        "name with a number (t_%04d.png) or a film (.mp4, .webm: by ffmpeg): one "
        "picture per input, all under one camera and one extinction");
    command
        .add_option("--turntable", arguments.turntable,
                    "Turn the view once about the up axis, in this many pictures, of all inputs "
                    "together: -o names a folder (0001.png, ...), a name with a number or a film. "
                    "Extinction and range are those of the first")
        ->check(CLI::Range(1, 9999));
    command.add_flag(
        "--steps", arguments.steps,
        "With --turntable: the inputs are steps in time, which runs once during the turn");
    command.add_option("--fps", arguments.per_second, "Pictures a second of a film")
        ->check(CLI::Range(0.01, 240.0))
        ->capture_default_str();
    command.add_option("--depth-out", arguments.depth_output,
                       "Image of optical depth T to write: .exr with one float channel Y");
    command
        .add_option("--size", arguments.size,
                    "Size of the picture in pixels, WxH or one number for a square")
        ->capture_default_str();
    add_drawing_options(command, arguments.drawing);
    add_view_options(command, arguments.view);
    add_color_options(command, arguments.color);
    add_quantity_options(command, arguments.quantity);
    add_value_options(command, arguments.value);
    add_memory_options(command, arguments.memory, "");
    command
        .add_option("--repeat", arguments.repeat,
                    "Render this many times after one warm-up, and report the minimum, median and "
                    "maximum time")
        ->check(CLI::Range(1, 100000));
    add_run_options(command, arguments.threads, arguments.json, arguments.verbose);
}

namespace {

/// throws  vog::Error with the input's name where T is not finite
void require_finite(const DepthImage& image, const std::string& input) {
    const auto found = std::ranges::find_if(image.depth, [](float t) { return !std::isfinite(t); });
    if (found == image.depth.end()) return;
    const auto pixel = found - image.depth.begin();
    throw Error(
        fmt::format("{}: optical depth {} at pixel ({}, {}), expected at most {:.2g}, the largest "
                    "32-bit float: other units of values or of length",
                    input, *found, pixel % image.width, pixel / image.width,
                    std::numeric_limits<float>::max()));
}

/// Arguments by which sites are read for the view of a single picture, as fine as its pixels.
RenderArguments of_view(RenderArguments arguments, const CLI::App& command,
                        const RenderRanks& ranks) {
    if (!all_sites(arguments.drawing.inputs) || arguments.turntable || ranks.divided())
        return arguments;
    Subject subject;
    for (const std::string& input : arguments.drawing.inputs)
        subject.include(subject_of(input, arguments.drawing.volume, arguments.drawing.points));
    const Size size = parse_size(arguments.size);
    const Camera camera = camera_from(arguments.view, command, arguments.subject.value_or(subject),
                                      static_cast<double>(size.width) / size.height);
    // Nodes have means of values, below the largest ones.
    const double pixel_error = arguments.quantity.maximum() ? 0 : 1;
    arguments.drawing.site_view = {frame_of(camera, size.width, size.height),
                                   arguments.drawing.pixel_error.value_or(pixel_error)};
    // The chunks are the cut.
    arguments.drawing.pixel_error.reset();
    return arguments;
}

}  // namespace

std::vector<RenderedPicture> render(const RenderArguments& given, const CLI::App& command,
                                    const RenderRanks& ranks) {
    check_arguments(given, ranks.is_root);
    RenderArguments arguments = of_view(given, command, ranks);
    if (arguments.quantity.of_field()) return render_field(arguments, command, ranks);
    if (arguments.quantity.volume()) return render_volume(arguments, command, ranks);
    if (arguments.quantity.maximum()) return render_maximum(arguments, command, ranks);
    const Size size = parse_size(arguments.size);
    const std::optional<double> extinction = fixed_extinction(arguments.color);
    const TransferFunction tf = load_transfer_function(arguments.color.tf);
    (void)shading_of(arguments.color);  // checks --background
    const ThreadLimit limit(arguments.threads);
    Stages stages(arguments.verbose && ranks.is_root);

    const std::string stated = arguments.quantity.column() ? column_unit(head_of(arguments)) : "";
    const double factor = units_factor(stated, arguments.quantity.units);
    if (arguments.quantity.units.empty()) arguments.quantity.units = stated;
    const Drawing drawing =
        stages.run("load", [&] { return ranks.load(arguments.drawing, extinction, command); });
    const auto draw = [&](const RenderArguments& one,
                          const Camera& camera) -> std::optional<RenderedPicture> {
        const Progress progress = one.repeat ? Progress{} : stages.progress();
        DepthImage depth;
        std::vector<double> render_ms = stages.run("render", [&] {
            return timed(one, [&] { drawing.draw(camera, size, progress, depth); });
        });
        if (!ranks.is_root) return std::nullopt;
        require_finite(depth, one.drawing.inputs.front());
        if (factor != 1)
            for (float& t : depth.depth) t = static_cast<float>(factor * double{t});
        // Column density is T at extinction 1.
        const std::optional<double> fixed = fixed_extinction(one.color);
        set_extinction(depth, one.quantity.column() ? 1 : fixed ? *fixed : auto_extinction(depth));
        const ColorScale scale = scale_of(one.quantity, depth);

        if (!one.output.empty()) {
            const std::string quantity = quantity_text(one, drawing.kind);
            const Image image = stages.run("shade", [&] {
                return pictured(one, drawing, camera, depth, tf, scale, quantity);
            });
            stages.run("save", [&] { save_picture(one, image); });
        }
        if (!one.depth_output.empty()) write_exr(one.depth_output, depth);
        if (!one.quantity.values_output.empty()) write_values(one.quantity.values_output, depth);
        if (!one.view.save_camera.empty()) write_camera(one.view.save_camera, camera);
        RenderedPicture picture =
            figures_of(one, drawing, depth, std::move(render_ms), stages, scale);
        picture.camera = camera;
        return picture;
    };
    return render_views(arguments, command, drawing.subject, size, draw);
}

}  // namespace vog::cli
