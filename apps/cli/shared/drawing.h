// drawing.h: inputs and a renderer, made ready to draw from any camera.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "shared/inputs.h"
#include "vog/camera.h"
#include "vog/image.h"
#include "vog/lod.h"
#include "vog/progress.h"
#include "vog/reference.h"
#include "vog/trace.h"

namespace vog::cli {

struct DrawingArguments {
    std::vector<std::string> inputs;
    std::string renderer, interpolation = "constant", anyhit = "accumulate";
    VolumeInputOptions volume;
    PointInputOptions points;
    std::optional<double> pixel_error;
    double aabb_sigma = 0, kappa = 0, stop_transmittance = 0;
    int hits_per_slab = TraceOptions{}.hits_per_slab;
    double step_voxels = VoxelGridOptions{}.step_voxels;
};

/// Adds the inputs and the options of the renderers and of what they read.
void add_drawing_options(CLI::App& command, DrawingArguments& arguments);

/// What is drawn: models by splatting or rays, volumes by the reference, either on a GPU.
struct Drawing {
    FileKind kind = FileKind::model;
    std::string renderer;
    std::string primitives_text;  ///< "20,000 Gaussians"
    std::uint64_t gaussians = 0, active_voxels = 0;
    Box box;  ///< what views look at
    std::function<void(const Camera&, Size, const Progress&, DepthImage&)> draw;
    std::shared_ptr<TraceReport> traced;  ///< of the last draw, where rays were traced
    std::shared_ptr<CutReport> cut;       ///< of the last draw, where it was through a hierarchy
};

/// Reads the inputs and gives them to the renderer asked for, or to the one of their kind.
/// extinction  a number, where one was asked for: what --stop-transmittance counts with
/// throws      vog::Error for what cannot be read or drawn; CLI::ValidationError for options of
///             `command` that are another renderer's
Drawing load_drawing(const DrawingArguments& arguments, std::optional<double> extinction,
                     const CLI::App& command);

// The steps of load_drawing, for those who read the inputs in another way.

/// Kind and renderer of the inputs. throws as load_drawing does for options that do not go with
/// them
Drawing begin_drawing(const DrawingArguments& arguments, const CLI::App& command);
/// Gives volumes to the renderer; box and counts are theirs.
void draw_volumes(const DrawingArguments& arguments, const VolumeSet& set, Drawing& drawing);
/// Gives a model to the renderer, with its hierarchy or an empty one; box and counts are its.
void draw_model(const DrawingArguments& arguments, std::optional<double> extinction,
                std::shared_ptr<Gaussians> model, std::shared_ptr<Hierarchy> hierarchy,
                Drawing& drawing);
/// "20,000 Gaussians", "1,000 voxels in 3 levels"
void set_primitives_text(Drawing& drawing, std::size_t levels);

}  // namespace vog::cli
