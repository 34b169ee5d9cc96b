// moments.cpp: the moment conversion: check the options, choose the cells, soften them, drop the
// lightest, write the Gaussians.
#include "vog/moments.h"

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <filesystem>

#include "convert/light_cells.h"
#include "convert/moment_cells.h"
#include "convert/moment_cut.h"
#include "convert/moment_error.h"
#include "convert/moment_soften.h"
#include "vog/error.h"

namespace vog {

namespace {

/// One conversion: what is asked, and what is to be reported.
struct Conversion {
    const Volume& volume;
    const MomentOptions& options;
    MomentReport& report;
    double volume_mass = 0;  ///< index units
    std::chrono::steady_clock::time_point last = std::chrono::steady_clock::now();

    void end_stage(const char* name, double fraction) {
        const auto now = std::chrono::steady_clock::now();
        const double ms = std::chrono::duration<double, std::milli>(now - last).count();
        report.stage_ms.emplace_back(name, ms);
        last = now;
        if (options.progress) options.progress(fraction);
    }
    int soft_steps() const {
        if (options.soft_steps >= 0) return options.soft_steps;
        return options.block_voxels ? 0 : kSoftSteps;
    }
    MomentFrame frame() const {
        return moment_frame(volume.world_from_index, options.axis_aligned, options.spread);
    }
};

void check(const Volume& volume, const MomentOptions& options) {
    const auto refuse = [](const std::string& what) { throw Error("moments: " + what); };
    const int block = options.block_voxels;
    if (block && options.budget)
        refuse(fmt::format("block {} and budget {}, expected one of them", block, options.budget));
    if (block && !(block >= 1 && block <= 128 && std::has_single_bit(unsigned(block))))
        refuse(fmt::format("block {} voxels, expected a power of two from 1 to 128", block));
    if (!(options.error > 0 && options.error < 1))
        refuse(fmt::format("error {}, expected in (0, 1)", options.error));
    if (options.soft_steps < -1 || options.soft_steps > 1000)
        refuse(fmt::format("{} soft steps, expected 0 to 1000", options.soft_steps));
    if (!(options.spread >= 0.5f && options.spread <= 2))
        refuse(fmt::format("spread {}, expected in [0.5, 2]", options.spread));
    if (!(options.mass_threshold >= 0 && options.mass_threshold < 1))
        refuse(fmt::format("mass threshold {}, expected in [0, 1)", options.mass_threshold));
    validate(volume);
}

/// Runs take(node) over one chunk of the volume's nodes.
template <class Take>
void for_each_cell_of(const Conversion& job, const std::vector<MomentNode>& nodes,
                      std::size_t chunk, const Take& take) {
    const std::size_t last = std::min((chunk + 1) * kNodeChunk, nodes.size());
    for (std::size_t n = chunk * kNodeChunk; n < last; ++n)
        for_each_cell(job.volume, nodes[n], job.options.block_voxels, take);
}

std::size_t chunk_count(const std::vector<MomentNode>& nodes) {
    return (nodes.size() + kNodeChunk - 1) / kNodeChunk;
}

/// Hard cells of up to a leaf's edge, straight to Gaussians: the masses first, then every chunk of
/// leaves writes at its own place, so that nothing but the masses is held besides the result.
Gaussians small_blocks(Conversion& job) {
    const std::vector<MomentNode> nodes = morton_nodes(job.volume);
    std::vector<std::vector<float>> masses(chunk_count(nodes));
    tbb::parallel_for(std::size_t{0}, masses.size(), [&](std::size_t chunk) {
        for_each_cell_of(job, nodes, chunk, [&](const MomentSums& sums, Vec3d) {
            masses[chunk].push_back(static_cast<float>(sums.mass));
        });
    });
    LightCells light;
    for (const auto& part : masses)
        for (const float mass : part) light.add(mass);
    const float least = light.least_mass(job.options.mass_threshold);
    light.tell(job.volume_mass, job.report);

    std::vector<std::size_t> first(masses.size() + 1);
    for (std::size_t chunk = 0; chunk < masses.size(); ++chunk) {
        const auto stays = [&](float mass) { return mass >= least; };
        first[chunk + 1] = first[chunk] + static_cast<std::size_t>(std::count_if(
                                              masses[chunk].begin(), masses[chunk].end(), stays));
        masses[chunk] = {};
    }
    Gaussians model;
    resize(model, first.back(), job.options.axis_aligned);
    const MomentFrame frame = job.frame();
    tbb::parallel_for(std::size_t{0}, masses.size(), [&](std::size_t chunk) {
        std::size_t i = first[chunk];
        for_each_cell_of(job, nodes, chunk, [&](const MomentSums& sums, Vec3d center) {
            if (static_cast<float>(sums.mass) < least) return;
            Moments moments = moments_of(sums);
            moments.mean = moments.mean + center;
            set_gaussian(model, i++, moments, frame);
        });
    });
    job.end_stage("cells", 1);
    return model;
}

/// Hard cells of one size, as moments.
std::vector<Moments> block_cells(const Conversion& job) {
    std::vector<Moments> cells;
    if (job.options.block_voxels <= kLeafEdge) {
        const std::vector<MomentNode> nodes = morton_nodes(job.volume);
        std::vector<std::vector<Moments>> parts(chunk_count(nodes));
        tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t chunk) {
            for_each_cell_of(job, nodes, chunk, [&](const MomentSums& sums, Vec3d center) {
                parts[chunk].push_back(moments_of(sums));
                parts[chunk].back().mean = parts[chunk].back().mean + center;
            });
        });
        for (const auto& part : parts) cells.insert(cells.end(), part.begin(), part.end());
        return cells;
    }
    // Larger ones are a level of the octree, and the tiles above it. A level may be missing only
    // where the volume is smaller than the block: then its last one stands for it.
    const MomentOctree octree = moment_octree(job.volume, kLeafEdge);
    const int wanted = std::countr_zero(unsigned(job.options.block_voxels));
    std::size_t at = 0;
    while (at + 1 < octree.levels.size() && octree.levels[at].edge_log2 < wanted) ++at;
    for (std::size_t level = at; level < octree.levels.size(); ++level)
        for (const MomentCell& cell : octree.levels[level].cells)
            if (level == at || cell.child_count == 0)
                cells.push_back(cell_moments(cell, octree.levels[level].edge_log2));
    return cells;
}

