// sample.cpp: vog sample: procedural test data, the same bytes every time.
#include "vog/sample.h"

#include <fmt/core.h>

#include "commands/commands.h"
#include "files/inputs.h"
#include "files/outputs.h"
#include "options/option_effects.h"
#include "options/parser/settings.h"
#include "options/parser/validators.h"
#include "terminal/terminal.h"
#include "vog/volume_io.h"

namespace vog::cli {

namespace {

struct SampleArguments {
    std::string kind, output;
    SampleOptions options;
    int size = 0;  // 0: the sample's default
    int threads = 0;
    bool half = false, verbose = false;
};

void sample_points(const SampleArguments& arguments) {
    check_output(arguments.output, {}, {".xyz", ".csv", ".tsv", ".vdb"});
    const ThreadLimit limit(arguments.threads);
    Stages stages(arguments.verbose);
    ParticleSampleOptions options;
    options.seed = arguments.options.seed;
    options.progress = stages.progress();
    if (arguments.size) options.size = arguments.size;
    const Points points = stages.run("sample", [&] { return sample_particles(options); });
    stages.run("write", [&] { write_points(arguments.output, points); });
    print_line(fmt::format("{}: {} particles", arguments.output, count_text(points.size())));
}

void sample(const SampleArguments& arguments) {
    if (arguments.kind == "particles") return sample_points(arguments);
    check_output(arguments.output, {}, {".vdb"});
    const ThreadLimit limit(arguments.threads);
    Stages stages(arguments.verbose);
    SampleOptions options = arguments.options;
    options.progress = stages.progress();
    if (arguments.size) options.size = arguments.size;
    if (options.size < 64 || options.size > 1024)
        throw UsageError(fmt::format("--size {}: expected 64 to 1024", options.size));
    const std::vector<Volume> volumes = stages.run("sample", [&]() -> std::vector<Volume> {
        if (arguments.kind == "amr") return sample_levels(options);
        if (arguments.kind == "fire") return sample_fire(options);
        if (arguments.kind == "head") return {sample_head(options)};
        return {arguments.kind == "cloud" ? sample_cloud(options) : sample_explosion(options)};
    });
    stages.run("write", [&] { write_vdb(arguments.output, volumes, arguments.half); });
    for (const Volume& volume : volumes)
        print_line(fmt::format("{}: {}, {} active voxels in {} leaves and {} tiles",
                               arguments.output, volumes.size() > 1 ? volume.name : arguments.kind,
                               count_text(active_voxels(volume)), count_text(volume.leaves.size()),
                               count_text(volume.tiles.size())));
}

}  // namespace

void add_sample(CLI::App& app) {
    auto arguments = std::make_shared<SampleArguments>();
    CLI::App* command = app.add_subcommand(
        "sample", "Generate procedural test data with the same bytes every time");
    add_value(*command, "what", arguments->kind, "cloud explosion fire head amr particles",
              "cloud: a cumulus cloud with soft edges and a constant core; explosion: a turbulent, "
              "hollow fireball; fire: the same with its temperature in K as a second grid; head: a "
              "CT of a head, grid ct, Hounsfield units + 1000, mm; amr: halos and filaments on "
              "three nested levels of an adaptive mesh, one grid each; particles: a box of a "
              "cosmological simulation, with velocities")
        ->required();
    command
        ->add_option("output", arguments->output,
                     "OpenVDB file to write (.vdb); particles also as .xyz, .csv or .tsv")
        ->required();
    add_value(*command, "--size", arguments->size, "[8, 1024]",
              fmt::format("Voxels along an edge, 64 to 1024 (default {}); amr: of the finest "
                          "level; particles: the cube root of their number, 8 to 512 (default {})",
                          SampleOptions{}.size, ParticleSampleOptions{}.size));
    add_value(*command, setting("seed"), arguments->options.seed, "",
              "Seed of the random numbers; other seeds give other shapes");
    command->add_flag("--half", arguments->half,
                      "Store voxel values as 16-bit floats; not for particles");
    add_threads_option(*command, arguments->threads);
    command->add_flag("--verbose,-v", arguments->verbose,
                      "Print the time of each stage to standard error");
    on_run(*command, [arguments](GivenOptions& given) {
        require_effects(given, {{"input", arguments->kind}});
        sample(*arguments);
    });
}

}  // namespace vog::cli
