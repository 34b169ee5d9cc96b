// main.cpp: the vog-mpi command. Exit codes are those of vog, equal on every rank; the root prints.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <new>

#include "commands.h"
#include "ranks.h"
#include "vog/error.h"

namespace {

using namespace vog::mpi;

/// Parses and runs the command on this rank.
/// throws  Ended after a failure that all ranks know of already
Failure run(CLI::App& app, const Ranks& ranks, int argc, char** argv) {
    try {
        app.parse(argc, argv);
        return {};
    } catch (const CLI::Success& text) {  // --help, --version
        if (ranks.first()) app.exit(text);
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
        "vog-mpi runs vog's convert, render and evaluate on several processes (MPI ranks), each "
        "of\n"
        "which reads and holds one part of the data.\n"
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
