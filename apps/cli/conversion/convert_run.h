// convert_run.h: one run of a conversion, load -> convert -> save; shared by vog and vog-mpi.
#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "files/inputs.h"
#include "options/input_options.h"
#include "options/memory_options.h"
#include "terminal/terminal.h"
#include "vog/convert_fields.h"
#include "vog/convert_moments.h"
#include "vog/convert_paper.h"
#include "vog/lod.h"

namespace vog::cli {

struct ConvertArguments : ModelArguments {
    std::string method = "moments", measure = "density";
    int lod = 0;
    std::string strategy, amplitude = "mean";
    PaperOptions paper;
    MomentOptions moments;
    std::vector<std::string> fields;  ///< texts of --field (options/field_options.h)
    std::string labels{};             ///< FILE:GRID, FILE or GRID; empty: none
    std::string joint_field;          ///< --for: a field, or "volume"; empty: none
    int joint_steps = kJointSteps;
    bool no_hierarchy = false, again = false;
    MemoryArguments memory;
};

/// Method and options of a conversion of volumes.
struct VolumeConversion {
    bool by_moments = true;
    MomentOptions moments;  ///< used by moments
    PaperOptions paper;     ///< used otherwise
};

/// Box of --periodic for volumes; that of their domain where the option states none. None: not given.
/// volumes     all of them, or this process's parts
/// collective  processes that hold the others; null: a single process
/// throws      vog::Error where active voxels do not state the domain
std::optional<Box> period_of(const ConvertArguments& arguments, std::span<const Volume> volumes,
                             const Collective* collective = nullptr);

/// Totals over the moment conversions of several volumes.
struct MomentTotals {
    double cells_mass = 0, dropped_mass = 0;  ///< density times world volume
    double worst_error = -1;                  ///< relative L2 of T; below 0: not measured
    double mean_error = -1;                   ///< the same over all views
    /// MomentReport's: of the voxels interpolated linearly.
    double interpolation_error = -1, mean_interpolation_error = -1;
    bool stopped_by_count = false;  ///< MomentReport::stopped_by_count of any
    std::size_t dropped_cells = 0;
    std::vector<std::pair<std::string, double>> stage_ms;  ///< in the order they ran

    void add(const MomentReport& one, double volume_mass) {
        cells_mass += one.mass_ratio * volume_mass;
        dropped_mass += one.dropped_mass_share * volume_mass;
        dropped_cells += one.dropped_cells;
        worst_error = std::max(worst_error, one.measured_error);
        mean_error = std::max(mean_error, one.mean_error);
        interpolation_error = std::max(interpolation_error, one.interpolation_error);
        mean_interpolation_error = std::max(mean_interpolation_error, one.mean_interpolation_error);
        stopped_by_count |= one.stopped_by_count;
        for (const auto& [name, ms] : one.stage_ms) {
            const auto known = std::find_if(stage_ms.begin(), stage_ms.end(),
                                            [&](const auto& stage) { return stage.first == name; });
            if (known == stage_ms.end())
                stage_ms.emplace_back(name, ms);
            else
                known->second += ms;
        }
    }
    /// The totals as the report of one conversion.
    MomentReport report(double data_mass) const {
        MomentReport all;
        all.mass_ratio = data_mass > 0 ? cells_mass / data_mass : 1;
        all.dropped_mass_share = data_mass > 0 ? dropped_mass / data_mass : 0;
        all.dropped_cells = dropped_cells;
        all.measured_error = worst_error;
        all.mean_error = mean_error;
        all.interpolation_error = interpolation_error;
        all.mean_interpolation_error = mean_interpolation_error;
        all.stopped_by_count = stopped_by_count;
        all.stage_ms = stage_ms;
        return all;
    }
};

/// Figures of a written model, as the command reports them.
struct Converted {
    std::string method, options, summary;
    std::uint64_t gaussians = 0, source_voxels = 0;
    std::uint64_t nodes = 0;            ///< of the hierarchy
    std::uint64_t bytes = 0;            ///< size of the file
    double mass = 0;                    ///< density times world volume
    std::vector<std::string> fields{};  ///< names
    std::vector<std::string> notes{};   ///< printed about the inputs
    JointReport joint{};                ///< of --for
};
/// output  the file
Converted converted(const Gaussians& model, const Hierarchy& hierarchy, const std::string& output);
/// Whether an output is a model: .ply or .vogz.
bool is_model_output(const std::string& output);

/// Prints the report of a conversion in words, or returns it where --json is given.
nlohmann::ordered_json report(const ConvertArguments& arguments, FileKind kind,
                              const Converted& made, double volume_mass,
                              const MomentTotals& moments, const Stages& stages);

/// Hooks for a conversion by several MPI ranks; the defaults are a single process.
struct ConvertRanks {
    const Collective* collective = nullptr;  ///< reductions over the ranks; null: one process
    bool is_root = true;                     ///< the rank that writes and reports
    /// Loads, converts and writes volumes in parts. Empty: one process does.
    std::function<nlohmann::ordered_json(const ConvertArguments&, const VolumeConversion&, Stages&)>
        convert_volumes{};
    /// Inputs of a sequence that this rank converts alone: one flag per input. Empty: all of them.
    std::function<std::vector<bool>(const std::vector<std::string>&)> assigned{};
    /// One text per rank, on every rank. Empty: a single process.
    std::function<std::vector<std::string>(const std::string&)> allgather{};
};

}  // namespace vog::cli
