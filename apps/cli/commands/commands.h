// commands.h: subcommands of vog; each function adds one with its options and help.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "conversion/convert_run.h"
#include "files/inputs.h"
#include "pictures/render_run.h"
#include "vog/evaluate.h"

namespace vog::cli {

/// Arguments of an evaluation.
struct EvaluateArguments {
    std::vector<std::string> inputs;
    std::vector<std::string> models;  ///< taken out of the inputs
    std::vector<std::string> fields;  ///< texts of --field
    std::vector<std::string> tfs;     ///< texts of --tf
    std::string show = "T";
    std::string folder, size = "512x512", extinction = "auto";
    VolumeInputOptions volume;
    EvaluateOptions options;
    int threads = 0;
    bool json = false, verbose = false;
};

/// Hooks for an evaluation by several MPI ranks; the defaults are a single process.
struct EvaluateRanks {
    const Collective* collective = nullptr;  ///< reductions over the ranks; null: one process
    /// Reads this rank's part of volumes whose densities add up. Empty: the whole inputs are read.
    std::function<LoadedVolumes(const EvaluateArguments&)> load{};
};

void add_sample(CLI::App& app);
void add_info(CLI::App& app);
void add_convert(CLI::App& app);
void add_render(CLI::App& app);
void add_compare(CLI::App& app);
void add_evaluate(CLI::App& app);
void add_view(CLI::App& app);
void add_page(CLI::App& app);
void add_pack(CLI::App& app);
void add_export(CLI::App& app);
void add_serve(CLI::App& app);
void add_voxelize(CLI::App& app);
void add_doctor(CLI::App& app);
/// Adds completion and man, which print what the other commands of the program say of themselves.
void add_guides(CLI::App& app);

// Those of vog-mpi, too.
/// returns  the command, for further options
CLI::App* add_convert(CLI::App& app, const std::shared_ptr<ConvertArguments>& arguments,
                      const ConvertRanks& ranks);
void add_render(CLI::App& app, const std::shared_ptr<RenderArguments>& arguments,
                const RenderRanks& ranks);
void add_evaluate(CLI::App& app, const std::shared_ptr<EvaluateArguments>& arguments,
                  const EvaluateRanks& ranks);

/// Adds the options of `vog render`.
void add_render_options(CLI::App& command, RenderArguments& arguments);

/// Prints the contents of files and command lines to try on them: vog FILE...
/// throws  vog::Error for files that do not exist or cannot be read
void look_at(const std::vector<std::string>& files);

}  // namespace vog::cli
