// evaluate.cpp: vog-mpi evaluate: the conversions whose model does not depend on the partition.
#include "commands/commands.h"

#include <fmt/core.h>

#include "commands/mpi_commands.h"
#include "inputs_part.h"
#include "vog/error.h"

namespace vog::mpi {

namespace {

/// Edge of the largest uniform cells that an evaluation makes, voxels.
constexpr int kAlign_voxels = 16;

/// The paper's conversions and the uniform cells. Adaptive cuts are left out: they choose cells by
/// the whole volume.
std::vector<Conversion> conversions(const Ranks& ranks) {
    std::vector<Conversion> rows;
    for (Conversion& row : paper_conversions()) {
        row.convert = [convert = row.convert](const Volume& volume, std::size_t budget) {
            return volume.empty() ? Gaussians{} : convert(volume, budget);
        };
        rows.push_back(std::move(row));
    }
    for (Conversion& row : moment_conversions()) {
        if (row.series != "uniform") continue;
        const int lod = row.step == "block2"   ? 1
                        : row.step == "block4" ? 2
                        : row.step == "block8" ? 3
                                               : 4;
        row.convert = [lod, collective = &ranks.collective()](const Volume& volume, std::size_t) {
            MomentOptions options = moment_lod(lod);
            options.collective = collective;
            return convert_moments(volume, options);
        };
        row.moments = {};  // uniform cells follow no field
        rows.push_back(std::move(row));
    }
    return rows;
}

cli::LoadedVolumes load_part(const cli::EvaluateArguments& arguments, const Ranks& ranks) {
    VolumesPart part = read_volumes_part(arguments.inputs, arguments.volume, ranks, kAlign_voxels);
    if (part.is_mesh())
        throw Error(
            "levels of a mesh hide each other, which a distributed evaluation does not support; "
            "expected one process (vog evaluate), or --combine sum");
    if (part.by_files)
        throw Error(
            fmt::format("{} files for {} ranks: an evaluation divides every file among all ranks; "
                        "expected fewer than 4 files per rank",
                        part.volumes, ranks.count()));
    cli::LoadedVolumes loaded;
    loaded.volumes = std::move(part.sets.front().volumes);
    return loaded;
}

}  // namespace

void add_evaluate(CLI::App& app, const Ranks& ranks) {
    auto arguments = std::make_shared<cli::EvaluateArguments>();
    arguments->threads = ranks.threads_per_rank();
    arguments->options.conversions = conversions(ranks);
    cli::add_evaluate(app, arguments,
                      {&ranks.collective(), [&ranks](const cli::EvaluateArguments& given) {
                           return load_part(given, ranks);
                       }});
}

}  // namespace vog::mpi
