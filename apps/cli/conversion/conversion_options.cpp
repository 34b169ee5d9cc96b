// conversion_options.cpp: help and checks of both methods' options.
#include "conversion/conversion_options.h"

#include <fmt/core.h>

#include <CLI/CLI.hpp>

#include "options/parser/settings.h"
#include "options/parser/validators.h"
#include "vog/distributed.h"

namespace vog::cli {

namespace {

constexpr const char* kPaperGroup = "Conversion of the paper (--method paper)";

}  // namespace

PaperOptions paper_options(const ConvertArguments& arguments) {
    PaperOptions options = arguments.paper;
    if (arguments.lod) {
        const PaperOptions lod = paper_lod(arguments.lod);
        options.strategy = lod.strategy;
        options.dense_block = lod.dense_block;
    } else if (!arguments.strategy.empty()) {
        options.strategy = strategy_from_name(arguments.strategy);
    }
    options.amplitude = arguments.amplitude == "mass" ? Amplitude::mass : Amplitude::mean;
    return options;
}

std::string cut_option(const GivenOptions& command) {
    for (const char* option : {"--block", "--budget", "--error", "--lod"})
        if (command.has(option)) return option;
    return {};
}

MomentOptions moment_options(const ConvertArguments& arguments) {
    MomentOptions options = arguments.moments;
    if (options.budget && arguments.inputs.size() > 1 && arguments.volume.sum)
        throw UsageError(
            "--budget is the size of one model: expected one input, or levels of one mesh");
    if (arguments.lod) options.block_voxels = moment_lod(arguments.lod).block_voxels;
    return options;
}

Facts conversion_facts(const ConvertArguments& arguments, const GivenOptions& command,
                       FileKind kind) {
    const std::string cut = cut_option(command);
    const std::string of_lod = arguments.lod > 4   ? "single"
                               : arguments.lod > 3 ? "strict"
                                                   : "smart";
    Facts facts = {{"input", input_fact(kind, arguments.inputs)},
                   {"cut", cut.empty() ? "-" : cut},
                   {"strategy", arguments.strategy.empty() ? of_lod : arguments.strategy}};
    if (kind != FileKind::points) return facts;
    facts["particles by"] = arguments.method;
    facts["particles cut"] = facts["cut"];
    return facts;
}

void add_paper_options(CLI::App& command, ConvertArguments& arguments) {
    const OptionGroup grouped(command, kPaperGroup);
    PaperOptions& paper = arguments.paper;
    command.add_option(
        setting("strategy"), arguments.strategy,
        "Grouping of voxels. For sparse leaves (8^3 nodes with inactive voxels): smart (2^3 "
        "blocks, pairs, single voxels; the default), strict (2^3 blocks, single voxels), "
        "single "
        "(one Gaussian per leaf). For all leaves: variance (split until values are uniform), "
        "neighbours (similar adjacent leaves joined), tree (one Gaussian per tree node)");
    command
        .add_option(setting("dense-block"), paper.dense_block,
                    "Edge of a block in dense leaves (all 8^3 voxels active), voxels")
        ->check(CLI::IsMember({2, 4, 8}))
        ->capture_default_str();
    command
        .add_option(
            setting("amplitude"), arguments.amplitude,
            "Peak density of a Gaussian: mean, the mean density of its voxels, as the paper (loses "
            "about a third of the mass); mass, the peak that conserves mass")
        ->check(CLI::IsMember({"mean", "mass"}))
        ->capture_default_str();
    command
        .add_option(setting("kappa"), paper.kappa,
                    "Truncate kernels where they have fallen to this fraction of their peak: at "
                    "sqrt(-2 ln kappa) standard deviations")
        ->check(CLI::Range(1e-12, 0.999))
        ->capture_default_str();
    command
        .add_option(setting("opacity-threshold"), paper.opacity_threshold,
                    "Drop groups of voxels whose mean density is at or below this; 0 drops empty "
                    "groups only")
        ->check(non_negative_number())
        ->capture_default_str();
    command
        .add_option(setting("variance-threshold"), paper.variance_threshold,
                    "--set strategy=variance: split groups whose variance of values exceeds this "
                    "fraction of the volume's")
        ->check(non_negative_number())
        ->capture_default_str();
    command
        .add_option(
            setting("similarity"), paper.similarity,
            "--set strategy=neighbours: join leaves whose mean densities differ by at most this "
            "fraction")
        ->check(CLI::Range(0.0, 1.0))
        ->capture_default_str();
    command
        .add_option(
            setting("tree-depth"), paper.tree_depth,
            "--set strategy=tree: level of the nodes, 1 (4096^3 voxels), 2 (128^3) or 3 (8^3)")
        ->check(CLI::Range(1, 3))
        ->capture_default_str();
    command
        .add_option(setting("minimum-radius"), paper.minimum_radius_voxels,
                    "Smallest radius of a Gaussian, voxels; a single voxel has 0.5")
        ->check(positive_number())
        ->capture_default_str();
}

void add_moment_options(CLI::App& command, ConvertArguments& arguments) {
    const OptionGroup grouped(command, kMomentGroup);
    MomentOptions& moments = arguments.moments;
    const auto add = [&](const std::string& name, auto& value, const std::string& text) {
        return command.add_option(name, value, text);
    };
    add("--error", moments.error,
        fmt::format(
            "Find the smallest model with at most this error: relative L2 of optical depth T "
            "against the voxels, in the worst of {} views. The search ends where voxels "
            "interpolated linearly have the same error. Default for volumes: {}, but at most one "
            "Gaussian to {} voxels ({} of small data). With --for: of volume pictures under "
            "three transfer functions. Particles become one Gaussian each unless --error, "
            "--budget, --block or --lod is given",
            error_views(Box{}).size(), kDefaultError, kVoxelsPerGaussian, kSmallCount))
        ->check(CLI::Range(1e-9, 0.999999));
    add("--budget", moments.budget, "Find the best model with at most this many Gaussians")
        ->check(positive_number());
    add("--block", moments.block_voxels,
        "One Gaussian per occupied cube of this edge, voxels: uniform cells")
        ->check(CLI::IsMember({1, 2, 4, 8, 16, 32, 64, 128}));
    add(setting("soft-steps"), moments.soft_steps,
        fmt::format(
            "Steps of expectation-maximisation (EM) from hard cells, where a voxel counts for "
            "one Gaussian, to soft cells, where it is divided among several. 0: hard "
            "cells, fast, but uniform ones show a grid of dots along the axes. Default: {} "
            "for --budget, {} for --error. Uniform cells overlap by half a cell; above 2 "
            "voxels up to {} steps follow, fewer for more than 4 million voxels. vog-mpi: "
            "uniform cells are hard",
            kSoftSteps, kSearchSoftSteps, kSoftSteps))
        ->check(CLI::Range(0, 1000));
    add("--refine", moments.refine_seconds,
        "Refine for up to this many seconds: Gaussians are split where pictures have the largest "
        "error, with --for volume pictures, and as many merged elsewhere. The result depends on "
        "the machine's speed")
        ->check(CLI::Range(0.0, 1e6));
    add(setting("spread"), moments.spread, "Factor on every standard deviation, at constant mass")
        ->check(CLI::Range(0.5, 2.0))
        ->capture_default_str();
    add(setting("mass-threshold"), moments.mass_threshold,
        "Drop the cells of least mass, up to this fraction of the total mass")
        ->check(CLI::Range(0.0, 0.999))
        ->capture_default_str();
    add(setting("axis-aligned"), moments.axis_aligned,
        "1: Gaussians without rotation, of 28 bytes each in the file in place of 44")
        ->check(CLI::IsMember({"0", "1"}));
    add(setting("measure-error"), moments.measure,
        "1: measure the error also with --budget, --block and --lod")
        ->check(CLI::IsMember({"0", "1"}));
}

}  // namespace vog::cli
