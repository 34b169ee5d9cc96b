// refine.cpp: --refine: cells go where pictures err, as long as they err less.
#include <algorithm>
#include <utility>

#include "convert/moments/moment_job.h"
#include "convert/moments/refine/split_merge.h"

namespace vog::moments {

namespace {

using Clock = std::chrono::steady_clock;

/// The error of each cell of each field.
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

FieldCells refined(MomentJob& job, std::span<const LatticeField> fields, FieldEmSolver& softener,
                   FieldCells cells) {
    const auto end = Clock::now() + std::chrono::duration<double>(job.options.refine_seconds);
    const ErrorViews views(job.parts, job.box);
    std::vector<VisibilityWeight> seen;
    for (const LatticeField& field : fields) seen.emplace_back(field);

    FieldCells best;
    double least = 0, error = 0, most = 0;
    /// Takes cells that err less than the best so far, if their T does not err more than it may.
    const auto keeps = [&](const FieldCells& tried) {
        const MeasuredModel found = measured_model(job, fields, views, tried);
        const double visible = views.visible_rms(found.model);
        if (!best.empty() && (visible >= least || found.error > most)) return false;
        best = tried, least = visible, error = found.error;
        return true;
    };
    keeps(cells);
    most =
        job.options.block_voxels || job.options.budget ? error : std::max(error, job.options.error);
    // Steps alone once, then exchanges, smaller ones where larger do not help.
    constexpr int kSteps = 16;
    constexpr double kShare = 0.1, kLeastShare = 0.01;
    double share = 0;
    while (Clock::now() < end) {
        if (share > 0) {
            cells = best;
            const auto errors = cell_errors(job, fields, views, cells);
            for (std::size_t f = 0; f < fields.size(); ++f)
                split_and_merge(cells[f], errors[f], share, seen[f]);
            softener.forget();
        }
        for (int n = 0; n < kSteps && Clock::now() < end; ++n) softener.step(cells);
        if (keeps(cells) && share > 0) continue;
        if (share == 0)
            share = kShare;
        else if ((share *= 0.5) < kLeastShare)
            break;
    }
    job.report.measured_error = error;
    job.clock.end_stage("refine", 1);
    return best;
}

}  // namespace vog::moments
