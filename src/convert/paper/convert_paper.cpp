// convert_paper.cpp: the paper's conversion: option checks, parallel loops over leaves, tiles.
// Source: Sharma & Schmalstieg, section 3.
#include <fmt/core.h>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <utility>

#include "convert/paper/grouping.h"
#include "core/parallel.h"
#include "vog/conversion_schema.h"
#include "vog/error.h"

namespace vog {

using namespace paper;

namespace {

constexpr std::array<std::pair<Strategy, const char*>, 6> kStrategyNames = {
    {{Strategy::smart_grouping, "smart"},
     {Strategy::strict_blocks, "strict"},
     {Strategy::single_per_leaf, "single"},
     {Strategy::variance_clusters, "variance"},
     {Strategy::leaf_clusters, "neighbours"},
     {Strategy::tree_mirror, "tree"}}};

void check(const PaperOptions& options) {
    ConversionOptions values;
    values.paper = options;
    check_values(values);
}

/// Checks all values in one parallel pass; validate() throws with the position of the first bad
/// one.
void check(const Volume& volume) {
    const std::string source = volume.source.empty() ? "volume" : volume.source;
    if (volume.empty())
        throw Error(
            fmt::format("{}: the volume is empty, expected leaves or tiles to convert", source));
    const Vec3d shift = volume.world_from_index.translation;
    if (!std::isfinite(dot(shift, shift)))
        throw Error(fmt::format("{}: the translation [{}, {}, {}] is not finite", source, shift.x,
                                shift.y, shift.z));
    const bool usable = tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, volume.leaves.size()), true,
        [&](const tbb::blocked_range<std::size_t>& range, bool sound) {
            for (std::size_t i = range.begin(); i < range.end(); ++i) {
                int offences = 0;
                for (const float value : volume.leaves[i].value)
                    offences |= !(value >= 0 && value <= std::numeric_limits<float>::max());
                sound = sound && offences == 0;
            }
            return sound;
        },
        std::logical_and<>{});
    const double det = determinant(volume.world_from_index.linear);
    const bool tiles_usable =
        std::all_of(volume.tiles.begin(), volume.tiles.end(), [](const Tile& tile) {
            return tile.value >= 0 && tile.value <= std::numeric_limits<float>::max();
        });
    if (!usable || !tiles_usable || !std::isfinite(det) || det == 0) validate(volume);
}

/// The options as flags of `vog convert`.
std::string flags(const PaperOptions& options) {
    std::string text = fmt::format("--set strategy={}", strategy_name(options.strategy));
    switch (options.strategy) {
        case Strategy::variance_clusters:
            text += fmt::format(" --set variance-threshold={}", options.variance_threshold);
            break;
        case Strategy::leaf_clusters:
            text += fmt::format(" --set similarity={}", options.similarity);
            break;
        case Strategy::tree_mirror:
            text += fmt::format(" --set tree-depth={}", options.tree_depth);
            break;
        default:
            text += fmt::format(" --set dense-block={}", options.dense_block);
    }
    text += fmt::format(
        " --set amplitude={} --set kappa={} --set opacity-threshold={} --set minimum-radius={}",
        options.amplitude == Amplitude::mean ? "mean" : "mass", options.kappa,
        options.opacity_threshold, options.minimum_radius_voxels);
    return text;
}

/// Appends `count` uninitialised Gaussians.
/// returns  index of the first
std::size_t extend(Gaussians& model, std::size_t count, const GroupFit& fit) {
    const std::size_t first = model.size();
    model.mean.resize(first + count);
    model.scale.resize(first + count);
    model.density.resize(first + count);
    if (fit.frame.kind != WorldFrame::Kind::aligned) model.rotation.resize(first + count);
    return first;
}

/// Copies Gaussians into the model from index `place` on.
void store(std::span<const FittedGaussian> fitted, std::size_t place, Gaussians& model) {
    for (const FittedGaussian& gaussian : fitted) {
        model.mean[place] = gaussian.mean;
        model.scale[place] = gaussian.scale;
        model.density[place] = gaussian.density;
        if (!model.rotation.empty()) model.rotation[place] = gaussian.rotation;
        ++place;
    }
}

/// Calls add_leaf(leaf, buffer) for every leaf, one leaf a task, and appends the buffers to the
/// model in leaf order. The paper's threads append under a mutex, in any order; here prefix sums of
/// the counts give each leaf its place.
template <class AddLeaf>
void append_leaves(std::span<const Leaf> leaves, const GroupFit& fit, const Progress& progress,
                   const AddLeaf& add_leaf, Gaussians& model) {
    struct Run {
        const std::vector<FittedGaussian>* buffer = nullptr;
        std::size_t first = 0, count = 0, place = 0;
    };
    // Batches bound the buffers: 8192 leaves are at most 4 M Gaussians.
    constexpr std::size_t kBatch = 8192;
    tbb::enumerable_thread_specific<std::vector<FittedGaussian>> buffers;
    std::vector<Run> runs;
    for (std::size_t begin = 0; begin < leaves.size(); begin += kBatch) {
        runs.assign(std::min(kBatch, leaves.size() - begin), {});
        for (auto& buffer : buffers) buffer.clear();
        vog::parallel_for(std::size_t{0}, runs.size(), [&](std::size_t i) {
            auto& buffer = buffers.local();
            const std::size_t first = buffer.size();
            add_leaf(leaves[begin + i], buffer);
            runs[i] = {&buffer, first, buffer.size() - first};
        });
        std::size_t count = 0;
        for (Run& run : runs) run.place = std::exchange(count, count + run.count);
        const std::size_t first = extend(model, count, fit);
        vog::parallel_for(std::size_t{0}, runs.size(), [&](std::size_t i) {
            const Run& run = runs[i];
            store(std::span(*run.buffer).subspan(run.first, run.count), first + run.place, model);
        });
        if (progress)
            progress(static_cast<double>(begin + runs.size()) /
                     static_cast<double>(leaves.size() + 1));
    }
}

