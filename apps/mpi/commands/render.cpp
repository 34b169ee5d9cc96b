// render.cpp: vog-mpi render: sort-last parallel rendering without an order: every rank renders its
// part, the images of T (or slabs of light, or moments of a field) are summed, and the root shades. A
// sequence is divided by pictures instead.
#include <memory>

#include "commands/commands.h"
#include "commands/mpi_commands.h"
#include "inputs_part.h"
#include "rank_files.h"

namespace vog::mpi {

void add_render(CLI::App& app, const Ranks& ranks) {
    auto arguments = std::make_shared<cli::RenderArguments>();
    arguments->threads = ranks.threads_per_rank();
    cli::RenderRanks hooks;
    hooks.load_points = [&ranks](const cli::DrawingArguments& drawing,
                                 std::vector<std::string>& notes) {
        return read_particles_part(drawing.inputs, drawing.points, drawing.volume, ranks, notes);
    };
    hooks.load_models = [&ranks](const std::vector<std::string>& files, const ValueRules& rules) {
        return read_models_part(files, ranks, rules);
    };
    hooks.load_volumes = [&ranks](const cli::DrawingArguments& drawing,
                                  const cli::VolumeInputOptions& options, bool beside) {
        return read_divided_volumes(drawing.inputs, options, beside, ranks);
    };
    hooks.collective = ranks.collective();
    hooks.is_root = ranks.first();
    // Pictures of a sequence: each is rendered by one rank alone.
    hooks.assigned = [&ranks](const std::vector<std::string>& files) {
        return whole_files_of(files, ranks);
    };
    hooks.allgather = [&ranks](const std::string& text) { return ranks.gather(text); };
    cli::add_render(app, arguments, hooks);
}

}  // namespace vog::mpi
