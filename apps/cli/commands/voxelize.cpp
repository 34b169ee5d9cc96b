// voxelize.cpp: vog voxelize: models -> averages over the voxels of a lattice -> .vdb or .nvdb.
#include "vog/voxelize.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "commands/commands.h"
#include "files/inputs.h"
#include "files/outputs.h"
#include "files/sequence.h"
#include "options/memory_options.h"
#include "options/option_effects.h"
#include "options/parser/validators.h"
#include "terminal/terminal.h"
#include "vog/error.h"
#include "vog/units.h"
#include "vog/volume_io.h"

namespace vog::cli {

namespace {

using Json = nlohmann::ordered_json;

struct VoxelizeArguments {
    std::vector<std::string> inputs;
    std::string output, like, grid, name = "density";
    double voxel_size = 0;
    ValueRules values{};
    bool fields = false, within = false, json = false, verbose = false;
    int threads = 0;
    MemoryArguments memory;
};

/// Lattice of the result, and with --within its extent.
/// throws  vog::Error for a voxel size out of range, and as read_volume does for --like
Affine lattice_of(const VoxelizeArguments& arguments, const Gaussians& model,
                  VoxelizeOptions& options) {
    if (arguments.like.empty()) return voxel_lattice(model, arguments.voxel_size);
    // Values do not matter: grids of any sign, level sets and masks have a lattice too.
    VolumeInputOptions rules;
    rules.grid = arguments.grid;
    rules.ones = rules.refuse_several = true;
    const LoadedVolumes like = load_volumes({arguments.like}, rules);
    require_same_length(model.content.units.length, model.source, like.volumes.front().units.length,
                        arguments.like);
    return lattice_like(like.volumes, arguments.within ? &options.extent : nullptr);
}

void check_arguments(const VoxelizeArguments& arguments, const GivenOptions& command) {
    require_effects(command, {{"input", input_fact(FileKind::model, arguments.inputs)},
                              {"output", extension_of(arguments.output)}});
    if (!command.has("--voxel-size") && arguments.like.empty())
        throw UsageError("choose the voxels: --voxel-size X or --like FILE");
    if (arguments.name.empty()) throw UsageError("--name is empty; expected the name of a grid");
    std::vector<std::string> read = arguments.inputs;
    read.push_back(arguments.like);
    check_output(arguments.output, read, {".vdb", ".nvdb"});
    for (const std::string& input : arguments.inputs)
        if (kind_of(input) != FileKind::model)
            throw Error(
                fmt::format("{}: not a model; expected a .ply file from vog convert", input));
    if (!arguments.like.empty() && kind_of(arguments.like, arguments.grid) != FileKind::volume)
        throw Error(fmt::format("{}: not a volume; --like needs a .vdb or .nvdb", arguments.like));
}

void run_voxelize(VoxelizeArguments arguments, const GivenOptions& command) {
    arguments.inputs = expanded(arguments.inputs);
    check_arguments(arguments, command);
    const ThreadLimit limit(arguments.threads);
    const CommandMemory memory(arguments.memory);
    Stages stages(arguments.verbose);
    const Gaussians model = stages.run(
        "load", [&] { return load_models(arguments.inputs, nullptr, {}, arguments.values); });
    VoxelizeOptions options;
    options.name = arguments.name;
    options.fields = arguments.fields;
    const Affine lattice =
        stages.run("lattice", [&] { return lattice_of(arguments, model, options); });
    const Voxelized made = stages.run("voxelize", [&] {
        options.progress = stages.progress();
        return voxelize(model, lattice, options);
    });
    stages.run("save", [&] { write_voxels(arguments.output, made.volume, made.fields); });

    const std::uint64_t voxels = active_voxels(made.volume);
    const double outside = 1 - made.voxel_mass / made.mass;
    std::vector<std::string> names{made.volume.name};
    for (const VoxelField& field : made.fields) names.push_back(field.name);
    std::error_code code;
    const std::uintmax_t bytes =
        std::filesystem::file_size(arguments.output, code);  // of a device: unknown
    if (!arguments.json) {
        std::string text = fmt::format("{}: {} Gaussians to {} voxels in {} leaves",
                                       arguments.output, count_text(model.size()),
                                       count_text(voxels), count_text(made.volume.leaves.size()));
        if (names.size() > 1) text += fmt::format(", {} grids", names.size());
        if (!code) text += ", " + bytes_text(bytes);
        print_line(text);
        print_line(fmt::format("mass {:.6g} of {:.6g}{}", made.voxel_mass, made.mass,
                               arguments.within
                                   ? fmt::format(", {:.3g} % outside of {}",
                                                 100 * std::max(0.0, outside), arguments.like)
                                   : ""));
        return;
    }
    Json json = {{"output", arguments.output},
                 {"gaussians", model.size()},
                 {"voxels", voxels},
                 {"leaves", made.volume.leaves.size()},
                 {"grids", names},
                 {"mass", made.mass},
                 {"voxel_mass", made.voxel_mass}};
    if (!code) json["bytes"] = bytes;
    for (const auto& [name, ms] : stages.times()) json["ms"][name] = ms;
    json["peak_bytes"] = peak_memory();
    print_json(json);
}

}  // namespace

void add_voxelize(CLI::App& app) {
    auto arguments = std::make_shared<VoxelizeArguments>();
    CLI::App* command = app.add_subcommand(
        "voxelize",
        "Turn models back into a volume of the same mass: averages of their Gaussians over voxels");
    command->add_option("inputs", arguments->inputs, "Models (.ply, .json); several are added up")
        ->required();
    command
        ->add_option("-o,--output", arguments->output,
                     "Volume to write: OpenVDB (.vdb) or NanoVDB (.nvdb)")
        ->required();
    command->add_option("--voxel-size", arguments->voxel_size,
                        "Edge of cubic voxels along the world's axes, world units");
    command->add_option("--like", arguments->like,
                        "Use the lattice of this volume: voxel size, rotation, skew and alignment. "
                        "Of several levels (--grid 'density_L*'), the finest");
    command->add_option("--grid", arguments->grid,
                        "Grid of --like, or a pattern of levels; default: the only scalar grid, "
                        "else density, else all levels");
    command->add_flag("--within", arguments->within,
                      "Write only voxels in the box around --like's active voxels, and report the "
                      "share of mass outside");
    command->add_flag(
        "--fields", arguments->fields,
        "Also write the model's fields, one grid each: density-weighted means over a voxel");
    command->add_flag("--skip-nonfinite", arguments->values.skip_nonfinite,
                      "Leave out splats with NaN or infinite numbers and report their number; "
                      "otherwise they are an error");
    add_value(*command, "--name", arguments->name, "", "Name of the density grid");
    add_memory_options(*command, arguments->memory, "; a .vdb only");
    add_run_options(*command, arguments->threads, arguments->json, arguments->verbose);
    on_run(*command, [arguments](GivenOptions& given) { run_voxelize(*arguments, given); });
}

}  // namespace vog::cli