Gaussians gaussians_of(Conversion& job, const std::vector<Moments>& cells) {
    LightCells light;
    for (const Moments& cell : cells) light.add(static_cast<float>(cell.mass));
    const float least = light.least_mass(job.options.mass_threshold);
    light.tell(job.volume_mass, job.report);
    std::vector<std::uint32_t> kept;
    for (std::size_t n = 0; n < cells.size(); ++n)
        if (static_cast<float>(cells[n].mass) >= least)
            kept.push_back(static_cast<std::uint32_t>(n));
    Gaussians model;
    resize(model, kept.size(), job.options.axis_aligned);
    const MomentFrame frame = job.frame();
    tbb::parallel_for(std::size_t{0}, kept.size(),
                      [&](std::size_t i) { set_gaussian(model, i, cells[kept[i]], frame); });
    return model;
}

void soften(const Conversion& job, const Softener& softener, std::vector<Moments>& cells) {
    for (int step = 0; step < job.soft_steps(); ++step) softener.step(cells);
}

/// The smallest budget whose measured error is low enough, to 4 %: false position on the
/// logarithms, for which the error is close to a power of the count, kept inside what is known.
Gaussians search(Conversion& job, const CutTree& tree, const Softener& softener) {
    const ErrorViews views(job.volume);
    job.end_stage("reference", 0.3);
    const double target = job.options.error;
    constexpr double kTolerance = 1.04, kFirstShare = 0.01, kUsualPower = -0.35;
    constexpr int kTries = 12;
    const auto finest = static_cast<double>(finest_count(tree));
    double low = 1, high = finest, low_error = 0, count = std::max(1.0, kFirstShare * finest);
    Gaussians best;
    double best_error = -1;
    for (int tries = 0; tries < kTries && high > low * kTolerance; ++tries) {
        std::vector<Moments> cells = best_cut(tree, static_cast<std::size_t>(count));
        soften(job, softener, cells);
        Gaussians model = gaussians_of(job, cells);
        model.cutoff = kMomentCutoff;
        const double error = views.measure(model);
        double power = kUsualPower;
        if (error <= target || count >= finest) {
            high = count;
            best = std::move(model);
            best_error = error;
        } else {
            low = count;
            low_error = error;
        }
        if (best_error > 0 && low_error > 0 && best_error < low_error && high > low)
            power = std::log(best_error / low_error) / std::log(high / low);
        // Aim a little beyond the target, so that the last try is a success.
        const double from = error <= target ? best_error : low_error;
        const double guess = count * std::pow(0.995 * target / from, 1 / power);
        count = std::clamp(guess, low * std::sqrt(kTolerance), high / std::sqrt(kTolerance));
        if (best_error < 0 && guess >= finest) count = finest;
    }
    job.report.measured_error = best_error;
    job.end_stage("search", 1);
    return best;
}

