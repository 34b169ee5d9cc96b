// drawing.h: Inputs of vog render, prepared for a renderer to be drawn from any camera.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "shared/inputs.h"
#include "vog/camera.h"
#include "vog/clip.h"
#include "vog/image.h"
#include "vog/lod.h"
#include "vog/progress.h"
#include "vog/renderer.h"

namespace vog::cli {

struct ClipArguments {
    std::string clip_box;                  ///< x0,y0,z0,x1,y1,z1; empty: none
    std::vector<std::string> clip_planes;  ///< nx,ny,nz,d
};
/// Adds --clip and --clip-plane.
void add_clip_options(CLI::App& command, ClipArguments& arguments);

struct DrawingArguments : ClipArguments {
    std::vector<std::string> inputs;
    std::string renderer, interpolation = "constant", anyhit = "accumulate";
    VolumeInputOptions volume;
    PointInputOptions points;
    std::optional<double> pixel_error;
    std::optional<SiteView>
        site_view;  ///< of inputs that are sites alone; none: they are read whole
    double aabb_sigma = 0, kappa = 0, stop_transmittance = 0;
    int hits_per_slab = TraceOptions{}.hits_per_slab;
    int samples = ReferenceOptions{}.samples;
    double step_voxels = VoxelGridOptions{}.step_voxels;
};

/// Adds the inputs, the options of the renderers and those of the readers.
void add_drawing_options(CLI::App& command, DrawingArguments& arguments);

/// Data prepared for one renderer, with the facts that reports give of them.
struct Drawing {
    FileKind kind = FileKind::model;
    Renderer renderer = Renderer::splat;
    std::string primitives_text;  ///< "20,000 Gaussians"
    std::uint64_t gaussians = 0, active_voxels = 0;
    Subject subject;                 ///< for named views
    std::vector<std::string> notes;  ///< notes that reading printed, for --json
    std::function<void(const Camera&, Size, const Progress&, DepthImage&)> draw;
    std::shared_ptr<const DepthRenderer> reports;  ///< null where its reports are of a part only
    std::function<double()> picture_ms{};  ///< gpu_ms of fields and values on a GPU, or nothing

    std::optional<CutReport> cut() const;       ///< DepthRenderer::cut
    std::optional<TraceReport> traced() const;  ///< DepthRenderer::traced
    std::optional<double> gpu_ms() const;       ///< of the last picture
};

/// Reads the inputs and prepares them for --renderer, or for the default one of their kind.
/// extinction  --extinction where it is a number: factor on density under --stop-transmittance
/// throws      vog::Error for inputs that cannot be read or drawn; CLI::ValidationError for options
///             of `command` that are another renderer's
Drawing load_drawing(const DrawingArguments& arguments, std::optional<double> extinction,
                     const CLI::App& command);

/// Clip by --clip and --clip-plane.
/// throws  CLI::ValidationError for texts that are none
Clipping clip_of(const ClipArguments& arguments);
/// The same inside the box of a periodic model (inside_period).
Clipping clip_of(const ClipArguments& arguments, const Gaussians& model);

// The steps of load_drawing, for callers that read the inputs in another way.

/// A drawing with kind and renderer of the inputs, without data.
/// throws  as load_drawing does for options that do not go with them
Drawing begin_drawing(const DrawingArguments& arguments, const CLI::App& command);
/// Prepares volumes, and sets box and counts from them.
void draw_volumes(const DrawingArguments& arguments, const VolumeSet& set, Drawing& drawing);
/// Prepares a model with its hierarchy, and sets box and counts from it. An empty hierarchy is built
/// if --pixel-error is given, which sorts the model.
void draw_model(const DrawingArguments& arguments, std::optional<double> extinction,
                const std::shared_ptr<Gaussians>& model,
                const std::shared_ptr<Hierarchy>& hierarchy, Drawing& drawing);
/// "20,000 Gaussians", "1,000 voxels in 3 levels"
void set_primitives_text(Drawing& drawing, std::size_t levels);

}  // namespace vog::cli
