// main.cpp: the vog command. Exit codes: 0 done, 1 failed (one line on standard error), 2 wrong
// usage.
#include <fmt/core.h>

#include <algorithm>
#include <CLI/CLI.hpp>
#include <new>

#include "commands.h"
#include "vog/error.h"

int main(int argc, char** argv) {
    CLI::App app{
        "vog turns sparse volumes into 3D Gaussians, without training, and renders them by exact "
        "line\n"
        "integration.   load -> convert -> render -> shade -> compare\n\n"
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

    try {
        // CLI11 alone would only say that a subcommand is missing.
        const auto commands = app.get_subcommands([](const CLI::App*) { return true; });
        if (argc > 1 && argv[1][0] != '-' &&
            std::none_of(commands.begin(), commands.end(),
                         [&](const CLI::App* command) { return command->get_name() == argv[1]; }))
            throw CLI::ValidationError(std::string("no subcommand '") + argv[1] + "'");
        app.parse(argc, argv);
        return 0;
    } catch (const CLI::Success& asked) {
        return app.exit(asked);  // --help, --version
    } catch (const CLI::ParseError& error) {
        fmt::print(stderr, "vog: {}\nRun with --help for usage.\n", error.what());
        return 2;
    } catch (const std::bad_alloc&) {
        fmt::print(stderr, "vog: out of memory\n");
    } catch (const std::exception& error) {
        fmt::print(stderr, "vog: {}\n", error.what());
    }
    return 1;
}