/// The cut of a budget, or the search for an error.
Gaussians best_cells(Conversion& job) {
    const CutTree tree = cut_tree(job.volume);
    const Softener softener(tree.bricks);
    job.end_stage("octree", 0.2);
    if (!job.options.budget) return search(job, tree, softener);
    std::vector<Moments> cells = best_cut(tree, job.options.budget);
    job.end_stage("cut", 0.3);
    soften(job, softener, cells);
    job.end_stage("soften", 0.9);
    return gaussians_of(job, cells);
}

Gaussians block_model(Conversion& job) {
    if (job.soft_steps() == 0 && job.options.block_voxels <= kLeafEdge) return small_blocks(job);
    std::vector<Moments> cells = block_cells(job);
    job.end_stage("cells", 0.3);
    if (job.soft_steps() > 0) {
        const std::vector<Brick> bricks = volume_bricks(job.volume, morton_nodes(job.volume));
        soften(job, Softener(bricks), cells);
        job.end_stage("soften", 0.9);
    }
    return gaussians_of(job, cells);
}

/// What was asked for, as flags, and the error reached.
std::string option_text(const Conversion& job) {
    const MomentOptions& o = job.options;
    std::string text = o.block_voxels ? fmt::format("--block {}", o.block_voxels)
                       : o.budget     ? fmt::format("--budget {}", o.budget)
                                      : fmt::format("--error {}", o.error);
    text += fmt::format(" --soft-steps {} --mass-threshold {}", job.soft_steps(), o.mass_threshold);
    if (o.spread != 1) text += fmt::format(" --spread {}", o.spread);
    if (o.axis_aligned) text += " --axis-aligned";
    if (job.report.measured_error >= 0)
        text += fmt::format(" (measured error {:.4g})", job.report.measured_error);
    return text;
}

}  // namespace

MomentOptions moment_lod(int lod) {
    if (lod < 1 || lod > 5) throw Error(fmt::format("level of detail {}, expected 1 to 5", lod));
    MomentOptions options;
    options.block_voxels = 1 << lod;
    return options;
}

Gaussians convert_moments(const Volume& volume, const MomentOptions& options,
                          MomentReport* report) {
    MomentReport unwanted;
    Conversion job{volume, options, report ? *report : unwanted};
    job.report = {};
    check(volume, options);
    job.volume_mass = mass(volume) / voxel_volume(volume);
    if (!(job.volume_mass > 0 && std::isfinite(job.volume_mass)))
        throw Error(fmt::format("{}: mass {}, expected a volume with some",
                                volume.source.empty() ? "volume" : volume.source, job.volume_mass));
    job.end_stage("check", 0.1);

    Gaussians model = options.block_voxels ? block_model(job) : best_cells(job);
    model.cutoff = kMomentCutoff;
    if (options.measure && job.report.measured_error < 0) {
        job.report.measured_error = ErrorViews(volume).measure(model);
        job.end_stage("measure", 1);
    }
    model.box = world_box(volume);
    model.source_voxels = active_voxels(volume);
    model.source = std::filesystem::path(volume.source).filename().string();
    if (!volume.name.empty()) model.source += (model.source.empty() ? "" : " ") + volume.name;
    model.method = "moments";
    model.options = option_text(job);
    return model;
}

}  // namespace vog