/// Appends one Gaussian for each group above the opacity threshold.
void append_groups(const GroupFit& fit, const std::vector<Group>& groups, Gaussians& model) {
    std::vector<FittedGaussian> fitted;
    for (const Group& group : groups) add_group(fit, group, fitted);
    store(fitted, extend(model, fitted.size(), fit), model);
}

/// Appends the Gaussians of all leaves; with Strategy::tree_mirror also those of the tiles.
void append_by_strategy(const Volume& volume, const PaperOptions& options, const GroupFit& fit,
                        Gaussians& model) {
    const auto each_leaf = [&](const auto& add_leaf) {
        append_leaves(volume.leaves, fit, options.progress, add_leaf, model);
    };
    // Dense leaves are divided into blocks under each of the paper's strategies.
    const auto each_sparse_leaf = [&](const auto& add_leaf) {
        each_leaf([&](const Leaf& leaf, std::vector<FittedGaussian>& out) {
            if (leaf.dense())
                add_dense_blocks(fit, leaf, options.dense_block, out);
            else
                add_leaf(fit, leaf, out);
        });
    };
    switch (options.strategy) {
        case Strategy::smart_grouping:
            each_sparse_leaf(add_smart_groups);
            break;
        case Strategy::strict_blocks:
            each_sparse_leaf(add_strict_blocks);
            break;
        case Strategy::single_per_leaf:
            each_sparse_leaf(add_single);
            break;
        case Strategy::variance_clusters:
            each_leaf([&, variance = options.variance_threshold * leaf_value_variance(volume)](
                          const Leaf& leaf, std::vector<FittedGaussian>& out) {
                add_variance_clusters(fit, leaf, variance, out);
            });
            break;
        case Strategy::leaf_clusters:
            append_groups(fit, join_neighbours(volume, leaf_groups(volume), options.similarity),
                          model);
            break;
        case Strategy::tree_mirror:
            append_groups(fit, mirror_tree(volume, leaf_groups(volume), options.tree_depth), model);
            break;
    }
}

}  // namespace

Strategy strategy_from_name(const std::string& name) {
    std::string names;
    for (const auto& [strategy, known] : kStrategyNames) {
        if (name == known) return strategy;
        names += fmt::format("{}{}", names.empty() ? "" : ", ", known);
    }
    throw Error(fmt::format("no strategy named '{}' (there are: {})", name, names));
}

std::string strategy_name(Strategy strategy) {
    for (const auto& [known, name] : kStrategyNames)
        if (known == strategy) return name;
    throw Error(fmt::format("strategy {}, expected 0 to {}", static_cast<int>(strategy),
                            kStrategyNames.size() - 1));
}

PaperOptions paper_lod(int lod) {
    if (lod < 1 || lod > 5)
        throw Error(fmt::format("level of detail {}, expected 1 (finest) to 5", lod));
    PaperOptions options;
    options.dense_block = lod == 1 ? 2 : lod == 2 ? 4 : 8;
    if (lod == 4) options.strategy = Strategy::strict_blocks;
    if (lod == 5) options.strategy = Strategy::single_per_leaf;
    return options;
}

Gaussians convert_paper(const Volume& volume, const PaperOptions& options) {
    check(options);
    check(volume);

    Gaussians model;
    model.cutoff = static_cast<float>(std::sqrt(-2 * std::log(static_cast<double>(options.kappa))));
    model.box = world_box(volume);
    model.content = content_of({&volume, 1}, model.box);
    model.origin = options.origin.value_or(model_origin(model.box));
    model.source_voxels = active_voxels(volume);
    model.source = std::filesystem::path(volume.source).filename().string();
    if (!volume.name.empty()) model.source += (model.source.empty() ? "" : " ") + volume.name;
    model.method = "paper";
    model.options = flags(options);

    GroupFit fit = make_group_fit(volume, options, model.cutoff);
    Vec3d& translation = fit.frame.world_from_index.translation;
    translation = translation - model.origin;
    append_by_strategy(volume, options, fit, model);
    // Tiles are boxes of one value, whatever their level.
    if (options.strategy != Strategy::tree_mirror) append_groups(fit, tile_groups(volume), model);
    if (options.progress) options.progress(1);
    return model;
}

Gaussians convert_paper(const Composite& data, const PaperOptions& options) {
    if (data.parts.empty())
        throw Error("convert: no voxel is left, expected one or more within the masks");
    PaperOptions of_parts = options;
    of_parts.origin = options.origin.value_or(model_origin(data.box));
    Gaussians model;
    for (const Volume& part : data.parts) append(model, convert_paper(part, of_parts));
    model.box = data.box;
    model.content = data.content;
    model.source_voxels = data.voxels;
    return model;
}

}  // namespace vog
