// convert.cpp: vog-mpi convert: volumes to one model, or one file a rank.
#include "commands/commands.h"
#include "commands/mpi_commands.h"
#include "conversion/volume_conversion.h"
#include "model_file.h"
#include "rank_files.h"

namespace vog::mpi {

using cli::ConvertArguments;
using cli::VolumeConversion;

namespace {

nlohmann::ordered_json convert_volumes(const ConvertArguments& arguments,
                                       const VolumeConversion& given, cli::Stages& stages,
                                       bool split, const Ranks& ranks) {
    const ConvertedVolumes volumes = convert_parts(arguments, given, stages, ranks);
    if (ranks.first() && !arguments.no_hierarchy)
        cli::note("no hierarchy is written: parts of a model have none (as --no-hierarchy)");
    cli::Converted made = stages.run("save", [&] {
        return split ? write_split(arguments.output, volumes.model, ranks)
                     : write_model(arguments.output, volumes.model, ranks);
    });
    if (!ranks.first()) return {};
    made.notes = volumes.notes;
    return cli::report(arguments, cli::FileKind::volume, made, volumes.data_mass, volumes.totals,
                       stages);
}

}  // namespace

void add_convert(CLI::App& app, const Ranks& ranks) {
    auto arguments = std::make_shared<ConvertArguments>();
    arguments->threads = ranks.threads_per_rank();
    auto split = std::make_shared<bool>(false);
    cli::ConvertRanks hooks;
    hooks.collective = &ranks.collective();
    hooks.is_root = ranks.first();
    hooks.convert_volumes = [split, &ranks](const ConvertArguments& given,
                                            const VolumeConversion& conversion,
                                            cli::Stages& stages) {
        return convert_volumes(given, conversion, stages, *split, ranks);
    };
    hooks.assigned = [&ranks](const std::vector<std::string>& files) {
        return whole_files_of(files, ranks);
    };
    hooks.allgather = [&ranks](const std::string& text) { return ranks.gather(text); };
    CLI::App* command = cli::add_convert(app, arguments, hooks);
    command->add_flag(
        "--split", *split,
        "Write one PLY per rank instead of one file (volumes only): -o model.ply gives "
        "model.0.ply, model.1.ply, ... and the index model.json, which names them");
}

}  // namespace vog::mpi
