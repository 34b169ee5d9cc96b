// refine.cpp: --refine: split-and-merge where rendered views err, EM steps, rounds kept or undone.
#include <algorithm>
#include <utility>

#include "convert/moments/moment_job.h"
#include "convert/moments/refine/split_merge.h"

namespace vog::moments {

namespace {

/// Squared error attributed to each cell, [field][cell].
std::vector<std::vector<float>> cell_errors(const MomentJob& job,
                                            std::span<const LatticeField> fields,
                                            const ErrorViews& views, const FieldCells& cells) {
    const std::vector<float> all = views.error_of_each_gaussian(all_gaussians(job, fields, cells));
    std::vector<std::vector<float>> errors;
    auto first = all.begin();
    for (const PackedCells& field : cells) {
        const auto end = first + static_cast<std::ptrdiff_t>(field.size());
        errors.emplace_back(first, end);
        first = end;
    }
    return errors;
}

}  // namespace

FieldCells refine(MomentJob& job, std::span<const LatticeField> fields, FieldEmSolver& em,
                  FieldCells cells, const std::function<bool()>& go_on) {
    const ErrorViews views(job.parts, job.box, job.options.periodic);
    std::vector<VisibilityWeight> visibility;
    for (const LatticeField& field : fields) visibility.emplace_back(field);

    FieldCells best;
    double least_visible = 0, error_limit = 0;
    RelativeError error;
    /// Keeps cells with a lower visible error, unless their relative L2 exceeds its limit.
    const auto keep_if_better = [&](const FieldCells& tried) {
        const MeasuredModel measured = measured_model(job, fields, views, tried);
        const double visible = views.visible_rms(measured.model);
        if (!best.empty() && (visible >= least_visible || measured.error.worst > error_limit))
            return false;
        best = tried, least_visible = visible, error = measured.error;
        return true;
    };
    keep_if_better(cells);
    error_limit = job.options.block_voxels || job.options.budget
                      ? error.worst
                      : std::max(error.worst, job.error());
    // The first round is EM alone. The share of cells that a round splits is halved whenever the
    // round did not help, down to a hundredth.
    constexpr int kSteps = 16;
    constexpr double kShare = 0.1, kLeastShare = 0.01;
    double share = 0;
    while (go_on()) {
        if (share > 0) {
            cells = best;
            const auto errors = cell_errors(job, fields, views, cells);
            for (std::size_t f = 0; f < fields.size(); ++f)
                split_and_merge(cells[f], errors[f], share, visibility[f]);
            em.reset_momentum();
        }
        for (int n = 0; n < kSteps && go_on(); ++n) em.step(cells);
        if (keep_if_better(cells) && share > 0) continue;
        if (share == 0)
            share = kShare;
        else if ((share *= 0.5) < kLeastShare)
            break;
    }
    job.report_error(error, views.interpolation(job.parts), views);
    job.clock.end_stage("refine", 1);
    return best;
}

}  // namespace vog::moments
