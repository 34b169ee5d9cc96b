// main.cpp: the vog command. Exit codes: 0 success, 1 failure (one line on standard error), 2 wrong
// usage.
#include <algorithm>
#include <CLI/CLI.hpp>
#include <exception>
#include <new>
#include <sstream>
#include <string>

#include "commands.h"
#include "shared/terminal.h"

namespace {

void run(CLI::App& app, int argc, char** argv) {
    // CLI11 would report a missing subcommand, not the unknown one.
    const auto commands = app.get_subcommands([](const CLI::App*) { return true; });
    if (argc > 1 && argv[1][0] != '-' &&
        std::none_of(commands.begin(), commands.end(),
                     [&](const CLI::App* command) { return command->get_name() == argv[1]; }))
        throw CLI::ValidationError(std::string("no subcommand '") + argv[1] + "'");
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& text) {
        std::ostringstream out;
        app.exit(text, out, out);  // --help, --version
        vog::cli::print_text(out.str());
    }
    vog::cli::finish_output();
}

}  // namespace

int main(int argc, char** argv) {
    vog::cli::prepare_process();
    CLI::App app{
        "vog converts sparse volumes and particles into 3D Gaussians, without training, and "
        "renders\n"
        "them by exact line integration.   load -> convert -> render -> shade -> compare\n\n"
        "Terms of the options:\n"
        "  model       a sum of truncated 3D Gaussians that stands for a density, in a PLY file\n"
        "  T           optical depth: the integral of density along a pixel's ray, times "
        "extinction\n"
        "  extinction  factor on density, per world unit; chosen when a picture is rendered\n"
        "  V           1 - exp(-T), in [0, 1): one minus transmittance. Transfer functions map V "
        "to colour\n"
        "  share       Gaussians divided by active voxels (or particles) of the input\n"
        "  cell        group of voxels that becomes one Gaussian; a cut is a choice of cells\n\n"
        "  vog sample cloud cloud.vdb\n"
        "  vog convert cloud.vdb -o cloud.ply\n"
        "  vog render cloud.ply -o cloud.png --tf blue-white"};
    app.name("vog");
    app.set_version_flag("--version", std::string("vog ") + VOG_VERSION);
    app.require_subcommand(1);
    app.get_formatter()->column_width(34);
    vog::cli::add_sample(app);
    vog::cli::add_info(app);
    vog::cli::add_convert(app);
    vog::cli::add_render(app);
    vog::cli::add_compare(app);
    vog::cli::add_evaluate(app);
    vog::cli::add_view(app);
    vog::cli::add_export(app);
    vog::cli::add_voxelize(app);

    try {
        run(app, argc, argv);
        return 0;
    } catch (const CLI::ParseError& error) {
        vog::cli::print_failure("vog", error.what(), 2);
        return 2;
    } catch (const std::bad_alloc&) {
        vog::cli::print_failure("vog", "out of memory");
    } catch (const std::exception& error) {
        vog::cli::print_failure("vog", vog::cli::failure_text(error));
    }
    return 1;
}
