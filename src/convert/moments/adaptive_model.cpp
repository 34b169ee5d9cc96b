// adaptive_model.cpp: --budget, the optimal cut of a number of Gaussians; --error, the smallest
// such cut whose measured error is low enough.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "convert/moments/cut/optimal_cut.h"
#include "convert/moments/error_search.h"
#include "convert/moments/moment_job.h"

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
    for (const LatticeField& field : all.fields)
        all.trees.push_back(
            cut_tree(field, cut_scale(std::cbrt(field.voxel_volume()) / finest_edge)));
    return all;
}

/// Cells of the smallest budget at which the soft, thresholded model has at most the error; of the
/// default at most default_count.
FieldCells search(MomentJob& job, const FieldTrees& all, const ErrorViews& views,
                  FieldEmSolver& em) {
    const double target = job.error();
    std::size_t finest = 0;
    for (const CutTree& tree : all.trees) finest += finest_count(tree);
    std::size_t most = finest;
    if (job.options.error == 0) most = std::min(default_count(job.values()), finest);
    // Hard cells are made and measured in a tenth of the time of soft ones, and have a multiple of
    // their error: 1.6 to 2.3 times on smoke, cloud and fire, up to 3 on aquarius.
    constexpr double kHardOverSoft = 2;
    const double hard = job.soft_steps() > 0 ? kHardOverSoft : 1;
    const SearchStart start = search_start(hard * target, most, [&](std::size_t budget) {
        return measured_model(job, all.fields, views, best_cut(all.trees, budget)).error.worst;
    });
    FieldCells best;
    const auto error_of_budget = [&](std::size_t budget) {
        FieldCells cells = best_cut(all.trees, budget);
        em.run(cells, job.soft_steps());
        const RelativeError error = measured_model(job, all.fields, views, cells).error;
        if (error.worst <= target || budget >= most) {
            best = std::move(cells);
            job.report_error(error, views);
        }
        return error.worst;
    };
    smallest_budget(target, most, error_of_budget, start);
    job.report.stopped_by_count = most < finest && job.report.measured_error > target;
    job.clock.end_stage("search", 0.9);
    return best;
}

}  // namespace

Gaussians adaptive_model(MomentJob& job) {
    // Views before trees: the traversal holds a second copy of the voxels while it runs.
    std::optional<ErrorViews> views;
    if (!job.options.budget) {
        views.emplace(job.parts, job.box);
        job.clock.end_stage("reference", 0.2);
    }
    FieldTrees all = field_trees(job);
    job.clock.end_stage("octree", job.options.budget ? 0.2 : 0.3);
    FieldEmSolver em(all.fields, job.options.refine_seconds > 0);
    FieldCells cells =
        job.options.budget ? best_cut(all.trees, job.options.budget) : search(job, all, *views, em);
    all.trees = {};
    views.reset();
    if (!job.options.budget) return final_model(job, all.fields, em, std::move(cells));
    job.clock.end_stage("cut", 0.3);
    em.run(cells, job.soft_steps());
    job.clock.end_stage("soften", 0.9);
    return final_model(job, all.fields, em, std::move(cells));
}

}  // namespace vog::moments
