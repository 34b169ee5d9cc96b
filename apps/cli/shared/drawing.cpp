// drawing.cpp: a renderer for what was read.
#include "shared/drawing.h"

#include <fmt/ranges.h>

#include <algorithm>

#include "shared/terminal.h"
#include "vog/convert_points.h"
#include "vog/error.h"
#include "vog/gpu.h"
#include "vog/splat.h"

namespace vog::cli {

namespace {

/// Options of one renderer, given with another, would be ignored in silence.
void check_renderer_options(const std::string& renderer, FileKind kind, const CLI::App& command) {
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
    only_for({"--pixel-error"}, {"splat"});
    if (command.count("--pixel-error") && command.count("--aabb-sigma"))
        throw CLI::ValidationError("--pixel-error does not go with --aabb-sigma");
    only_for({"--kappa"}, {"splat", "trace", "optix", "cuda"});
    only_for({"--interpolation", "--step"}, {"reference"});
    if (kind != FileKind::volume) return;
    for (const char* option : {"--anyhit", "--slab-hits", "--stop-transmittance", "--aabb-sigma",
                               "--kappa", "--pixel-error"})
        if (command.count(option) > 0)
            throw CLI::ValidationError(fmt::format("{} is for Gaussians, not for voxels", option));
}

TraceOptions trace_options(const DrawingArguments& arguments, std::optional<double> extinction) {
    TraceOptions options;
    options.anyhit = arguments.anyhit == "collect" ? AnyHit::collect : AnyHit::accumulate;
    options.hits_per_slab = arguments.hits_per_slab;
    options.stop_transmittance = arguments.stop_transmittance;
    if (extinction) options.extinction = *extinction;
    return options;
}

// ---- volumes

std::vector<VoxelGrid> voxel_grids(const VolumeSet& set, const VoxelGridOptions& options) {
    std::vector<VoxelGrid> grids;
    for (const Volume& volume : set.volumes) grids.push_back(voxel_grid(volume, options));
    return grids;
}

void draw_by_reference(const DrawingArguments& arguments, const VolumeSet& set, Drawing& drawing) {
    const VoxelGridOptions options{
        arguments.interpolation == "linear" ? Interpolation::linear : Interpolation::constant,
        arguments.step_voxels};
    const auto draw_with = [&](auto grids) {
        drawing.draw = [grids = std::move(grids)](const Camera& camera, Size size,
                                                  const Progress& progress, DepthImage& depth) {
            depth = render_reference(grids, camera, size.width, size.height, {progress});
        };
    };
    if (set.is_mesh())
        draw_with(level_grids(set, options));
    else
        draw_with(voxel_grids(set, options));
}

void draw_by_optix(const VolumeSet& set, Drawing& drawing) {
    if (set.is_mesh())
        throw Error(
            "optix: levels of a mesh hide each other, which only the reference renderer knows; "
            "give --no-mask to add them up");
    auto volumes = std::make_shared<std::vector<OptixVolume>>();
    for (const VoxelGrid& grid : voxel_grids(set, {})) volumes->emplace_back(grid.bytes());
    drawing.draw = [volumes](const Camera& camera, Size size, const Progress&, DepthImage& depth) {
        depth = DepthImage(size.width, size.height);
        for (OptixVolume& volume : *volumes) {
            const DepthImage part = volume.render(camera, size.width, size.height);
            for (std::size_t n = 0; n < depth.depth.size(); ++n) depth.depth[n] += part.depth[n];
        }
    };
}

// ---- models and particles

/// Kernels cut elsewhere than where they were made: supports reach further, or less far.
void set_cutoff(Gaussians& model, Hierarchy& hierarchy, double cutoff) {
    const double wider = std::max(1.0, cutoff / double{model.cutoff});
    for (float& radius : hierarchy.radius) radius = static_cast<float>(radius * wider);
    model.cutoff = hierarchy.nodes.cutoff = static_cast<float>(cutoff);
}

void draw_by_splat(const DrawingArguments& arguments, std::shared_ptr<Gaussians> model,
                   std::shared_ptr<Hierarchy> hierarchy, Drawing& drawing) {
    // A model without one gets one where the cut is asked for.
    if (hierarchy->empty() && arguments.pixel_error) *hierarchy = build_hierarchy(*model);
    set_cutoff(*model, *hierarchy, cutoff_of_kappa(arguments.kappa, model->cutoff));
    SplatOptions options;
    options.aabb_sigma = arguments.aabb_sigma;
    if (!hierarchy->empty() && arguments.aabb_sigma == 0) {
        options.hierarchy = hierarchy.get();
        options.cut.pixel_error = arguments.pixel_error.value_or(options.cut.pixel_error);
        drawing.cut = std::make_shared<CutReport>();
    }
    auto renderer = std::make_shared<SplatRenderer>(*model, options);
    drawing.draw = [model, hierarchy, renderer, cut = drawing.cut](const Camera& camera, Size size,
                                                                   const Progress& progress,
                                                                   DepthImage& depth) {
        renderer->render(camera, size.width, size.height, depth, progress);
        if (cut) *cut = renderer->cut_report();
    };
}

void draw_by_trace(const DrawingArguments& arguments, const TraceOptions& options,
                   const Gaussians& model, Drawing& drawing) {
    drawing.traced = std::make_shared<TraceReport>();
    drawing.draw = [scene = trace_scene(model, {arguments.aabb_sigma, arguments.kappa}), options,
                    report = drawing.traced](const Camera& camera, Size size,
                                             const Progress& progress, DepthImage& depth) {
        TraceOptions now = options;
        now.progress = progress;
        depth = render_trace(scene, camera, size.width, size.height, now, report.get());
    };
}

void draw_by_optix(const DrawingArguments& arguments, const TraceOptions& options,
                   const Gaussians& model, Drawing& drawing) {
    drawing.traced = std::make_shared<TraceReport>();
    auto scene = std::make_shared<OptixModel>(
        model, TraceSceneOptions{arguments.aabb_sigma, arguments.kappa});
    drawing.draw = [scene, options, report = drawing.traced](const Camera& camera, Size size,
                                                             const Progress&, DepthImage& depth) {
        depth = scene->render(camera, size.width, size.height, options, report.get());
    };
}

void draw_by_cuda(const DrawingArguments& arguments, const Gaussians& model, Drawing& drawing) {
    auto splat = std::make_shared<CudaSplat>(model, arguments.kappa);
    drawing.draw = [splat](const Camera& camera, Size size, const Progress&, DepthImage& depth) {
        depth = splat->render(camera, size.width, size.height);
    };
}

void add_trace_options(CLI::App& command, DrawingArguments& arguments) {
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

void add_drawing_options(CLI::App& command, DrawingArguments& arguments) {
    command
        .add_option("inputs", arguments.inputs,
                    "PLY models, OpenVDB or NanoVDB volumes, or particles (.xyz, .csv, .tsv, "
                    ".vdb); several become one picture")
        ->required();
    command
        .add_option("--renderer", arguments.renderer,
                    "splat: models and particles, exact, object order; trace: the same, ray by "
                    "ray; cuda, optix: splat and trace on an NVIDIA GPU, optix for volumes too; "
                    "reference: volumes, exact through the voxels. Default: splat or reference")
        ->check(CLI::IsMember({"splat", "trace", "cuda", "optix", "reference"}));
    add_trace_options(command, arguments);
    command
        .add_option("--interpolation", arguments.interpolation,
                    "Voxels of the reference: constant (exact), or linear between their centres")
        ->check(CLI::IsMember({"constant", "linear"}))
        ->capture_default_str();
    command
        .add_option("--step", arguments.step_voxels,
                    "Step of linear interpolation, voxels; 0: exact, cell by cell")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    add_volume_options(command, arguments.volume);
    command
        .add_option("--aabb-sigma", arguments.aabb_sigma,
                    "The paper's bounding boxes: a ray counts a Gaussian only if it meets the box "
                    "of this many times the paper's radii; 0: no boxes")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    command
        .add_option("--pixel-error", arguments.pixel_error,
                    "Of models with a hierarchy (vog convert writes one), splat draws coarser "
                    "Gaussians where theirs would be smaller than this many pixels; 0: never. "
                    "Default: 1. A model without one gets one where this is given")
        ->check(CLI::NonNegativeNumber);
    add_point_options(command, arguments.points);
}

void set_primitives_text(Drawing& drawing, std::size_t levels) {
    if (drawing.kind != FileKind::volume) {
        drawing.primitives_text = count_text(drawing.gaussians) + " Gaussians";
        return;
    }
    drawing.primitives_text = count_text(drawing.active_voxels) + " voxels";
    if (levels) drawing.primitives_text += fmt::format(" in {} levels", levels);
}

void draw_volumes(const DrawingArguments& arguments, const VolumeSet& set, Drawing& drawing) {
    for (const Volume& volume : set.volumes) {
        if (!volume.empty()) drawing.box.include(world_box(volume));
        drawing.active_voxels += active_voxels(volume);
    }
    set_primitives_text(drawing, set.is_mesh() ? set.volumes.size() : 0);
    if (drawing.renderer == "reference")
        draw_by_reference(arguments, set, drawing);
    else
        draw_by_optix(set, drawing);
}

void draw_model(const DrawingArguments& arguments, std::optional<double> extinction,
                std::shared_ptr<Gaussians> model, std::shared_ptr<Hierarchy> hierarchy,
                Drawing& drawing) {
    drawing.box = view_box(*model);
    drawing.gaussians = model->size();
    set_primitives_text(drawing, 0);
    const TraceOptions options = trace_options(arguments, extinction);
    if (drawing.renderer == "splat") draw_by_splat(arguments, model, hierarchy, drawing);
    if (drawing.renderer == "trace") draw_by_trace(arguments, options, *model, drawing);
    if (drawing.renderer == "optix") draw_by_optix(arguments, options, *model, drawing);
    if (drawing.renderer == "cuda") draw_by_cuda(arguments, *model, drawing);
}

Drawing begin_drawing(const DrawingArguments& arguments, const CLI::App& command) {
    Drawing drawing;
    drawing.kind = common_kind(arguments.inputs, arguments.volume.grid);
    const std::string& input = arguments.inputs.front();
    if (drawing.kind != FileKind::points) refuse_group(command, kPointGroup, "models and volumes");
    drawing.renderer = !arguments.renderer.empty()        ? arguments.renderer
                       : drawing.kind == FileKind::volume ? "reference"
                                                          : "splat";
    check_renderer_options(drawing.renderer, drawing.kind, command);
    const bool voxels = drawing.renderer == "reference" || drawing.renderer == "optix";
    if (drawing.kind == FileKind::volume && !voxels)
        throw Error(fmt::format("{}: is a volume; convert it first: vog convert {} -o model.ply",
                                input, input));
    if (drawing.kind != FileKind::volume && drawing.renderer == "reference")
        throw Error(fmt::format("{}: holds {}; the reference renders volumes", input,
                                drawing.kind == FileKind::model ? "a model" : "particles"));
    return drawing;
}

Drawing load_drawing(const DrawingArguments& arguments, std::optional<double> extinction,
                     const CLI::App& command) {
    Drawing drawing = begin_drawing(arguments, command);
    if (drawing.kind == FileKind::volume) {
        draw_volumes(arguments, load_volumes(arguments.inputs, arguments.volume), drawing);
        return drawing;
    }
    // Particles need no file between: one Gaussian each.
    auto hierarchy = std::make_shared<Hierarchy>();
    auto model = std::make_shared<Gaussians>(
        drawing.kind == FileKind::points
            ? convert_points(load_points(arguments.inputs, arguments.points, arguments.volume.grid),
                             point_options(arguments.points))
            : load_models(arguments.inputs,
                          drawing.renderer == "splat" ? hierarchy.get() : nullptr));
    draw_model(arguments, extinction, std::move(model), std::move(hierarchy), drawing);
    return drawing;
}

}  // namespace vog::cli
