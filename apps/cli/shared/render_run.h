// render_run.h: one run of the renderer, load -> render -> shade -> image; shared by vog and
// vog-mpi.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "fields/divided_volumes.h"
#include "options/camera_options.h"
#include "options/color_options.h"
#include "options/memory_options.h"
#include "options/quantity_options.h"
#include "options/value_options.h"
#include "shared/drawing.h"
#include "shared/terminal.h"
#include "vog/distributed.h"
#include "vog/image.h"
#include "vog/lod.h"
#include "vog/scan_io.h"
#include "vog/trace.h"

namespace vog::cli {

struct RenderArguments {
    DrawingArguments drawing;
    ViewArguments view;
    ColorArguments color;
    QuantityArguments quantity;
    ValueArguments value;
    MemoryArguments memory;
    std::string output, depth_output, size = "512x512";
    bool json = false, verbose = false;
    int threads = 0, repeat = 0;
    int turntable = 0;   ///< pictures of a full turn; 0: one view
    bool steps = false;  ///< time runs once during the turn, an input a step
    /// Pictures of the turn that are drawn, from 0: of one step.
    std::optional<std::pair<int, int>> turn_part{};
    double per_second = 30;  ///< pictures of a film
    std::function<void(const Image&)>
        take_picture{};              ///< takes pictures in place of the output's file
    bool later_frame = false;        ///< of a sequence: range and unit distance are the first's
    std::optional<Subject> subject;  ///< of all inputs, in place of one: one camera for many
};

/// Figures of one rendered picture, as the command reports them.
struct RenderedPicture {
    std::string output, depth_output, values_output;  ///< files written; empty: none
    std::string quantity;                             ///< "T", "column density", "count per area"
    std::string units;                                ///< of --units
    std::optional<ColorScale> scale;                  ///< of column density
    double above_range = 0;                           ///< fraction of pixels above scale->high
    std::string renderer, primitives_text;
    int width = 0, height = 0;  ///< pixels
    Camera camera;
    std::uint64_t gaussians = 0, active_voxels = 0;
    int threads = 0;
    double extinction = 1;                ///< factor on density that T is at
    double covered = 0;                   ///< fraction of pixels with T > 0
    double mean_t = 0, max_t = 0;         ///< over all pixels
    std::vector<double> render_ms;        ///< one per timed render, ascending; not empty
    std::optional<double> unit_distance;  ///< of a volume picture, world units
    double mean_opacity = 0;              ///< of a volume picture, over the pixels it covers
    std::optional<CutReport> cut;         ///< renders through a hierarchy
    std::optional<SiteCutReport> site;    ///< of sites read for the view
    std::optional<TraceReport> traced;    ///< renders by rays
    std::optional<double> gpu_ms;         ///< device time of the last picture
    std::vector<std::pair<std::string, double>> stage_ms;  ///< in the order they ran
    std::uint64_t peak_memory = 0;                         ///< bytes
    std::vector<std::string> notes;                        ///< printed about the inputs

    double median_ms() const;
    /// Whether the shown quantity is T, which an extinction multiplies.
    bool has_extinction() const { return !scale; }
};
/// Box that --axes outlines, world units: of the active voxels, where they are known.
Box outline_of(const Subject& subject);
/// A picture with all that is drawn over it and around it: --axes, --scale-bar, --color-bar, --title.
/// label  of the colour bar
Image annotated_picture(const RenderArguments& arguments, const Drawing& drawing,
                        const Camera& camera, Image image, const TransferFunction& tf,
                        const ColorScale& scale, const std::string& label);
/// Head of the first input where it is a dense image, with the units that it states; else empty.
VolumeHead head_of(const RenderArguments& arguments);
/// Unit of column density by those of values and lengths: "g/cm3 kpc"; empty: not known.
std::string column_unit(const VolumeHead& head);
/// Factor from the unit that the data state to the one of --units; 1 where one of the two is not known.
/// throws  CLI::ValidationError for --units that does not measure the same
double units_factor(const std::string& stated, const std::string& requested);
/// Share of the values above a limit.
double share_above(std::span<const float> values, double limit);
/// Figures of a picture of T or column density, and notes on it.
RenderedPicture figures_of(const RenderArguments& arguments, const Drawing& drawing,
                           const DepthImage& depth, std::vector<double> render_ms,
                           const Stages& stages, const ColorScale& scale);
/// Draws once, or as --repeat states.
/// returns  times, ms, of which there is at least one
std::vector<double> timed(const RenderArguments& arguments, const std::function<void()>& draw);
/// The report of --json.
nlohmann::ordered_json to_json(const RenderedPicture& picture);
/// The report in words, on standard output.
/// repeated  whether --repeat was given: the times get a line of their own
void print(const RenderedPicture& picture, bool repeated);

/// Adds the options of `vog render`.
void add_render_options(CLI::App& command, RenderArguments& arguments);

/// Hooks for rendering by several MPI ranks; the defaults are a single process.
struct RenderRanks {
    /// Reads this rank's part of the inputs.
    std::function<Drawing(const DrawingArguments&, std::optional<double> extinction,
                          const CLI::App&)>
        load = load_drawing;
    /// Reads this rank's part of models, with the box of the whole, for pictures of fields.
    std::function<Gaussians(const std::vector<std::string>&, const ValueRules&)> load_models{};
    /// Reads this rank's part of volumes, and the voxels beside it if wanted, for pictures of fields and by value.
    std::function<DividedVolumes(const DrawingArguments&, const VolumeInputOptions&, bool beside)>
        load_volumes{};
    Collective collective{};  ///< operations between the ranks
    bool is_root = true;      ///< the rank that shades, writes and reports
    /// Inputs of a sequence that this rank renders alone: one flag per input. Empty: all of them.
    std::function<std::vector<bool>(const std::vector<std::string>&)> assigned{};
    /// One text per rank, on every rank. Empty: a single process.
    std::function<std::vector<std::string>(const std::string&)> allgather{};

    /// Whether several ranks hold parts of one input.
    bool divided() const { return collective.count > 1; }
};
/// Renders and writes the picture of each view: one, or those of --turntable.
/// returns  their figures; none on ranks other than the root
std::vector<RenderedPicture> render(const RenderArguments& arguments, const CLI::App& command,
                                    const RenderRanks& ranks = {});

/// Renders and writes the pictures of --show mean or deviation, for render() (field_run.cpp).
/// throws  vog::Error for inputs without the field; CLI::ValidationError for options without effect
std::vector<RenderedPicture> render_field(const RenderArguments& arguments, const CLI::App& command,
                                          const RenderRanks& ranks);

/// Renders and writes the pictures of --show volume, for render() (volume_run.cpp).
/// throws  vog::Error for inputs without the field; CLI::ValidationError for options without effect
std::vector<RenderedPicture> render_volume(const RenderArguments& arguments,
                                           const CLI::App& command, const RenderRanks& ranks);

/// Renders and writes the pictures of --show maximum, for render() (maximum_run.cpp).
/// throws  vog::Error for inputs without the field; CLI::ValidationError for options without effect
std::vector<RenderedPicture> render_maximum(const RenderArguments& arguments,
                                            const CLI::App& command, const RenderRanks& ranks);

/// Adds the subcommand.
void add_render(CLI::App& app, const std::shared_ptr<RenderArguments>& arguments,
                const RenderRanks& ranks);

}  // namespace vog::cli
