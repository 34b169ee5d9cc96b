// drawing.h: inputs and a renderer, made ready to draw from any camera.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "inputs.h"
#include "vog/camera.h"
#include "vog/hierarchy.h"
#include "vog/image.h"
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

}  // namespace vog::cli
