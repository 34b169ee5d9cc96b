// convert_cells.cpp: models of cells, by budget or error.
#include "vog/convert_cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "compare/error_views.h"
#include "convert/lod/coarsener.h"
#include "convert/moments/error_search.h"
#include "convert/moments/stage_clock.h"
#include "convert/unstructured/cell_model.h"
#include "data/fields/field_limits.h"
#include "render/reference/cells/cell_rays.h"
#include "vog/conversion_schema.h"
#include "vog/error.h"

namespace vog {

using namespace comparison;
using namespace moments;

namespace {

void check(const CellOptions& options) {
    if (options.budget && options.error != 0)
        throw Error("cells: budget and error exclude each other");
    ConversionOptions values;
    values.moments.error = options.error;
    check_values(values);
}

/// The model of the fewest Gaussians with the error, or of the default.
Gaussians searched_model(const Gaussians& finest, lod::Coarsener& coarsener,
                         const ErrorViews& views, const CellOptions& options,
                         MomentReport& report) {
    const double target = options.error > 0 ? options.error : kDefaultError;
    const std::size_t most =
        options.error > 0 ? finest.size() : std::min(default_count(finest.size()), finest.size());
    std::optional<Gaussians> best;
    smallest_budget(target, most,
                    [&](std::size_t budget) {
                        Gaussians tried = coarsener.model(budget);
                        const RelativeError error = views.relative_l2(tried);
                        if (error.worst <= target || budget >= most) {
                            best = std::move(tried);
                            report.measured_error = error.worst, report.mean_error = error.mean;
                        }
                        return error.worst;
                    },
                    {});
    report.stopped_by_count =
        options.error == 0 && most < finest.size() && report.measured_error > target;
    return std::move(*best);
}

}  // namespace

Gaussians convert_cells(const Cells& cells, const CellOptions& options, CellNotes* notes,
                        MomentReport* report) {
    MomentReport unwanted;
    MomentReport& result = report ? *report : unwanted;
    result = {};
    StageClock clock(result, options.progress);
    check(options);
    // Not this call's own.
    CellModel all =
        cell_model({std::shared_ptr<void>(), &cells}, options.own_field, options.clip_negative);
    if (notes) *notes = all.notes;
    clock.end_stage("cells", 0.4);

    const bool searches = !options.budget;
    std::optional<ErrorViews> views;
    Gaussians model;
    {
        const Gaussians finest = std::move(all.model);
        lod::Coarsener coarsener(finest, true);
        if (searches || options.measure) {
            const reference::CellRays rays(cells, all.source.kept);
            views.emplace(finest, [&](const Camera& camera) {
                return render_cells_reference(rays, camera, kErrorViewSize_px, kErrorViewSize_px);
            });
            result.view_note = views->note();
            clock.end_stage("reference", 0.5);
        }
        model = searches ? searched_model(finest, coarsener, *views, options, result)
                         : coarsener.model(options.budget);
    }
    if (options.measure && !searches) {
        const RelativeError error = views->relative_l2(model);
        result.measured_error = error.worst, result.mean_error = error.mean;
    }
    // Not before: joint moments of coarser models are those of the planes that cells have.
    limit_planes(model);
    clock.end_stage("cut", 1);
    result.mass_ratio = mass(model) / all.mass;
    model.method = "moments";
    model.options = options.budget      ? fmt::format("--budget {}", options.budget)
                    : options.error > 0 ? fmt::format("--error {}", options.error)
                                        : "";
    model.summary = summary_text(model, result, "cells");
    return model;
}

}  // namespace vog
