// adaptive_model.cpp: --budget, the optimal cut of a number of Gaussians; --error, the smallest
// such cut whose measured error is low enough.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "convert/moments/cut/carried_values.h"
#include "convert/moments/cut/optimal_cut.h"
#include "convert/moments/error_search.h"
#include "convert/moments/moment_job.h"
#include "vog/budget_search.h"

namespace vog::moments {

namespace {

/// The fields of the data, and a cut tree for each.
struct FieldTrees {
    std::vector<LatticeField> fields;
    std::vector<CutTree> trees;
};

FieldTrees field_trees(const MomentJob& job) {
    FieldTrees all;
    all.fields = job.fields();
    double finest_edge = std::numeric_limits<double>::infinity();
    for (const LatticeField& field : all.fields)
        finest_edge = std::min(finest_edge, std::cbrt(field.voxel_volume()));
    const CarriedValues carried(job);
    for (std::size_t f = 0; f < all.fields.size(); ++f)
        all.trees.push_back(cut_tree(
            all.fields[f], cut_scale(std::cbrt(all.fields[f].voxel_volume()) / finest_edge),
            carried.at(f)));
    return all;
}

/// Cells of the finest cut: at most one a voxel, also where seams of levels divide voxels.
std::size_t finest_count(const MomentJob& job, const FieldTrees& all) {
    std::size_t finest = 0;
    for (const CutTree& tree : all.trees) finest += finest_count(tree);
    return std::min<std::size_t>(finest, job.most_cells);
}

/// Whether the finest cut has the voxels: soft steps would blur them, an error of 0.149 against 0.131
/// for random values in 64 x 64 x 8 voxels.
bool finest_has_voxels(const MomentJob& job) {
    return job.options.soft_steps < 0 && job.samples() <= job.most_cells;
}

/// One cell for each voxel.
FieldCells voxel_cells(const MomentJob& job, const FieldTrees& all) {
    FieldCells cells;
    for (const LatticeField& field : all.fields)
        cells.push_back(overlapping_cells(field, 1, job.options.periodic));
    return cells;
}

/// Soft cells of a budget.
FieldCells soft_cells(const MomentJob& job, const FieldTrees& all, FieldEmSolver& em,
                      std::size_t budget, std::size_t finest) {
    if (budget >= finest && finest_has_voxels(job)) return voxel_cells(job, all);
    FieldCells cells = best_cut(all.trees, std::min(budget, finest));
    em.run(cells, job.soft_steps());
    return cells;
}

/// Guesses the number of cells that have the error, from the error of few ones after few steps, which take a tenth of the
/// time of a try.
template <class Beyond>
double first_guess(MomentJob& job, const FieldTrees& all, const ErrorViews& views,
                   FieldEmSolver& em, std::size_t most, double target, const Beyond& beyond) {
    constexpr double kShare = 1 / 16.0;
    constexpr int kSteps = 4;
    // Where the guess is near the most there may be, these are tried first: one more try would bring little.
    constexpr double kNear = 0.15;
    const double count = std::max(kShare * static_cast<double>(most), 1.0);
    FieldCells cells = best_cut(all.trees, static_cast<std::size_t>(count));
    em.run(cells, std::min(kSteps, job.soft_steps()));
    const double error = beyond(measured_model(job, all.fields, views, cells).error);
    const double guess = count * std::pow(error / target, 1 / -kErrorPower);
    return guess < kNear * static_cast<double>(most) ? std::max(guess, 1.0)
                                                     : static_cast<double>(most);
}

/// Cells of the smallest budget at which the soft, thresholded model has at most the error; of the
/// default at most default_count.
/// interpolation  of the voxels, linearly
FieldCells searched_cells(MomentJob& job, const FieldTrees& all, const ErrorViews& views,
                          RelativeError interpolation, FieldEmSolver& em) {
    ErrorSearch search;
    search.target = job.error();
    search.finest = finest_count(job, all);
    search.beyond_few = job.options.error > 0;
    const std::size_t few = std::min(default_count(job.values()), search.finest);
    search.few = !search.beyond_few || finest_has_voxels(job) ? few : search.finest;
    const auto beyond = [&](const RelativeError& error) {
        return error_beyond_interpolation(error, interpolation, search.target, search.finest);
    };
    search.first = std::min(first_guess(job, all, views, em, few, search.target, beyond),
                            static_cast<double>(search.few));
    FieldCells tried, best;
    search.error_of_budget = [&](std::size_t budget) {
        tried = soft_cells(job, all, em, budget, search.finest);
        return measured_model(job, all.fields, views, tried).error;
    };
    search.keep = [&] { best = std::move(tried); };
    search.error_of_voxels = [&] {
        return measured_model(job, all.fields, views, voxel_cells(job, all)).error;
    };
    const RelativeError error = find_budget(search, interpolation);
    job.report_error(error, interpolation, views);
    job.report.stopped_by_count =
        !search.beyond_few && search.few < search.finest && beyond(error) > search.target;
    job.clock.end_stage("search", 0.9);
    return best;
}

}  // namespace

Gaussians adaptive_model(MomentJob& job) {
    // Views before trees: the traversal holds a second copy of the voxels while it runs.
    std::optional<ErrorViews> views;
    RelativeError interpolation;
    if (!job.options.budget) {
        views.emplace(job.parts, job.box, job.options.periodic);
        interpolation = views->interpolation(job.parts);
        job.clock.end_stage("reference", 0.2);
    }
    FieldTrees all = field_trees(job);
    job.clock.end_stage("octree", job.options.budget ? 0.2 : 0.3);
    FieldEmSolver em(all.fields, job.options.refine_seconds > 0, job.options.periodic);
    FieldCells cells;
    if (job.options.budget) {
        cells = soft_cells(job, all, em, job.options.budget, finest_count(job, all));
        job.clock.end_stage("soften", 0.9);
    } else {
        cells = searched_cells(job, all, *views, interpolation, em);
    }
    all.trees = {};
    views.reset();
    return final_model(job, all.fields, em, std::move(cells));
}

}  // namespace vog::moments
