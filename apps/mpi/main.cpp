// main.cpp: the vog-mpi command. Exit codes as vog's, the same on every rank; the first one speaks.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <new>

#include "commands.h"
#include "ranks.h"
#include "vog/error.h"

namespace {

using namespace vog::mpi;

/// Runs the command line of this rank. throws Ended where ranks have agreed on that
Failure run(CLI::App& app, const Ranks& ranks, int argc, char** argv) {
    try {
        app.parse(argc, argv);
        return {};
    } catch (const CLI::Success& asked) {  // --help, --version
        if (ranks.first()) app.exit(asked);
        return {};
    } catch (const CLI::ParseError& error) {
        return {2, error.what()};
    } catch (const std::bad_alloc&) {
        return {1, "out of memory"};
    } catch (const std::exception& error) {
        return {1, error.what()};
    }
}

}  // namespace

int main(int argc, char** argv) {
    const Ranks ranks(&argc, &argv);
    CLI::App app{
        "vog-mpi does what vog does, by many processes together: each keeps its part of the data.\n"
        "\n"
        "  mpirun -n 8 vog-mpi convert cloud.vdb -o cloud.ply --block 2\n"
        "  mpirun -n 8 vog-mpi render cloud.vdb -o cloud.png"};
    app.name("vog-mpi");
    app.set_version_flag("--version", std::string("vog-mpi ") + VOG_VERSION);
    app.require_subcommand(1);
    app.get_formatter()->column_width(34);
    add_convert(app, ranks);
    add_render(app, ranks);
    add_evaluate(app, ranks);

    try {
        ranks.agree(run(app, ranks, argc, argv));
        return 0;
    } catch (const Ended& end) {
        if (ranks.first())
            fmt::print(stderr, "vog-mpi: {}\n{}", end.failure.text,
                       end.failure.exit_code == 2 ? "Run with --help for usage.\n" : "");
        return end.failure.exit_code;
    }
}
