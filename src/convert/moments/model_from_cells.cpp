// model_from_cells.cpp: the mass threshold, refinement and conversion of cells to Gaussians.
#include <algorithm>
#include <chrono>
#include <utility>

#include "convert/moments/mass_threshold.h"
#include "convert/moments/moment_job.h"

namespace vog::moments {

Gaussians all_gaussians(const MomentJob& job, std::span<const LatticeField> fields,
                        FieldCells cells) {
    Gaussians model;
    for (std::size_t f = 0; f < fields.size(); ++f) {
        Gaussians part = std::move(cells[f]).to_gaussians(job.frame(fields[f].world_from_index));
        if (model.size() == 0)
            model = std::move(part);
        else
            append(model, part);
    }
    model.cutoff = kMomentCutoff;
    model.origin = job.origin();
    return model;
}

Gaussians thresholded_gaussians(MomentJob& job, std::span<const LatticeField> fields,
                                FieldCells cells) {
    MassThreshold threshold;
    const auto mass_of = [&](std::size_t field, std::size_t cell) {
        return static_cast<float>(cells[field].mass(cell) * job.voxels_in(fields[field]));
    };
    for (std::size_t f = 0; f < fields.size(); ++f)
        for (std::size_t n = 0; n < cells[f].size(); ++n) threshold.add(mass_of(f, n));
    threshold.sum_over(job.collective());
    const float least = threshold.least_mass(job.options.mass_threshold);
    threshold.write_to(job.report, job.data_mass);
    job.least_mass = double{least};

    for (std::size_t f = 0; f < fields.size(); ++f)
        cells[f].keep_if([&](std::size_t n) { return mass_of(f, n) >= least; });
    return all_gaussians(job, fields, std::move(cells));
}

MeasuredModel measured_model(MomentJob& job, std::span<const LatticeField> fields,
                             const ErrorViews& views, FieldCells cells) {
    MeasuredModel measured{thresholded_gaussians(job, fields, std::move(cells)), {}};
    measured.error = views.relative_l2(measured.model);
    return measured;
}

Gaussians final_model(MomentJob& job, std::span<const LatticeField> fields, FieldEmSolver& em,
                      FieldCells cells) {
    using Clock = std::chrono::steady_clock;
    if (job.options.refine_seconds > 0) {
        const auto end = Clock::now() + std::chrono::duration<double>(job.options.refine_seconds);
        cells = refine(job, fields, em, std::move(cells), [&] { return Clock::now() < end; });
    }
    return thresholded_gaussians(job, fields, std::move(cells));
}

}  // namespace vog::moments
