// model_from_cells.cpp: from cells to the model.
#include <algorithm>
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
    return model;
}

Gaussians gaussians_of(MomentJob& job, std::span<const LatticeField> fields, FieldCells cells) {
    MassThreshold light;
    const auto mass_of = [&](std::size_t field, std::size_t cell) {
        return static_cast<float>(cells[field].mass(cell) * job.voxels_in(fields[field]));
    };
    for (std::size_t f = 0; f < fields.size(); ++f)
        for (std::size_t n = 0; n < cells[f].size(); ++n) light.add(mass_of(f, n));
    light.sum_over(job.collective());
    const float least = light.least_mass(job.options.mass_threshold);
    light.tell(job.data_mass, job.report);

    for (std::size_t f = 0; f < fields.size(); ++f)
        cells[f].keep_if([&](std::size_t n) { return mass_of(f, n) >= least; });
    return all_gaussians(job, fields, std::move(cells));
}

MeasuredModel measured_model(MomentJob& job, std::span<const LatticeField> fields,
                             const ErrorViews& views, FieldCells cells) {
    MeasuredModel measured{gaussians_of(job, fields, std::move(cells))};
    measured.error = views.relative_l2(measured.model);
    return measured;
}

Gaussians finished(MomentJob& job, std::span<const LatticeField> fields, FieldEmSolver& softener,
                   FieldCells cells) {
    if (job.options.refine_seconds == 0) return gaussians_of(job, fields, std::move(cells));
    return gaussians_of(job, fields, refined(job, fields, softener, std::move(cells)));
}

}  // namespace vog::moments
