// divided_models.cpp: parts of models, their common ranges, and joint moments of their maps.
#include "fields/divided_models.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace vog::cli {

namespace {

using Packets = std::vector<std::vector<float>>;  ///< [ranks]

/// Sets the range of a field to that over all ranks.
template <class Field>
void share_range(Field& field, const RenderRanks& ranks) {
    double ends[2] = {-field.lower, field.upper};
    ranks.collective.max(ends);
    field.lower = -ends[0], field.upper = ends[1];
}

/// Joint column, mean and deviation of one pixel, in double precision.
struct JointMoments {
    double column = 0, mean = 0,
           second = 0;  ///< sums: of columns, and of these times mean and square

    void add(float part_column, float part_mean) {
        if (!(part_column > 0) || std::isnan(part_mean)) return;
        column += double{part_column};
        mean += double{part_column} * double{part_mean};
    }
    /// Squares about the joint mean: nothing cancels.
    void add_square(float part_column, float part_mean, float deviation, double joint) {
        if (!(part_column > 0) || std::isnan(part_mean)) return;
        const double from = double{part_mean} - joint;
        second += double{part_column} * (double{deviation} * double{deviation} + from * from);
    }
};

/// Joins pixels first ... first + count - 1.
/// from  [ranks][3][count]
void join(const Packets& from, std::size_t first, std::size_t count, FieldMaps& maps) {
    for (std::size_t n = 0; n < count; ++n) {
        JointMoments sums;
        for (const std::vector<float>& part : from) sums.add(part[n], part[count + n]);
        const std::size_t at = first + n;
        maps.column[at] = static_cast<float>(sums.column);
        if (!(sums.column > 0)) {
            maps.mean[at] = maps.deviation[at] = std::numeric_limits<float>::quiet_NaN();
            continue;
        }
        const double mean = sums.mean / sums.column;
        for (const std::vector<float>& part : from)
            sums.add_square(part[n], part[count + n], part[2 * count + n], mean);
        maps.mean[at] = static_cast<float>(mean);
        maps.deviation[at] = static_cast<float>(std::sqrt(sums.second / sums.column));
    }
}

}  // namespace

void require_addable(const RenderArguments& arguments, const Drawing& drawing,
                     const RenderRanks& ranks) {
    if (!ranks.divided()) return;
    const std::string show = "--show " + arguments.quantity.show;
    const DrawingArguments& given = arguments.drawing;
    const bool samples = !arguments.quantity.of_field() || given.step_voxels > 0;
    if (drawing.kind == FileKind::volume && given.interpolation == "linear" && samples)
        throw CLI::ValidationError(fmt::format(
            "{} with --interpolation linear: samples begin where a ray enters the whole volume, of "
            "which a rank holds a part; expected {}, or one process (vog render)",
            show,
            !arguments.quantity.of_field() ? "--interpolation constant"
                                           : "--step 0 (exact, cell by cell)"));
    if (drawing.renderer == Renderer::trace && !arguments.quantity.of_field())
        throw CLI::ValidationError(fmt::format(
            "--renderer trace: {} needs all Gaussians of a ray in their order, of which a rank "
            "holds a part; expected --renderer splat, or one process (vog render)",
            show));
}

Gaussians load_model_part(const RenderArguments& arguments, Drawing& drawing,
                          const RenderRanks& ranks, Hierarchy* hierarchy) {
    const std::vector<std::string>& inputs = arguments.drawing.inputs;
    const DrawingArguments& drawn = arguments.drawing;
    Gaussians model = ranks.divided()
                          ? ranks.load_models(inputs, drawn.volume.values)
                          : load_models(inputs, hierarchy, drawn.site_view, drawn.volume.values);
    double count = static_cast<double>(model.size());
    if (ranks.divided()) {
        ranks.collective.sum(count);
        for (ScalarField& field : model.fields.scalar) share_range(field, ranks);
        for (VectorField& field : model.fields.vector) share_range(field, ranks);
    }
    drawing.gaussians = static_cast<std::uint64_t>(count);
    drawing.subject = subject_of(model, &ranks.collective);
    set_primitives_text(drawing, 0);
    return model;
}

void join_maps(FieldMaps& maps, const RenderRanks& ranks) {
    if (!ranks.divided()) return;
    // A run at a time: the root holds it of every rank.
    constexpr std::size_t kRun = std::size_t{1} << 18;
    for (std::size_t first = 0; first < maps.column.size(); first += kRun) {
        const std::size_t count = std::min(kRun, maps.column.size() - first);
        Packets to(static_cast<std::size_t>(ranks.collective.count));
        for (const std::vector<float>* map : {&maps.column, &maps.mean, &maps.deviation}) {
            const std::span<const float> run = std::span(*map).subspan(first, count);
            to.front().insert(to.front().end(), run.begin(), run.end());
        }
        const Packets from = ranks.collective.exchange(to);
        if (ranks.is_root) join(from, first, count, maps);
    }
}

}  // namespace vog::cli
