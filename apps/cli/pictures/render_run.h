// render_run.h: one run of the renderer, load -> render -> shade -> image; shared by vog and
// vog-mpi.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "options/camera_options.h"
#include "options/memory_options.h"
#include "options/request_options.h"
#include "pictures/picture_request.h"
#include "pictures/scene_inputs.h"
#include "terminal/terminal.h"

namespace vog::cli {

struct RenderArguments {
    DrawingArguments drawing;
    ViewArguments view;
    RequestWords words;        ///< members of the request that options state
    PictureRequest request{};  ///< with them, and those of --request
    MemoryArguments memory;
    std::string output, depth_output, values_output, request_file;
    /// Options that the inputs are read with, for records of pictures.
    std::map<std::string, std::vector<std::string>> reading{};
    bool json = false, verbose = false;
    int threads = 0, repeat = 0;
    int turntable = 0;   ///< pictures of a full turn; 0: one view
    bool steps = false;  ///< time runs once during the turn, an input a step
    /// Pictures of the turn that are drawn, from 0: of one step.
    std::optional<std::pair<int, int>> turn_part{};
    double per_second = 30;  ///< pictures of a film
    std::function<void(const Image&)>
        take_picture{};                    ///< takes pictures in place of the output's file
    std::optional<SharedScales> shared{};  ///< of the first picture of a sequence
    std::optional<Subject> subject;        ///< of all inputs, in place of one: one camera for many
};

/// Figures of one rendered picture, as the command reports them.
struct RenderedPicture {
    std::string output, depth_output, values_output;  ///< files written; empty: none
    std::string quantity;                             ///< "T", "column density", "count per area"
    std::string units;                                ///< of --units
    std::optional<ColorScale> scale;                  ///< of the shown values; none: T
    bool layered = false;                             ///< each layer has its own scale
    double above_range = 0;                           ///< fraction of pixels above scale->high
    std::string renderer, primitives_text;
    int width = 0, height = 0;  ///< pixels
    std::uint64_t gaussians = 0, active_voxels = 0;
    int threads = 0;
    double extinction = 1;                ///< factor on density that T is at
    double covered = 0;                   ///< fraction of pixels with T > 0
    double mean_t = 0, max_t = 0;         ///< over all pixels
    std::vector<double> render_ms;        ///< one per timed render, ascending; not empty
    SharedScales scales{};                ///< for later pictures
    std::optional<double> unit_distance;  ///< of a volume picture, world units
    std::optional<double>
        steepest_gradient;    ///< of one with gradient opacity (steepest_gradient in vog/picture.h)
    double mean_opacity = 0;  ///< of a volume picture, over the pixels it covers
    std::optional<CutReport> cut;                          ///< renders through a hierarchy
    std::optional<SiteCutReport> site;                     ///< of sites read for the view
    std::optional<TraceReport> traced;                     ///< renders by rays
    std::optional<double> gpu_ms;                          ///< device time of the last picture
    std::vector<std::pair<std::string, double>> stage_ms;  ///< in the order they ran
    std::uint64_t peak_memory = 0;                         ///< bytes
    std::vector<std::string> notes;                        ///< printed about the inputs
    std::string record;                                    ///< how it was made, JSON

    double median_ms() const;
    /// Whether the shown quantity is T, which an extinction multiplies.
    bool has_extinction() const { return !scale; }
};
/// The report of --json.
nlohmann::ordered_json to_json(const RenderedPicture& picture);
/// The report in words, on standard output.
/// repeated  whether --repeat was given: the times get a line of their own
void print(const RenderedPicture& picture, bool repeated);

/// Renders and writes the picture of each view: one, or those of --turntable.
/// returns  their figures; none on ranks other than the root
std::vector<RenderedPicture> render(const RenderArguments& arguments, const GivenOptions& command,
                                    const RenderRanks& ranks = {});

}  // namespace vog::cli
