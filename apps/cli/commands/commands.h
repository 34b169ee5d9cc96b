// commands.h: subcommands of vog; each function adds one with its options and help.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "pictures/render_run.h"
#include "shared/convert_run.h"
#include "shared/evaluate_run.h"

namespace vog::cli {

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
