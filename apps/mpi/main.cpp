// main.cpp: the vog-mpi command. Exit codes are those of vog, equal on every rank; the root prints.
#include <algorithm>
#include <cstdlib>
#include <new>
#include <string>

#include "commands/mpi_commands.h"
#include "help/mistakes.h"
#include "help/version.h"
#include "options/parser/command_line.h"
#include "ranks.h"
#include "terminal/terminal.h"
#include "terminal/usage_error.h"

namespace {

using namespace vog::mpi;

/// Parses and runs the command on this rank.
/// throws  Ended after a failure that all ranks know of already
Failure run(CLI::App& app, const Ranks& ranks, int argc, char** argv) {
    try {
        const std::string help =
            vog::cli::run_command(app, {argv + std::min(argc, 1), argv + argc});
        if (ranks.first()) vog::cli::print_text(help);
        vog::cli::finish_output();
        return {};
    } catch (const vog::cli::UsageError& error) {
        return {2, error.what()};
    } catch (const std::bad_alloc&) {
        return {1, "out of memory"};
    } catch (const std::exception& error) {
        return {1, vog::cli::with_remedy(vog::cli::failure_text(error))};
    }
}

}  // namespace

int main(int argc, char** argv) {
    vog::cli::prepare_process();
    const Ranks ranks(&argc, &argv);
    CLI::App app{
        "vog-mpi runs vog's convert, page (sites), render and evaluate on several processes\n"
        "(MPI ranks), each of which reads and holds one part of the data.\n"
        "\n"
        "  mpirun -n 8 vog-mpi convert cloud.vdb -o cloud.ply --block 2\n"
        "  mpirun -n 8 vog-mpi page cloud.vdb -o site/ --block 2\n"
        "  mpirun -n 8 vog-mpi render cloud.vdb -o cloud.png"};
    app.name("vog-mpi");
    vog::cli::set_help(app);
    app.set_version_flag("--version", vog::cli::version_text("vog-mpi"));
    app.require_subcommand(1);
    add_convert(app, ranks);
    add_page(app, ranks);
    add_render(app, ranks);
    add_evaluate(app, ranks);

    try {
        ranks.agree(run(app, ranks, argc, argv));
        return 0;
    } catch (const Ended& end) {
        if (ranks.first())
            vog::cli::print_failure("vog-mpi", end.failure.text, end.failure.exit_code);
        return end.failure.exit_code;
    }
}
