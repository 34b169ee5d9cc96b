// main.cpp: the vog command. Exit codes: 0 success, 1 failure (one line on standard error), 2 wrong
// usage.
#include <algorithm>
#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <vector>

#include "commands/commands.h"
#include "help/mistakes.h"
#include "help/version.h"
#include "options/parser/command_line.h"
#include "terminal/terminal.h"
#include "terminal/usage_error.h"

namespace {

/// Whether a word is rather meant as a file than as a command.
bool is_like_a_file(const std::string& word) {
    std::error_code code;
    return std::filesystem::exists(word, code) || word.find_first_of("./*?") != std::string::npos;
}

/// The first words: a command, files without one, or neither.
/// throws  UsageError for an unknown command
/// returns whether the words were files, which are shown now
bool look_at_files(const vog::cli::ProgramText& program, const std::vector<std::string>& words) {
    if (words.empty() || words.front().starts_with('-') ||
        std::ranges::count(program.commands, words.front(), &vog::cli::CommandText::name))
        return false;
    if (!is_like_a_file(words.front()))
        throw vog::cli::UsageError(vog::cli::unknown_command_text(program, words.front()));
    for (const std::string& word : words)
        if (word.starts_with('-'))
            throw vog::cli::UsageError("option " + word + " without a command, expected vog " +
                                       "info, render, convert, ... " + words.front() + " " + word);
    vog::cli::look_at(words);
    return true;
}

void run(CLI::App& app, int argc, char** argv) {
    std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
    if (words.empty() || words.front() == "help") {  // vog, vog help render
        if (!words.empty()) words.erase(words.begin());
        words.emplace_back("--help");
    }
    if (!look_at_files(vog::cli::program_text(app), words))
        vog::cli::print_text(vog::cli::run_command(app, words));
    vog::cli::finish_output();
}

}  // namespace

int main(int argc, char** argv) {
    vog::cli::prepare_process();
    CLI::App app{
        "vog converts sparse volumes and particles into 3D Gaussians, without training, and "
        "renders\nthem by exact line integration.   load -> convert -> render -> shade -> "
        "compare\n\nTerms of the options:\n  model       a sum of truncated 3D Gaussians that "
        "represents a density; a .ply or .vogz file\n  T           optical depth: the integral of "
        "density along a pixel's ray, times extinction\n  extinction  factor on density, per world "
        "unit; chosen for each picture\n  V           1 - exp(-T), in [0, 1): one minus "
        "transmittance. Transfer functions map V to colour\n  share       Gaussians divided by "
        "active voxels (or particles) of the input\n  cell        group of voxels that becomes one "
        "Gaussian; a cut is a choice of cells\n\n  vog sample cloud cloud.vdb\n  vog cloud.vdb     "
        "                       describes the file and suggests commands\n  vog convert cloud.vdb "
        "-o cloud.ply\n  vog render cloud.ply -o cloud.png --tf blue-white"};
    app.name("vog");
    vog::cli::set_help(app);
    app.set_version_flag("--version", vog::cli::version_text("vog"),
                         "Print version, commit and build type");
    app.require_subcommand(1);
    app.footer("vog COMMAND --help explains a command's common options, --help-all all of them.");
    vog::cli::add_sample(app);
    vog::cli::add_info(app);
    vog::cli::add_convert(app);
    vog::cli::add_render(app);
    vog::cli::add_compare(app);
    vog::cli::add_evaluate(app);
    vog::cli::add_view(app);
    vog::cli::add_page(app);
    vog::cli::add_pack(app);
    vog::cli::add_export(app);
    vog::cli::add_serve(app);
    vog::cli::add_voxelize(app);
    vog::cli::add_doctor(app);
    vog::cli::add_guides(app);

    try {
        run(app, argc, argv);
        return 0;
    } catch (const vog::cli::UsageError& error) {
        vog::cli::print_failure("vog", error.what(), 2);
        return 2;
    } catch (const std::bad_alloc&) {
        vog::cli::print_failure("vog", "out of memory");
    } catch (const std::exception& error) {
        vog::cli::print_failure("vog", vog::cli::with_remedy(vog::cli::failure_text(error)));
    }
    return 1;
}
