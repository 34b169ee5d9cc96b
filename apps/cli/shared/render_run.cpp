// render_run.cpp: from inputs to a picture, and what is told of it.
#include "shared/render_run.h"

#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "shared/terminal.h"

namespace vog::cli {

namespace {

/// Minimum, median and maximum of render times.
struct Times {
    double min = 0, median = 0, max = 0;
};
Times summary(std::vector<double> ms) {
    std::sort(ms.begin(), ms.end());
    const std::size_t middle = ms.size() / 2;
    const double median = ms.size() % 2 ? ms[middle] : 0.5 * (ms[middle - 1] + ms[middle]);
    return {ms.front(), median, ms.back()};
}

void check_arguments(const RenderArguments& arguments, bool writes) {
    if (arguments.output.empty() && arguments.depth_output.empty() && !arguments.repeat)
        throw CLI::ValidationError("nothing to make: give -o, --depth-out or --repeat");
    if (writes && !arguments.output.empty())
        check_output(arguments.output, arguments.drawing.inputs, {".png", ".exr"});
    if (writes && !arguments.depth_output.empty())
        check_output(arguments.depth_output, arguments.drawing.inputs, {".exr"});
    if (arguments.drawing.stop_transmittance > 0 && !asked_extinction(arguments.color))
        throw CLI::ValidationError(
            "--stop-transmittance needs --extinction with a number: auto is known only after");
}

nlohmann::ordered_json report(const RenderArguments& arguments, const Drawing& drawing,
                              const DepthImage& depth, const std::vector<double>& render_ms,
                              const Stages& stages) {
    std::size_t covered = 0;
    double sum = 0, largest = 0;
    for (const float t : depth.depth) {
        covered += t > 0;
        sum += t;
        largest = std::max(largest, double{t});
    }
    const auto pixels = static_cast<double>(depth.depth.size());
    const Times times = summary(render_ms);
    const std::optional<CutReport> cut = drawing.cut();
    const std::optional<TraceReport> traced = drawing.traced();
    if (!arguments.json) {
        if (!arguments.output.empty())
            fmt::print("{}: {}x{}, {}, {:.1f} ms, extinction {:.6g}, {:.1f} % covered\n",
                       arguments.output, depth.width, depth.height, drawing.primitives_text,
                       times.median, depth.extinction, 100 * static_cast<double>(covered) / pixels);
        if (cut)
            fmt::print("cut: {} Gaussians and {} nodes drawn, {} nodes visited\n",
                       count_text(cut->leaves), count_text(cut->nodes), count_text(cut->visited));
        if (!arguments.depth_output.empty())
            fmt::print("{}: T, mean {:.6g}, largest {:.6g}\n", arguments.depth_output, sum / pixels,
                       largest);
        if (arguments.repeat)
            fmt::print("render: min {:.2f} ms, median {:.2f} ms, max {:.2f} ms over {}\n",
                       times.min, times.median, times.max, render_ms.size());
        return {};
    }
    nlohmann::ordered_json json = {{"output", arguments.output},
                                   {"depth_output", arguments.depth_output},
                                   {"renderer", info_of(drawing.renderer).name},
                                   {"width", depth.width},
                                   {"height", depth.height},
                                   {"gaussians", drawing.gaussians},
                                   {"active_voxels", drawing.active_voxels},
                                   {"threads", thread_count()},
                                   {"extinction", depth.extinction},
                                   {"covered", static_cast<double>(covered) / pixels},
                                   {"mean_t", sum / pixels},
                                   {"max_t", largest},
                                   {"render_ms",
                                    {{"min", times.min},
                                     {"median", times.median},
                                     {"max", times.max},
                                     {"repeats", render_ms.size()}}}};
    if (cut)
        json["cut"] = {{"drawn", cut->drawn()},
                       {"gaussians", cut->leaves},
                       {"nodes", cut->nodes},
                       {"nodes_visited", cut->visited}};
    if (traced) {
        json["hits"] = traced->hits;
        json["slabs"] = traced->slabs;
        json["most_slabs"] = traced->most_slabs;
    }
    for (const auto& [name, ms] : stages.times()) json["ms"][name] = ms;
    json["peak_memory"] = peak_memory();
    return json;
}

}  // namespace

void add_render_options(CLI::App& command, RenderArguments& arguments) {
    command.add_option(
        "-o,--output", arguments.output,
        "Picture to write, .png or float .exr. A folder (or a name that ends in /): one of each "
        "input, under one camera and one extinction");
    command.add_option("--depth-out", arguments.depth_output,
                       "Optical depth T to write: .exr, one float channel Y");
    command.add_option("--size", arguments.size, "WxH or one number, pixels")
        ->capture_default_str();
    add_drawing_options(command, arguments.drawing);
    add_view_options(command, arguments.view);
    add_color_options(command, arguments.color);
    add_memory_options(command, arguments.memory, "");
    command.add_option("--threads", arguments.threads, "Threads to use; 0: all cores")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    command
        .add_option("--repeat", arguments.repeat,
                    "Render N times after a warm-up and report min, median and max")
        ->check(CLI::Range(1, 100000));
    command.add_flag("--json", arguments.json, "Print one JSON object and nothing else");
    command.add_flag("--verbose,-v", arguments.verbose, "Print the time of each stage");
}

nlohmann::ordered_json render(const RenderArguments& arguments, const CLI::App& command,
                              const RenderTogether& others) {
    const bool writes = others.writes;
    check_arguments(arguments, writes);
    const Size size = parse_size(arguments.size);
    const std::optional<double> extinction = asked_extinction(arguments.color);
    const TransferFunction tf = load_transfer_function(arguments.color.tf);
    const ShadeOptions shading = shading_of(arguments.color);
    const ThreadLimit limit(arguments.threads);
    Stages stages(arguments.verbose && writes);

    const Drawing drawing =
        stages.run("load", [&] { return others.load(arguments.drawing, extinction, command); });
    const Camera camera = camera_from(arguments.view, command, arguments.box.value_or(drawing.box));
    if (writes && !arguments.view.save_camera.empty())
        write_camera(arguments.view.save_camera, camera);

    // With --repeat: one warm-up that does not count, then as many timed renders as asked.
    const Progress progress = arguments.repeat ? Progress{} : stages.progress();
    DepthImage depth;
    std::vector<double> render_ms;
    stages.run("render", [&] {
        for (int n = arguments.repeat ? -1 : 0; n < std::max(arguments.repeat, 1); ++n) {
            const Clock::time_point start = Clock::now();
            drawing.draw(camera, size, progress, depth);
            if (n >= 0) render_ms.push_back(milliseconds_since(start));
        }
    });
    if (!writes) return {};
    set_extinction(depth, extinction ? *extinction : auto_extinction(depth));

    if (!arguments.output.empty()) {
        const Image image = stages.run("shade", [&] { return shade(depth, tf, shading); });
        stages.run("save", [&] { write_image(arguments.output, image); });
    }
    if (!arguments.depth_output.empty()) write_exr(arguments.depth_output, depth);
    return report(arguments, drawing, depth, render_ms, stages);
}

}  // namespace vog::cli
