// drawing_options.h: inputs of vog render, and the options of its renderers.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "shared/inputs.h"
#include "vog/clip.h"
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
    int samples = RenderOptions{}.samples;
    double step_voxels = VoxelGridOptions{}.step_voxels;
};

/// Adds the inputs, the options of the renderers and those of the readers.
void add_drawing_options(CLI::App& command, DrawingArguments& arguments);

/// Renderer of --renderer, or the default one of the inputs' kind.
/// throws  CLI::ValidationError for options of `command` that are another renderer's, vog::Error for a renderer that does not
///         draw such inputs
Renderer renderer_of(const DrawingArguments& arguments, FileKind kind, const CLI::App& command);
/// Options of the renderer, without the factor on density of --stop-transmittance.
RenderOptions render_options(const DrawingArguments& arguments);

/// Clip by --clip and --clip-plane.
/// throws  CLI::ValidationError for texts that are none
Clipping clip_of(const ClipArguments& arguments);

}  // namespace vog::cli
