// drawing_options.cpp: help, checks and evaluation of the options of renderers.
#include "pictures/drawing_options.h"

#include <fmt/format.h>

#include "shared/validators.h"
#include "vog/error.h"

namespace vog::cli {

namespace {

using enum RenderOption;

/// Options on the command line, also those with the value of the default.
std::vector<RenderOption> given_options(const CLI::App& command) {
    std::vector<RenderOption> given;
    for (const RenderOption option : {anyhit, hits_per_slab, stop_transmittance, aabb_sigma,
                                      pixel_error, kappa, interpolation, step, samples})
        if (command.count(spelled(option, OptionSpelling::flags)) > 0) given.push_back(option);
    // Pictures by value are clipped by every renderer that has them.
    const CLI::Option* show = command.get_option_no_throw("--show");
    const std::string shown = show && show->count() > 0 ? show->as<std::string>() : "";
    const bool by_value = shown == "volume" || shown == "maximum";
    if (!by_value && command.count("--clip") + command.count("--clip-plane") > 0)
        given.push_back(clip);
    return given;
}

/// throws CLI::ValidationError for options that are another renderer's
void check_renderer_options(Renderer renderer, FileKind kind, const CLI::App& command) {
    const RenderInput input =
        kind == FileKind::volume ? RenderInput::volumes : RenderInput::gaussians;
    try {
        require_options(renderer, input, given_options(command), OptionSpelling::flags);
    } catch (const Error& error) {
        throw CLI::ValidationError(error.what());
    }
}

/// "splat", "trace", ...
std::vector<std::string> renderer_names() {
    std::vector<std::string> names;
    for (const RendererInfo& one : renderers()) names.emplace_back(one.name);
    return names;
}

/// "splat: models and particles, exact, object order; trace: ..."
std::string renderers_text() {
    std::string text;
    for (const RendererInfo& one : renderers())
        text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", one.name, one.description);
    return text;
}

void add_trace_options(CLI::App& command, DrawingArguments& arguments) {
    const OptionGroup grouped(command, "Ray tracing");
    command
        .add_option(
            "--anyhit", arguments.anyhit,
            "Treatment of a hit by trace and optix: accumulate adds it at once; collect, as the "
            "paper, gathers, sorts by entry and integrates front to back")
        ->check(CLI::IsMember({"accumulate", "collect"}))
        ->capture_default_str();
    command
        .add_option("--slab-hits", arguments.hits_per_slab,
                    "Hits that collect holds at once; rays with more go on, slab by slab")
        ->check(CLI::Range(1, 256))
        ->capture_default_str();
    command
        .add_option("--stop-transmittance", arguments.stop_transmittance,
                    "End a ray of collect once its transmittance is below this; 0: never")
        ->check(CLI::Range(0.0, 0.999999))
        ->capture_default_str();
}

}  // namespace

void add_clip_options(CLI::App& command, ClipArguments& arguments) {
    const OptionGroup grouped(command, "Clipping");
    command.add_option("--clip", arguments.clip_box,
                       "Box of the world that counts, x0,y0,z0,x1,y1,z1, exact on every ray; a "
                       "page or a window begins with it");
    command
        .add_option("--clip-plane", arguments.clip_planes,
                    "Plane nx,ny,nz,d that cuts off its side behind: a point x of the world counts "
                    "where n.x >= d; may be given again")
        ->allow_extra_args(false);
}

void add_drawing_options(CLI::App& command, DrawingArguments& arguments) {
    command
        .add_option("inputs", arguments.inputs,
                    "PLY models, OpenVDB or NanoVDB volumes, or particles (.xyz, .csv, .tsv, "
                    ".vdb); several become one picture")
        ->required();
    command
        .add_option("--renderer", arguments.renderer,
                    renderers_text() + ". Default: splat or reference")
        ->check(CLI::IsMember(renderer_names()));
    add_trace_options(command, arguments);
    command
        .add_option("--kappa", arguments.kappa,
                    "Cut kernels where they have fallen to this share of their peak, in place of "
                    "the model's own cutoff: k = sqrt(-2 ln kappa)")
        ->check(CLI::Range(1.3e-14, 0.999));
    command
        .add_option("--interpolation", arguments.interpolation,
                    "Voxels of the reference: constant (exact), or linear between their centres")
        ->check(CLI::IsMember({"constant", "linear"}))
        ->capture_default_str();
    command
        .add_option("--step", arguments.step_voxels,
                    "Step of linear interpolation, voxels; 0: exact, cell by cell")
        ->check(non_negative_number())
        ->capture_default_str();
    command
        .add_option(
            "--samples", arguments.samples,
            "Rays of reference and optix: N for the mean T of N x N in each pixel; 1: the ray "
            "through its centre")
        ->check(CLI::Range(1, 64))
        ->capture_default_str();
    add_clip_options(command, arguments);
    add_volume_options(command, arguments.volume);
    command
        .add_option("--aabb-sigma", arguments.aabb_sigma,
                    "The paper's bounding boxes: a ray counts a Gaussian only if it meets the box "
                    "of this many times the paper's radii; 0: no boxes")
        ->check(non_negative_number())
        ->capture_default_str();
    command
        .add_option(
            "--pixel-error", arguments.pixel_error,
            "Largest error of a coarser Gaussian that splat, cuda or optix draws in place of "
            "finer ones, pixels; 0: none is drawn; default: 1 of splat, none of the others. "
            "Needs a hierarchy, which vog convert writes; a model without one gets one when "
            "this option is given")
        ->check(non_negative_number());
    add_point_options(command, arguments.points);
}

Clipping clip_of(const ClipArguments& arguments) {
    Clipping clip;
    const auto refuse = [](const std::string& option, const std::string& what) {
        throw CLI::ValidationError(option + ": " + what);
    };
    if (!arguments.clip_box.empty()) {
        const std::vector<double> c = parse_numbers(arguments.clip_box);
        if (c.size() != 6) refuse("--clip " + arguments.clip_box, "expected x0,y0,z0,x1,y1,z1");
        clip.box = Box{{c[0], c[1], c[2]}, {c[3], c[4], c[5]}};
    }
    for (const std::string& text : arguments.clip_planes) {
        const std::vector<double> c = parse_numbers(text);
        if (c.size() != 4) refuse("--clip-plane " + text, "expected nx,ny,nz,d");
        clip.planes.push_back({{c[0], c[1], c[2]}, c[3]});
    }
    try {
        validate(clip);
    } catch (const Error& error) {
        refuse("--clip", error.what());
    }
    return clip;
}

RenderOptions render_options(const DrawingArguments& arguments) {
    RenderOptions options;
    options.aabb_sigma = arguments.aabb_sigma;
    options.kappa = arguments.kappa;
    options.pixel_error = arguments.pixel_error;
    options.trace.anyhit = arguments.anyhit == "collect" ? AnyHit::collect : AnyHit::accumulate;
    options.trace.hits_per_slab = arguments.hits_per_slab;
    options.trace.stop_transmittance = arguments.stop_transmittance;
    options.voxels.interpolation =
        arguments.interpolation == "linear" ? Interpolation::linear : Interpolation::constant;
    options.voxels.step_voxels = arguments.step_voxels;
    options.samples = arguments.samples;
    options.clip = clip_of(arguments);
    return options;
}

Renderer renderer_of(const DrawingArguments& arguments, FileKind kind, const CLI::App& command) {
    const std::string& input = arguments.inputs.front();
    const bool volumes = kind == FileKind::volume;
    const Renderer renderer = !arguments.renderer.empty() ? renderer_named(arguments.renderer)
                              : volumes                   ? Renderer::reference
                                                          : Renderer::splat;
    check_renderer_options(renderer, kind, command);
    if (volumes && !draws(renderer, RenderInput::volumes))
        throw Error(fmt::format("{}: is a volume; convert it first: vog convert {} -o model.ply",
                                input, input));
    if (!volumes && !draws(renderer, RenderInput::gaussians))
        throw Error(fmt::format("{}: holds {}; the {} renders volumes", input,
                                kind == FileKind::model ? "a model" : "particles",
                                info_of(renderer).name));
    return renderer;
}

}  // namespace vog::cli
