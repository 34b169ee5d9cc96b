// conversion_options.cpp: the options of both methods.
#include "options/conversion_options.h"

#include <fmt/core.h>

namespace vog::cli {

namespace {

constexpr const char* kMomentGroup = "Conversion by moments (--method moments)";
constexpr const char* kPaperGroup = "The paper's conversion (--method paper)";

}  // namespace

PaperOptions paper_options(const ConvertArguments& arguments, const CLI::App& command) {
    PaperOptions options = arguments.paper;
    if (arguments.lod) {
        for (const char* option : {"--strategy", "--dense-block"})
            if (command.count(option))
                throw CLI::ValidationError(fmt::format("--lod and {} exclude each other", option));
        const PaperOptions lod = paper_lod(arguments.lod);
        options.strategy = lod.strategy;
        options.dense_block = lod.dense_block;
    } else if (!arguments.strategy.empty()) {
        options.strategy = strategy_from_name(arguments.strategy);
    }
    options.amplitude = arguments.amplitude == "mass" ? Amplitude::mass : Amplitude::mean;
    return options;
}

std::string cut_option(const CLI::App& command) {
    std::string cut;
    for (const char* option : {"--block", "--budget", "--error", "--lod"}) {
        if (!command.count(option)) continue;
        if (!cut.empty())
            throw CLI::ValidationError(fmt::format("{} and {} exclude each other", cut, option));
        cut = option;
    }
    return cut;
}

MomentOptions moment_options(const ConvertArguments& arguments, const CLI::App& command) {
    MomentOptions options = arguments.moments;
    cut_option(command);
    if (options.budget && arguments.inputs.size() > 1 && arguments.volume.no_mask)
        throw CLI::ValidationError(
            "--budget takes one input or levels: it is the size of one model");
    if (arguments.lod) options.block_voxels = moment_lod(arguments.lod).block_voxels;
    return options;
}

void check_options(const ConvertArguments& arguments, const CLI::App& command, FileKind kind) {
    const bool particles = kind == FileKind::points;
    if (!particles) refuse_group(command, kPointGroup, "volumes");
    refuse_group(command, arguments.method == "paper" ? kMomentGroup : kPaperGroup,
                 "--method " + arguments.method);
    if (!particles) return;
    for (const CLI::Option* option : command.get_options())
        if (option->count() && option->get_group() == kPaperGroup &&
            option->get_name() != "--kappa")
            throw CLI::ValidationError(option->get_name() + " does not go with particles");
    for (const char* option :
         {"--spread", "--soft-steps", "--refine", "--level-set-to-fog", "--mask", "--no-mask"})
        if (command.count(option))
            throw CLI::ValidationError(fmt::format("{} does not go with particles", option));
    if (arguments.method == "paper" && arguments.lod)
        throw CLI::ValidationError("--lod does not go with the paper's particles");
}

void add_paper_options(CLI::App& command, ConvertArguments& arguments) {
    const auto group = kPaperGroup;
    PaperOptions& paper = arguments.paper;
    command
        .add_option(
            "--strategy", arguments.strategy,
            "Sparse leaves: smart (2^3 blocks, pairs, singles; the default), strict (2^3 blocks, "
            "singles), single (one Gaussian a leaf). All leaves: variance (split until even), "
            "neighbours (similar leaves joined), tree (one Gaussian a node)")
        ->group(group);
    command.add_option("--dense-block", paper.dense_block, "Block edge in dense leaves, voxels")
        ->check(CLI::IsMember({2, 4, 8}))
        ->capture_default_str()
        ->group(group);
    command
        .add_option(
            "--amplitude", arguments.amplitude,
            "Peak of a Gaussian: the group's mean density (the paper's, loses a third of the "
            "mass), or the peak that conserves mass")
        ->check(CLI::IsMember({"mean", "mass"}))
        ->capture_default_str()
        ->group(group);
    command
        .add_option(
            "--kappa", paper.kappa,
            "Cut the kernel exp(-d^T S^-1 d) where it falls to this: cutoff sqrt(-2 ln kappa)")
        ->check(CLI::Range(1e-12, 0.999))
        ->capture_default_str()
        ->group(group);
    command
        .add_option("--opacity-threshold", paper.opacity_threshold,
                    "Drop groups with a mean density at or below this; 0 drops empty ones only")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str()
        ->group(group);
    command
        .add_option("--variance-threshold", paper.variance_threshold,
                    "variance: split while a part's variance exceeds this share of the volume's")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str()
        ->group(group);
    command
        .add_option("--similarity", paper.similarity,
                    "neighbours: join leaves whose means differ by no more than this share")
        ->check(CLI::Range(0.0, 1.0))
        ->capture_default_str()
        ->group(group);
    command
        .add_option("--tree-depth", paper.tree_depth,
                    "tree: one Gaussian per node of 4096^3 (1), 128^3 (2) or 8^3 voxels (3)")
        ->check(CLI::Range(1, 3))
        ->capture_default_str()
        ->group(group);
    command
        .add_option("--minimum-radius", paper.minimum_radius_voxels,
                    "Least radius, voxels; a single voxel has 0.5")
        ->check(CLI::PositiveNumber)
        ->capture_default_str()
        ->group(group);
}

void add_moment_options(CLI::App& command, ConvertArguments& arguments) {
    MomentOptions& moments = arguments.moments;
    const auto add = [&](const std::string& name, auto& value, const std::string& text) {
        return command.add_option(name, value, text)->group(kMomentGroup);
    };
    add("--error", moments.error,
        "The smallest model whose measured error (relative L2 of T, 8 views) is at most this; the "
        "default way for volumes (for particles: one Gaussian each)")
        ->capture_default_str();
    add("--budget", moments.budget, "The best model of at most this many Gaussians")
        ->check(CLI::PositiveNumber);
    add("--block", moments.block_voxels, "Uniform cells of 1 to 128 voxels, a power of two")
        ->check(CLI::IsMember({1, 2, 4, 8, 16, 32, 64, 128}));
    add("--soft-steps", moments.soft_steps,
        fmt::format("Steps from hard cells to soft ones; default: none for uniform cells, {} for a "
                    "budget, {} for an error",
                    kSoftSteps, kSearchSoftSteps))
        ->check(CLI::Range(0, 1000));
    add("--refine", moments.refine_seconds,
        "Spend up to this many seconds on moving Gaussians to where pictures err: as many as "
        "before")
        ->check(CLI::Range(0.0, 1e6));
    add("--spread", moments.spread, "Widen every standard deviation at constant mass")
        ->check(CLI::Range(0.5, 2.0))
        ->capture_default_str();
    add("--mass-threshold", moments.mass_threshold,
        "Drop the lightest cells, up to this share of the mass")
        ->check(CLI::Range(0.0, 0.999))
        ->capture_default_str();
    command
        .add_flag("--axis-aligned", moments.axis_aligned,
                  "No rotations: 28 bytes a Gaussian, not 44")
        ->group(kMomentGroup);
    command
        .add_flag("--stamp", arguments.stamp,
                  "Keep the times of the stages in the file: no more the same bytes each time")
        ->group(kMomentGroup);
    command.add_flag("--measure", moments.measure, "Measure the error of any cut")
        ->group(kMomentGroup);
}

}  // namespace vog::cli
