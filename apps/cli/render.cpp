// render.cpp: vog render: load -> render -> shade -> image.
#include "vog/render.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "inputs.h"
#include "terminal.h"
#include "view.h"
#include "vog/error.h"
#include "vog/gpu.h"
#include "vog/reference.h"
#include "vog/shade.h"
#include "vog/trace.h"

namespace vog::cli {

namespace {

struct RenderArguments {
    std::vector<std::string> inputs;
    std::string output, depth_output, size = "512x512", renderer, extinction = "auto";
    std::string interpolation = "constant", tf = "inferno", background = "black";
    std::string anyhit = "accumulate";
    VolumeInputOptions volume;
    PointInputOptions points;
    ViewArguments view;
    bool blend = false, json = false, verbose = false;
    int threads = 0, repeat = 0;
    double aabb_sigma = 0, kappa = 0, stop_transmittance = 0;
    int hits_per_slab = TraceOptions{}.hits_per_slab;
    double step_voxels = VoxelGridOptions{}.step_voxels;
};

/// What is drawn, ready to draw from any camera: models by splatting or rays, volumes by the
/// reference.
struct Drawing {
    std::string renderer;
    std::string primitives_text;  ///< "20,000 Gaussians"
    std::uint64_t gaussians = 0, active_voxels = 0;
    Box box;  ///< what views look at
    std::function<void(const Camera&, Size, const Progress&, DepthImage&)> draw;
    std::shared_ptr<TraceReport> traced;  ///< of the last draw, where rays were traced
};

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

void check_arguments(const RenderArguments& arguments) {
    if (arguments.output.empty() && arguments.depth_output.empty() && !arguments.repeat)
        throw CLI::ValidationError("nothing to make: give -o, --depth-out or --repeat");
    if (!arguments.output.empty())
        check_output(arguments.output, arguments.inputs, {".png", ".exr"});
    if (!arguments.depth_output.empty())
        check_output(arguments.depth_output, arguments.inputs, {".exr"});
    if (arguments.stop_transmittance > 0 && arguments.extinction == "auto")
        throw CLI::ValidationError(
            "--stop-transmittance needs --extinction with a number: auto is known only after");
}

/// Options of one renderer, given with another, would be ignored in silence.
void check_renderer_options(const std::string& renderer, const CLI::App& command) {
    const auto only_for = [&](std::initializer_list<const char*> options,
                              std::initializer_list<std::string> renderers) {
        if (std::find(renderers.begin(), renderers.end(), renderer) != renderers.end()) return;
        for (const char* option : options)
            if (command.count(option) > 0)
                throw CLI::ValidationError(fmt::format("{} is not for --renderer {}, expected {}",
                                                       option, renderer,
                                                       fmt::join(renderers, " or ")));
    };
    only_for({"--anyhit", "--slab-hits", "--stop-transmittance"}, {"trace", "optix"});
    only_for({"--aabb-sigma"}, {"splat", "trace", "optix"});
    only_for({"--kappa"}, {"splat", "trace", "optix", "cuda"});
}

TraceOptions trace_options(const RenderArguments& arguments) {
    TraceOptions options;
    options.anyhit = arguments.anyhit == "collect" ? AnyHit::collect : AnyHit::accumulate;
    options.hits_per_slab = arguments.hits_per_slab;
    options.stop_transmittance = arguments.stop_transmittance;
    if (arguments.extinction != "auto") options.extinction = parse_extinction(arguments.extinction);
    return options;
}

void load_trace(const RenderArguments& arguments, const Gaussians& model, Drawing& drawing) {
    drawing.traced = std::make_shared<TraceReport>();
    drawing.draw = [scene = trace_scene(model, {arguments.aabb_sigma, arguments.kappa}),
                    options = trace_options(arguments),
                    report = drawing.traced](const Camera& camera, Size size,
                                             const Progress& progress, DepthImage& depth) {
        TraceOptions now = options;
        now.progress = progress;
        depth = render_trace(scene, camera, size.width, size.height, now, report.get());
    };
}

void load_optix(const RenderArguments& arguments, const Gaussians& model, Drawing& drawing) {
    drawing.traced = std::make_shared<TraceReport>();
    auto scene = std::make_shared<OptixModel>(
        model, TraceSceneOptions{arguments.aabb_sigma, arguments.kappa});
    drawing.draw = [scene, options = trace_options(arguments), report = drawing.traced](
                       const Camera& camera, Size size, const Progress&, DepthImage& depth) {
        depth = scene->render(camera, size.width, size.height, options, report.get());
    };
}

void load_cuda(const RenderArguments& arguments, const Gaussians& model, Drawing& drawing) {
    auto splat = std::make_shared<CudaSplat>(model, arguments.kappa);
    drawing.draw = [splat](const Camera& camera, Size size, const Progress&, DepthImage& depth) {
        depth = splat->render(camera, size.width, size.height);
    };
}

Drawing load_drawing(const RenderArguments& arguments, FileKind kind) {
    Drawing drawing;
    drawing.renderer = !arguments.renderer.empty() ? arguments.renderer
                       : kind == FileKind::volume  ? "reference"
                                                   : "splat";
    if (drawing.renderer == "reference") {
        if (kind != FileKind::volume)
            throw Error(fmt::format("{}: holds {}; the reference renders volumes",
                                    arguments.inputs.front(),
                                    kind == FileKind::model ? "a model" : "particles"));
        const VoxelGridOptions options{
            arguments.interpolation == "linear" ? Interpolation::linear : Interpolation::constant,
            arguments.step_voxels};
        const Levels levels = load_levels(arguments.inputs, arguments.volume);
        for (const Volume& volume : levels.volumes) {
            drawing.box.include(world_box(volume));
            drawing.active_voxels += active_voxels(volume);
        }
        drawing.primitives_text = grouped(drawing.active_voxels) + " voxels";
        if (are_levels(levels, arguments.volume)) {
            drawing.primitives_text += fmt::format(" in {} levels", levels.volumes.size());
            drawing.draw = [grids = level_grids(levels, options)](const Camera& camera, Size size,
                                                                  const Progress& progress,
                                                                  DepthImage& depth) {
                depth = render_reference(grids, camera, size.width, size.height, {progress});
            };
            return drawing;
        }
        std::vector<VoxelGrid> grids;
        for (const Volume& volume : levels.volumes) grids.push_back(voxel_grid(volume, options));
        drawing.draw = [grids = std::move(grids)](const Camera& camera, Size size,
                                                  const Progress& progress, DepthImage& depth) {
            depth = render_reference(grids, camera, size.width, size.height, {progress});
        };
        return drawing;
    }
    if (kind == FileKind::volume)
        throw Error(fmt::format("{}: is a volume; convert it first: vog convert {} -o model.ply",
                                arguments.inputs.front(), arguments.inputs.front()));
    // Particles need no file between: one Gaussian each.
    auto model = std::make_shared<Gaussians>(
        kind == FileKind::points
            ? convert_points(load_points(arguments.inputs, arguments.points, arguments.volume.grid),
                             point_options(arguments.points))
            : load_models(arguments.inputs));
    drawing.box = view_box(*model);
    drawing.gaussians = model->size();
    drawing.primitives_text = grouped(model->size()) + " Gaussians";
    if (drawing.renderer != "splat") {
        const auto load = drawing.renderer == "trace"   ? load_trace
                          : drawing.renderer == "optix" ? load_optix
                                                        : load_cuda;
        load(arguments, *model, drawing);
        return drawing;
    }
    model->cutoff = static_cast<float>(cutoff_of_kappa(arguments.kappa, model->cutoff));
    SplatOptions options;
    options.aabb_sigma = arguments.aabb_sigma;
    auto renderer = std::make_shared<SplatRenderer>(*model, options);
    drawing.draw = [model, renderer](const Camera& camera, Size size, const Progress& progress,
                                     DepthImage& depth) {
        renderer->render(camera, size.width, size.height, depth, progress);
    };
    return drawing;
}

void report(const RenderArguments& arguments, const Drawing& drawing, const DepthImage& depth,
            const std::vector<double>& render_ms, const Stages& stages) {
    std::size_t covered = 0;
    double sum = 0, largest = 0;
    for (const float t : depth.depth) {
        covered += t > 0;
        sum += t;
        largest = std::max(largest, double{t});
    }
    const auto pixels = static_cast<double>(depth.depth.size());
    const Times times = summary(render_ms);
    if (!arguments.json) {
        if (!arguments.output.empty())
            fmt::print("{}: {}x{}, {}, {:.1f} ms, extinction {:.6g}, {:.1f} % covered\n",
                       arguments.output, depth.width, depth.height, drawing.primitives_text,
                       times.median, depth.extinction, 100 * static_cast<double>(covered) / pixels);
        if (!arguments.depth_output.empty())
            fmt::print("{}: T, mean {:.6g}, largest {:.6g}\n", arguments.depth_output, sum / pixels,
                       largest);
        if (arguments.repeat)
            fmt::print("render: min {:.2f} ms, median {:.2f} ms, max {:.2f} ms over {}\n",
                       times.min, times.median, times.max, render_ms.size());
        return;
    }
    nlohmann::ordered_json json = {{"output", arguments.output},
                                   {"depth_output", arguments.depth_output},
                                   {"renderer", drawing.renderer},
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
    if (drawing.traced) {
        json["hits"] = drawing.traced->hits;
        json["slabs"] = drawing.traced->slabs;
        json["most_slabs"] = drawing.traced->most_slabs;
    }
    for (const auto& [name, ms] : stages.times()) json["ms"][name] = ms;
    fmt::print("{}\n", json.dump(2));
}

void render(const RenderArguments& arguments, const CLI::App& command) {
    check_arguments(arguments);
    const FileKind kind = common_kind(arguments.inputs, arguments.volume.grid);
    if (kind != FileKind::points) refuse_group(command, kPointGroup, "models and volumes");
    const Size size = parse_size(arguments.size);
    const bool automatic = arguments.extinction == "auto";
    const double asked_extinction = automatic ? 1 : parse_extinction(arguments.extinction);
    const TransferFunction tf = load_transfer_function(arguments.tf);
    const ShadeOptions shading{parse_background(arguments.background), arguments.blend};
    const ThreadLimit limit(arguments.threads);
    Stages stages(arguments.verbose);

    const Drawing drawing = stages.run("load", [&] { return load_drawing(arguments, kind); });
    check_renderer_options(drawing.renderer, command);
    const Camera camera = camera_from(arguments.view, command, drawing.box);
    if (!arguments.view.save_camera.empty()) write_camera(arguments.view.save_camera, camera);

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
    set_extinction(depth, automatic ? auto_extinction(depth) : asked_extinction);

    if (!arguments.output.empty()) {
        const Image image = stages.run("shade", [&] { return shade(depth, tf, shading); });
        stages.run("save", [&] {
            if (arguments.output.ends_with(".exr"))
                write_exr(arguments.output, image);
            else
                write_png(arguments.output, image);
        });
    }
    if (!arguments.depth_output.empty()) write_exr(arguments.depth_output, depth);
    report(arguments, drawing, depth, render_ms, stages);
}

void add_trace_options(CLI::App& command, RenderArguments& arguments) {
    const auto group = "Ray tracing";
    command
        .add_option(
            "--anyhit", arguments.anyhit,
            "What trace and optix do with a hit: accumulate adds it at once; collect, as the "
            "paper, gathers, sorts by entry and integrates front to back")
        ->check(CLI::IsMember({"accumulate", "collect"}))
        ->capture_default_str()
        ->group(group);
    command
        .add_option("--slab-hits", arguments.hits_per_slab,
                    "Hits that collect holds at once; rays with more go on, slab by slab")
        ->check(CLI::Range(1, 256))
        ->capture_default_str()
        ->group(group);
    command
        .add_option("--stop-transmittance", arguments.stop_transmittance,
                    "End a ray of collect once its transmittance is below this; 0: never")
        ->check(CLI::Range(0.0, 0.999999))
        ->capture_default_str()
        ->group(group);
    command
        .add_option("--kappa", arguments.kappa,
                    "Cut kernels where they have fallen to this share of their peak, in place of "
                    "the model's own cutoff: k = sqrt(-2 ln kappa)")
        ->check(CLI::Range(1.3e-14, 0.999));
}

}  // namespace

void add_render(CLI::App& app) {
    auto arguments = std::make_shared<RenderArguments>();
    CLI::App* command =
        app.add_subcommand("render", "Render models, volumes or particles to a picture");
    command
        ->add_option("inputs", arguments->inputs,
                     "PLY models, OpenVDB or NanoVDB volumes, or particles (.xyz, .csv, .tsv, "
                     ".vdb); several "
                     "become one picture")
        ->required();
    command->add_option("-o,--output", arguments->output, "Picture to write, .png or float .exr");
    command->add_option("--depth-out", arguments->depth_output,
                        "Optical depth T to write: .exr, one float channel Y");
    command->add_option("--size", arguments->size, "WxH or one number, pixels")
        ->capture_default_str();
    command
        ->add_option("--renderer", arguments->renderer,
                     "splat: models and particles, exact, object order; trace: the same, ray by "
                     "ray; cuda, optix: splat and trace on an NVIDIA GPU; reference: volumes, "
                     "exact through the voxels. Default: splat or "
                     "reference")
        ->check(CLI::IsMember({"splat", "trace", "cuda", "optix", "reference"}));
    add_trace_options(*command, *arguments);
    command
        ->add_option("--interpolation", arguments->interpolation,
                     "Voxels of the reference: constant (exact), or linear between their centres")
        ->check(CLI::IsMember({"constant", "linear"}))
        ->capture_default_str();
    command
        ->add_option("--step", arguments->step_voxels,
                     "Step of linear interpolation, voxels; 0: exact, cell by cell")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    add_volume_options(*command, arguments->volume);
    command
        ->add_option("--aabb-sigma", arguments->aabb_sigma,
                     "The paper's bounding boxes: a ray counts a Gaussian only if it meets the box "
                     "of this many times the paper's radii; 0: no boxes")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    add_point_options(*command, arguments->points);
    add_view_options(*command, arguments->view);
    const auto group = "Colour";
    command
        ->add_option("--extinction", arguments->extinction,
                     "Factor on density, or auto: the 99th percentile of the non-zero T becomes 4")
        ->capture_default_str()
        ->group(group);
    std::string names;
    for (const std::string& name : transfer_function_names())
        names += (names.empty() ? "" : ", ") + name;
    command
        ->add_option(
            "--tf", arguments->tf,
            "Transfer function on V = 1 - exp(-T): a JSON file (vog's or ParaView's) or one of " +
                names)
        ->capture_default_str()
        ->group(group);
    command
        ->add_option("--background", arguments->background,
                     "R,G,B in [0, 1], black, white or transparent")
        ->capture_default_str()
        ->group(group);
    command
        ->add_flag("--blend", arguments->blend,
                   "The paper's blend: colours fade into the background as V goes to 0")
        ->group(group);
    command->add_option("--threads", arguments->threads, "Threads to use; 0: all cores")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    command
        ->add_option("--repeat", arguments->repeat,
                     "Render N times after a warm-up and report min, median and max")
        ->check(CLI::Range(1, 100000));
    command->add_flag("--json", arguments->json, "Print one JSON object and nothing else");
    command->add_flag("--verbose,-v", arguments->verbose, "Print the time of each stage");
    command->callback([arguments, command] { render(*arguments, *command); });
}

}  // namespace vog::cli
