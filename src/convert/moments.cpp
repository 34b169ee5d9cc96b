// moments.cpp: the moment conversion: check the options, choose the cells, soften them, drop the
// lightest, write the Gaussians.
#include "vog/moments.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>
#include <span>

#include "convert/budget_search.h"
#include "convert/light_cells.h"
#include "convert/moment_cells.h"
#include "convert/moment_cut.h"
#include "convert/moment_error.h"
#include "convert/moment_field.h"
#include "convert/moment_soften.h"
#include "convert/moment_uniform.h"
#include "parallel.h"
#include "vog/error.h"

namespace vog {

namespace {

/// One conversion: what is asked, and what is to be reported.
struct Conversion {
    std::span<const Volume> parts;  ///< volumes that do not overlap
    Box box;
    bool levels = false;  ///< parts of levels: of several lattices, under one budget
    const MomentOptions& options;
    MomentReport& report;
    double data_mass = 0;  ///< of all parts, in unit volumes
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
        return options.block_voxels ? 0 : options.budget ? kSoftSteps : kSearchSoftSteps;
    }
    const Volume& volume() const { return parts.front(); }
    MomentFrame frame(const Affine& world_from_index) const {
        return moment_frame(world_from_index, options.axis_aligned, options.spread);
    }
    /// Unit volumes in a voxel of the field's.
    double voxels_in(const MomentField& field) const {
        return levels ? field.voxel_volume() / unit_volume() : 1;
    }
    /// What masses are in: voxels of the first part, which others may not have.
    double unit_volume() const {
        return levels && options.together.sum ? 1 : voxel_volume(volume());
    }
    std::vector<MomentField> fields() const {
        if (levels) return moment_fields(parts);
        std::vector<MomentField> one;
        one.push_back(moment_field(volume()));
        return one;
    }
};

void check(const MomentOptions& options) {
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
    if (!(options.refine_seconds >= 0 && options.refine_seconds <= 1e6))
        refuse(fmt::format("refine {} seconds, expected in [0, 1e6]", options.refine_seconds));
    if (options.together.sum &&
        (!block || options.soft_steps > 0 || options.refine_seconds > 0 || options.measure))
        refuse("together with others, expected a hard uniform cut that is not measured");
    if (!(options.mass_threshold >= 0 && options.mass_threshold < 1))
        refuse(fmt::format("mass threshold {}, expected in [0, 1)", options.mass_threshold));
}

/// Runs take(node) over one chunk of the volume's nodes.
template <class Take>
void for_each_cell_of(const Conversion& job, const std::vector<MomentNode>& nodes,
                      std::size_t chunk, const Take& take) {
    const std::size_t last = std::min((chunk + 1) * kNodeChunk, nodes.size());
    for (std::size_t n = chunk * kNodeChunk; n < last; ++n)
        for_each_cell(job.volume(), nodes[n], job.options.block_voxels, take);
}

std::size_t chunk_count(const std::vector<MomentNode>& nodes) {
    return (nodes.size() + kNodeChunk - 1) / kNodeChunk;
}

/// Hard cells of up to a leaf's edge, straight to Gaussians: the masses first, then every chunk of
/// leaves writes at its own place, so that nothing but the masses is held besides the result.
Gaussians small_blocks(Conversion& job) {
    const std::vector<MomentNode> nodes = morton_nodes(job.volume());
    std::vector<std::vector<float>> masses(chunk_count(nodes));
    vog::parallel_for(std::size_t{0}, masses.size(), [&](std::size_t chunk) {
        for_each_cell_of(job, nodes, chunk, [&](const MomentSums& sums, Vec3d) {
            masses[chunk].push_back(static_cast<float>(sums.mass));
        });
    });
    LightCells light;
    for (const auto& part : masses)
        for (const float mass : part) light.add(mass);
    light.add_up(job.options.together);
    const float least = light.least_mass(job.options.mass_threshold);
    light.tell(job.data_mass, job.report);

    std::vector<std::size_t> first(masses.size() + 1);
    for (std::size_t chunk = 0; chunk < masses.size(); ++chunk) {
        const auto stays = [&](float mass) { return mass >= least; };
        first[chunk + 1] = first[chunk] + static_cast<std::size_t>(std::count_if(
                                              masses[chunk].begin(), masses[chunk].end(), stays));
        masses[chunk] = {};
    }
    Gaussians model;
    resize(model, first.back(), job.options.axis_aligned);
    const MomentFrame frame = job.frame(job.volume().world_from_index);
    vog::parallel_for(std::size_t{0}, masses.size(), [&](std::size_t chunk) {
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

/// Cells of every field, in its own index space.
using FieldCells = std::vector<std::vector<Moments>>;

Gaussians gaussians_of(Conversion& job, std::span<const MomentField> fields,
                       const FieldCells& cells) {
    LightCells light;
    const auto mass_of = [&](std::size_t field, const Moments& cell) {
        return static_cast<float>(cell.mass * job.voxels_in(fields[field]));
    };
    for (std::size_t f = 0; f < fields.size(); ++f)
        for (const Moments& cell : cells[f]) light.add(mass_of(f, cell));
    light.add_up(job.options.together);
    const float least = light.least_mass(job.options.mass_threshold);
    light.tell(job.data_mass, job.report);

    struct Kept {
        std::uint32_t field, cell;
    };
    std::vector<Kept> kept;
    for (std::size_t f = 0; f < fields.size(); ++f)
        for (std::size_t n = 0; n < cells[f].size(); ++n)
            if (mass_of(f, cells[f][n]) >= least)
                kept.push_back({static_cast<std::uint32_t>(f), static_cast<std::uint32_t>(n)});
    Gaussians model;
    resize(model, kept.size(), job.options.axis_aligned);
    std::vector<MomentFrame> frames;
    for (const MomentField& field : fields) frames.push_back(job.frame(field.world_from_index));
    vog::parallel_for(std::size_t{0}, kept.size(), [&](std::size_t i) {
        set_gaussian(model, i, cells[kept[i].field][kept[i].cell], frames[kept[i].field]);
    });
    return model;
}

/// The softeners of all fields, and how far each has come.
class FieldSoftener {
  public:
    /// goes_on  steps will follow those of `soften`: what they remember, a set of cells, is kept
    FieldSoftener(std::span<const MomentField> fields, bool goes_on)
        : steps_(fields.size()), goes_on_(goes_on) {
        for (const MomentField& field : fields) softeners_.emplace_back(field.bricks);
    }
    void step(FieldCells& cells) {
        for (std::size_t f = 0; f < softeners_.size(); ++f)
            if (!cells[f].empty()) softeners_[f].step(cells[f], steps_[f]);
    }
    /// From hard cells.
    void soften(FieldCells& cells, int steps) {
        steps_.assign(steps_.size(), {});
        for (int n = 0; n < steps; ++n) step(cells);
        if (!goes_on_) steps_.assign(steps_.size(), {});
    }

  private:
    std::vector<Softener> softeners_;
    std::vector<SoftSteps> steps_;
    bool goes_on_;
};

/// The model as it will be written, and its measured error.
FoundModel judged(Conversion& job, std::span<const MomentField> fields, const ErrorViews& views,
                  const FieldCells& cells) {
    FoundModel found{gaussians_of(job, fields, cells)};
    found.model.cutoff = kMomentCutoff;
    found.error = views.measure(found.model);
    return found;
}

/// The fields of the data, and what their cuts are chosen from.
struct FieldTrees {
    std::vector<MomentField> fields;
    std::vector<CutTree> trees;
};

FieldTrees field_trees(const Conversion& job) {
    FieldTrees all;
    all.fields = job.fields();
    double finest_edge = std::numeric_limits<double>::infinity();
    for (const MomentField& field : all.fields)
        finest_edge = std::min(finest_edge, std::cbrt(field.voxel_volume()));
    for (const MomentField& field : all.fields)
        all.trees.push_back(
            cut_tree(field, cut_scale(std::cbrt(field.voxel_volume()) / finest_edge)));
    return all;
}

/// The smallest model, softened and without its lightest cells, whose measured error is low enough.
FieldCells search(Conversion& job, const FieldTrees& all, FieldSoftener& softener) {
    const ErrorViews views(job.parts, job.box);
    job.end_stage("reference", 0.3);
    std::size_t finest = 0;
    for (const CutTree& tree : all.trees) finest += finest_count(tree);
    // Hard cells are made and measured in a tenth of the time of soft ones, and have a multiple of
    // their error: 1.6 to 2.3 times on smoke, cloud and fire, up to 3 on aquarius.
    constexpr double kHardOverSoft = 2;
    const double hard = job.soft_steps() > 0 ? kHardOverSoft : 1;
    const SearchStart start =
        search_start(hard * job.options.error, finest, [&](std::size_t budget) {
            return judged(job, all.fields, views, best_cut(all.trees, budget)).error;
        });
    FieldCells best;
    const FoundModel found = smallest_model(
        job.options.error, finest,
        [&](std::size_t budget) {
            FieldCells cells = best_cut(all.trees, budget);
            softener.soften(cells, job.soft_steps());
            FoundModel tried = judged(job, all.fields, views, cells);
            tried.model = {};  // made again of the best cells, which are needed for refinement
            if (tried.error <= job.options.error || budget >= finest) best = std::move(cells);
            return tried;
        },
        start);
    job.report.measured_error = found.error;
    job.end_stage("search", 0.9);
    return best;
}

/// More soft steps while the error falls and there is time, if asked for; then the model.
Gaussians finished(Conversion& job, std::span<const MomentField> fields, FieldSoftener& softener,
                   FieldCells cells) {
    if (job.options.refine_seconds == 0) return gaussians_of(job, fields, cells);
    using Clock = std::chrono::steady_clock;
    const auto end = Clock::now() + std::chrono::duration<double>(job.options.refine_seconds);
    const ErrorViews views(job.parts, job.box);
    FieldCells best = cells;
    double least = judged(job, fields, views, cells).error;
    constexpr int kStepsBetween = 4, kPatience = 3;
    for (int failures = 0; failures < kPatience && Clock::now() < end;) {
        for (int n = 0; n < kStepsBetween && Clock::now() < end; ++n) softener.step(cells);
        const double error = judged(job, fields, views, cells).error;
        failures = error < least ? 0 : failures + 1;
        if (error < least) best = cells, least = error;
    }
    job.report.measured_error = least;
    job.end_stage("refine", 1);
    return gaussians_of(job, fields, best);
}

/// The cut of a budget, or the search for an error.
Gaussians best_cells(Conversion& job) {
    FieldTrees all = field_trees(job);
    job.end_stage("octree", 0.2);
    FieldSoftener softener(all.fields, job.options.refine_seconds > 0);
    FieldCells cells =
        job.options.budget ? best_cut(all.trees, job.options.budget) : search(job, all, softener);
    all.trees = {};
    if (!job.options.budget) return finished(job, all.fields, softener, std::move(cells));
    job.end_stage("cut", 0.3);
    softener.soften(cells, job.soft_steps());
    job.end_stage("soften", 0.9);
    return finished(job, all.fields, softener, std::move(cells));
}

Gaussians block_model(Conversion& job) {
    const int block = job.options.block_voxels;
    const bool hard = job.soft_steps() == 0 && job.options.refine_seconds == 0;
    if (!job.levels && hard && block <= kLeafEdge) return small_blocks(job);
    const std::vector<MomentField> fields = job.fields();
    FieldCells cells;
    for (const MomentField& field : fields) cells.push_back(uniform_cells(field, block));
    job.end_stage("cells", 0.3);
    FieldSoftener softener(fields, job.options.refine_seconds > 0);
    softener.soften(cells, job.soft_steps());
    job.end_stage("soften", 0.9);
    return finished(job, fields, softener, std::move(cells));
}

/// What was asked for, as flags, and the error reached.
std::string option_text(const Conversion& job) {
    const MomentOptions& o = job.options;
    std::string text = o.block_voxels ? fmt::format("--block {}", o.block_voxels)
                       : o.budget     ? fmt::format("--budget {}", o.budget)
                                      : fmt::format("--error {}", o.error);
    text += fmt::format(" --soft-steps {} --mass-threshold {}", job.soft_steps(), o.mass_threshold);
    if (o.spread != 1) text += fmt::format(" --spread {}", o.spread);
    if (o.refine_seconds > 0) text += fmt::format(" --refine {}", o.refine_seconds);
    if (o.axis_aligned) text += " --axis-aligned";
    if (job.report.measured_error >= 0)
        text += fmt::format(" (measured error {:.4g})", job.report.measured_error);
    return text;
}

/// "smoke.vdb density"; parts of one level name it once.
std::string source_text(std::span<const Volume> parts) {
    std::string all, last;
    for (const Volume& part : parts) {
        std::string text = std::filesystem::path(part.source).filename().string();
        if (!part.name.empty()) text += (text.empty() ? "" : " ") + part.name;
        if (text != last) all += (all.empty() ? "" : " + ") + text;
        last = text;
    }
    return all;
}

Gaussians run(Conversion& job) {
    job.report = {};
    for (const Volume& part : job.parts) job.data_mass += mass(part) / job.unit_volume();
    job.options.together.add_up(job.data_mass);
    if (!(job.data_mass > 0 && std::isfinite(job.data_mass)))
        throw Error(fmt::format("{}: mass {}, expected a volume with some",
                                job.volume().source.empty() ? "volume" : job.volume().source,
                                job.data_mass));
    job.end_stage("check", 0.1);

    Gaussians model = job.options.block_voxels ? block_model(job) : best_cells(job);
    model.cutoff = kMomentCutoff;
    if (job.options.measure && job.report.measured_error < 0) {
        job.report.measured_error = ErrorViews(job.parts, job.box).measure(model);
        job.end_stage("measure", 1);
    }
    model.box = job.box;
    model.source = source_text(job.parts);
    model.method = "moments";
    model.options = option_text(job);
    return model;
}

/// What the whole reached, of which the model may be a part.
void tell_reached(Gaussians& model, const Conversion& job) {
    // Counts are exact in doubles.
    std::array<double, 2> counts{static_cast<double>(model.size()),
                                 static_cast<double>(model.source_voxels)};
    job.options.together.add_up(counts);
    model.reached =
        reached_text(static_cast<std::uint64_t>(counts[0]), static_cast<std::uint64_t>(counts[1]),
                     job.report, "active voxels");
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
    check(options);
    validate(volume);
    MomentReport unwanted;
    Conversion job{{&volume, 1}, world_box(volume), false, options, report ? *report : unwanted};
    Gaussians model = run(job);
    model.source_voxels = active_voxels(volume);
    tell_reached(model, job);
    return model;
}

Gaussians convert_moments(const Composite& data, const MomentOptions& options,
                          MomentReport* report) {
    check(options);
    if (data.parts.empty()) throw Error("moments: no voxel is seen, expected one within the masks");
    for (const Volume& part : data.parts) validate(part);
    MomentReport unwanted;
    Conversion job{data.parts, data.box, true, options, report ? *report : unwanted};
    Gaussians model = run(job);
    model.source_voxels = data.voxels;
    tell_reached(model, job);
    return model;
}

}  // namespace vog
