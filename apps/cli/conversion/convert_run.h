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
#include "vog/conversion_schema.h"
#include "vog/lod.h"

namespace vog::cli {

struct ConvertArguments : ModelArguments, ConversionOptions {
    std::string measure = "density";
    std::vector<std::string> fields;  ///< texts of --field (options/field_options.h)
    std::string labels{};             ///< FILE:GRID, FILE or GRID; empty: none
    bool no_hierarchy = false, again = false;
    MemoryArguments memory;
};

/// Method and options of a conversion of volumes.
struct VolumeConversion {
    bool by_moments = true;
    MomentOptions moments;  ///< used by moments
    PaperOptions paper;     ///< used otherwise
};

/// Options of a conversion of volumes by moments.
/// throws  UsageError for --budget of a sum of volumes
MomentOptions moment_options(const ConvertArguments& arguments);

/// Box of --periodic for volumes; that of their domain where the option states none. None: not given.
/// volumes     all of them, or this process's parts
/// collective  processes that hold the others; null: a single process
/// throws      vog::Error where active voxels do not state the domain
std::optional<Box> period_of(const ConvertArguments& arguments, std::span<const Volume> volumes,
                             const Collective* collective = nullptr);

/// Totals over the moment conversions of several volumes.
struct MomentTotals {
    using Numbers = std::vector<std::pair<std::string, double>>;
    /// Masses, density times world volume, in place of mass_ratio and dropped_mass_share; the largest errors.
    MomentReport sums;

    MomentTotals() { sums.mass_ratio = 0; }
    void add(const MomentReport& one, double volume_mass) {
        sums.mass_ratio += one.mass_ratio * volume_mass;
        sums.dropped_mass_share += one.dropped_mass_share * volume_mass;
        sums.dropped_cells += one.dropped_cells;
        for (const auto error :
             {&MomentReport::measured_error, &MomentReport::mean_error,
              &MomentReport::interpolation_error, &MomentReport::mean_interpolation_error})
            sums.*error = std::max(sums.*error, one.*error);
        sums.stopped_by_count |= one.stopped_by_count;
        for (const auto& [name, error] : one.field_errors) {
            double& largest = number_of(sums.field_errors, name);
            largest = std::max(largest, error);
        }
        for (const auto& [name, ms] : one.stage_ms) number_of(sums.stage_ms, name) += ms;
    }
    /// Number of a name, 0 where it is new.
    static double& number_of(Numbers& all, const std::string& name) {
        const auto known = std::ranges::find(all, name, &Numbers::value_type::first);
        return known == all.end() ? all.emplace_back(name, 0.0).second : known->second;
    }
    /// The totals as the report of one conversion.
    MomentReport report(double data_mass) const {
        MomentReport all = sums;
        all.mass_ratio = data_mass > 0 ? sums.mass_ratio / data_mass : 1;
        all.dropped_mass_share = data_mass > 0 ? sums.dropped_mass_share / data_mass : 0;
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

/// Level-of-detail hierarchy of the model; empty with --no-hierarchy.
/// index_from_world  lattice of the model's cells; none for particles
Hierarchy hierarchy_of(Gaussians& model, const ConvertArguments& arguments,
                       const std::optional<Affine>& index_from_world, Stages& stages);
/// Note where even the finest model has a larger error than --error.
void note_missed(const std::string& input, double measured, double target);

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
