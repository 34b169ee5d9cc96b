// convert_run.h: load -> convert -> save: what vog convert and vog-mpi convert share.
#pragma once

#include <algorithm>
#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "options/memory_options.h"
#include "shared/inputs.h"
#include "shared/terminal.h"
#include "vog/convert_moments.h"
#include "vog/convert_paper.h"
#include "vog/lod.h"

namespace vog::cli {

struct ConvertArguments {
    std::vector<std::string> inputs;
    std::string output, method = "moments";
    VolumeInputOptions volume;
    PointInputOptions points;
    int lod = 0;
    std::string strategy, amplitude = "mean";
    PaperOptions paper;
    MomentOptions moments;
    int threads = 0;
    bool stamp = false, no_hierarchy = false, json = false, verbose = false, again = false;
    MemoryArguments memory;
};

/// What was asked of the conversion of volumes: options of the one method or the other.
struct VolumeConversion {
    bool by_moments = true;
    MomentOptions moments;
    PaperOptions paper;
};

/// What is told of several volumes' conversion by moments.
struct MomentTotals {
    double cells_mass = 0, dropped_mass = 0, worst_error = -1;
    std::size_t dropped_cells = 0;
    std::vector<std::pair<std::string, double>> stage_ms;  ///< in the order they ran

    void add(const MomentReport& one, double volume_mass) {
        cells_mass += one.mass_ratio * volume_mass;
        dropped_mass += one.dropped_mass_share * volume_mass;
        dropped_cells += one.dropped_cells;
        worst_error = std::max(worst_error, one.measured_error);
        for (const auto& [name, ms] : one.stage_ms) {
            const auto known = std::find_if(stage_ms.begin(), stage_ms.end(),
                                            [&](const auto& stage) { return stage.first == name; });
            if (known == stage_ms.end())
                stage_ms.emplace_back(name, ms);
            else
                known->second += ms;
        }
    }
    /// Of all of them as of one.
    MomentReport report(double data_mass) const {
        return {data_mass > 0 ? cells_mass / data_mass : 1,
                data_mass > 0 ? dropped_mass / data_mass : 0, dropped_cells, worst_error, stage_ms};
    }
};

/// What a conversion has made, as its report has it.
struct Converted {
    std::string method, options, summary;
    std::uint64_t gaussians = 0, source_voxels = 0;
    std::uint64_t nodes = 0, bytes = 0;  ///< of the hierarchy, of the file
    double mass = 0;
};
Converted converted(const Gaussians& model, const Hierarchy& hierarchy);

/// Prints what was made, unless JSON is asked for: which it returns.
nlohmann::ordered_json report(const ConvertArguments& arguments, FileKind kind,
                              const Converted& made, double volume_mass,
                              const MomentTotals& moments, const Stages& stages);

/// Several who convert together.
struct ConvertTogether {
    const Collective* collective = nullptr;  ///< processes that share the work; null: one
    bool writes = true;                      ///< false: another one writes and reports
    /// Loads, converts and writes volumes instead of vog convert's own way.
    std::function<nlohmann::ordered_json(const ConvertArguments&, const VolumeConversion&, Stages&)>
        volumes{};
    /// Of the inputs of a sequence, those that are this one's to convert, each by itself.
    std::function<std::vector<bool>(const std::vector<std::string>&)> mine{};
    /// The texts of all, on each of them.
    std::function<std::vector<std::string>(const std::string&)> gather{};
};
/// Adds the subcommand. returns it
CLI::App* add_convert(CLI::App& app, const std::shared_ptr<ConvertArguments>& arguments,
                      const ConvertTogether& others);

}  // namespace vog::cli
