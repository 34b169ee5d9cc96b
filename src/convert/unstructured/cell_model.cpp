// cell_model.cpp: moments of each cell and of its fields, as a Gaussian.
#include "convert/unstructured/cell_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "convert/lod/coarsener.h"
#include "convert/lod/field_moments.h"
#include "convert/moments/gaussian_moments.h"
#include "core/parallel.h"
#include "data/cells/cell_moments.h"
#include "data/fields/field_limits.h"
#include "vog/convert_cells.h"
#include "vog/error.h"
#include "vog/scene.h"
#include "vog/value_counts.h"

namespace vog {

using namespace moments;
using namespace unstructured;

namespace {

std::string name_of(const Cells& cells) { return cells.source.empty() ? "cells" : cells.source; }

enum class CellState : std::uint8_t { empty, whole, inverted, flat, nonfinite, other };

/// Moments of a cell with mass, world units.
struct MeasuredCell {
    CellState state = CellState::other;
    Moments moments{};
};

bool finite(const Cells& cells, std::size_t n) {
    for (std::uint64_t k = n ? cells.end[n - 1] : 0; k < cells.end[n]; ++k) {
        const Vec3d p = cells.points[cells.corner[k]];
        if (!std::isfinite(p.x + p.y + p.z)) return false;
    }
    const auto all = [&](const CellValues& values) {
        for (const BigVector<float>& component : values.component) {
            if (!values.at_points && !std::isfinite(component[n])) return false;
            for (std::uint64_t k = n ? cells.end[n - 1] : 0; values.at_points && k < cells.end[n];
                 ++k)
                if (!std::isfinite(component[cells.corner[k]])) return false;
        }
        return true;
    };
    return all(cells.density) && std::ranges::all_of(cells.fields, all);
}

/// Corners of a cell; of clipped densities where they are negative.
Shape clipped_shape(const Cells& cells, std::size_t n) {
    Shape shape = shape_of(cells, n);
    for (Corner& corner : shape.corner) corner.density = std::max(corner.density, 0.0);
    return shape;
}

MeasuredCell measured(const Cells& cells, std::size_t n) {
    if (corner_count(cells.type[n]) == 0) return {};
    if (!finite(cells, n)) return {CellState::nonfinite};
    const Shape shape = clipped_shape(cells, n);
    if (shape.corners == 0) return {};
    CellIntegrals sums = integrals_of(shape, 0);
    double reach = 0;
    for (std::size_t k = 0; k < shape.corners; ++k)
        reach = std::max(reach, length(shape.corner[k].place));
    constexpr double kFlat = 1e-15;  // volumes below are rounding
    if (!(std::abs(sums.volume) > kFlat * reach * reach * reach)) return {CellState::flat};
    const double sign = sums.volume < 0 ? -1 : 1;
    const bool inverted = (sign < 0 && shape.is_mirrored_if_negative) || sums.tangled;
    if (!(sign * sums.mass > 0)) return {CellState::empty};
    const Vec3d m = 1 / sums.mass * sums.first;
    Moments moments{sign * sums.mass, m + shape.centre, sums.second};
    const std::array<double, 6> squares{m.x * m.x, m.x * m.y, m.x * m.z,
                                        m.y * m.y, m.y * m.z, m.z * m.z};
    for (std::size_t k = 0; k < 6; ++k)
        moments.covariance[k] = sums.second[k] / sums.mass - squares[k];
    for (const std::size_t k : {0, 3, 5})
        moments.covariance[k] = std::max(moments.covariance[k], 0.0);
    return {inverted ? CellState::inverted : CellState::whole, moments};
}

/// throws vog::Error for negative densities, unless they are clipped
void check_density(const Cells& cells, bool clip_negative) {
    const BigVector<float>& density = cells.density.component.front();
    std::size_t negative = 0, first = 0;
    for (std::size_t n = density.size(); n-- > 0;)
        if (density[n] < 0) ++negative, first = n;
    if (negative && !clip_negative)
        throw Error(
            fmt::format("{}: '{}' has {} negative value{}, the first {} at {} {}, expected 0 or "
                        "more (negative ones can be clipped to 0)",
                        name_of(cells), cells.density.name, negative, negative == 1 ? "" : "s",
                        density[first], cells.density.at_points ? "point" : "cell", first));
}

/// A field of cells, as joint moments of Gaussian i, which is that of cell n.
template <std::size_t components>
lod::FieldMoments<components> joint_moments(const Cells& cells, std::size_t n,
                                            const CellValues& values, const Moments& of) {
    Shape shape = clipped_shape(cells, n);
    const auto offset = set_values(shape, cells, n, values);
    const CellIntegrals sums = integrals_of(shape, components);
    const Vec3d mean = of.mean - shape.centre;
    lod::FieldMoments<components> moments;
    std::array<double, components> value{};
    for (std::size_t a = 0; a < components; ++a) {
        value[a] = sums.value[a] / sums.mass;
        moments.value[a] = offset[a] + value[a];
        moments.cross[a] = 1 / sums.mass * sums.cross[a] - value[a] * mean;
    }
    for (std::size_t a = 0, k = 0; a < components; ++a)
        for (std::size_t b = a; b < components; ++b, ++k)
            moments.covariance[k] = sums.square[k] / sums.mass - value[a] * value[b];
    lod::set_plane(moments, lod::Merger(of, {}).precision);
    return moments;
}

/// Adds a field to the model of one Gaussian a cell.
/// kept  cell of each Gaussian
void add_field(Gaussians& model, const Cells& cells, const CellValues& values, bool is_measure,
               const BigVector<std::uint32_t>& kept, const BigVector<MeasuredCell>& all) {
    const std::size_t size = kept.size();
    double lower = std::numeric_limits<double>::infinity(), upper = -lower;
    for (const std::uint32_t n : kept)
        for (std::uint64_t k = n ? cells.end[n - 1] : 0; k < cells.end[n]; ++k) {
            const std::size_t at = values.at_points ? cells.corner[k] : n;
            double square = 0;
            for (const auto& component : values.component)
                square += double{component[at]} * double{component[at]};
            const double value =
                values.component.size() == 1 ? double{values.component[0][at]} : std::sqrt(square);
            lower = std::min(lower, value), upper = std::max(upper, value);
        }
    if (values.component.size() == 3) {
        VectorField field{values.name, values.unit, lower, upper, {}, {}, {}};
        field.value.resize(size), field.covariance.resize(size);
        for (auto& gradient : field.gradient) gradient.resize(size);
        vog::parallel_for(std::size_t{0}, size, [&](std::size_t i) {
            lod::set_field(field, i,
                           joint_moments<3>(cells, kept[i], values, all[kept[i]].moments));
        });
        model.fields.vector.push_back(std::move(field));
        return;
    }
    ScalarField field{values.name, values.unit, lower, upper, is_measure, {}, {}, {}, {}, {}};
    field.value.resize(size), field.gradient.resize(size);
    field.deviation.resize(size), field.skewness.resize(size);
    vog::parallel_for(std::size_t{0}, size, [&](std::size_t i) {
        lod::set_field(field, i, joint_moments<1>(cells, kept[i], values, all[kept[i]].moments));
    });
    ValueCounts counts;
    for (std::size_t i = 0; i < size; ++i) counts.add(field.value[i], all[kept[i]].moments.mass);
    field.spread = counts.spread();
    model.fields.scalar.push_back(std::move(field));
}

}  // namespace

CellModel cell_model(std::shared_ptr<const Cells> given, bool own_field, bool clip_negative) {
    const Cells& cells = *given;
    validate(cells);
    check_density(cells, clip_negative);
    BigVector<MeasuredCell> all(cells.size());
    vog::parallel_for(std::size_t{0}, cells.size(),
                      [&](std::size_t n) { all[n] = measured(cells, n); });
    CellModel made;
    made.source.cells = std::move(given);
    CellNotes& notes = made.notes;
    BigVector<std::uint32_t>& kept = made.source.kept;
    for (std::size_t n = 0; n < all.size(); ++n) {
        const CellState state = all[n].state;
        notes.inverted += state == CellState::inverted;
        notes.flat += state == CellState::flat;
        notes.nonfinite += state == CellState::nonfinite;
        notes.others += state == CellState::other;
        if (state != CellState::whole && state != CellState::inverted) continue;
        kept.push_back(static_cast<std::uint32_t>(n));
        made.mass += all[n].moments.mass;
    }
    if (kept.empty())
        throw Error(fmt::format("{}: no cell with mass{}", name_of(cells),
                                notes.others ? ", of types or surfaces without a volume" : ""));
    Gaussians& model = made.model;
    model.cutoff = kMomentCutoff;
    model.box = bounds(cells);
    model.origin = model_origin(model.box);
    resize(model, kept.size(), false);
    const MomentFrame frame = moment_frame({}, false, 1);
    vog::parallel_for(std::size_t{0}, kept.size(), [&](std::size_t i) {
        Moments of = all[kept[i]].moments;
        of.mean = of.mean - model.origin;
        set_gaussian(model, i, of, frame);
    });
    check_density_range(model, name_of(cells));
    for (const CellValues& field : cells.fields) add_field(model, cells, field, false, kept, all);
    if (own_field) add_field(model, cells, cells.density, true, kept, all);
    model.content = content_of(made.source, model.box);
    model.source_voxels = cells.size();
    model.source = std::filesystem::path(cells.source).filename().string();
    model.source += (model.source.empty() ? "" : " ") + cells.density.name;
    return made;
}

Scene scene_of(std::shared_ptr<const Cells> cells, CellNotes* notes) {
    CellModel made = cell_model(std::move(cells), true, false);
    if (notes) *notes = made.notes;
    Scene scene;
    auto model = std::make_shared<const Gaussians>(std::move(made.model));
    scene.subject = subject_of(*model);
    scene.name = made.source.cells->source;
    auto drawn = std::make_shared<const CellSource>(std::move(made.source));
    scene.sources.push_back(ModelSource{std::move(model), nullptr, std::move(drawn)});
    return scene;
}

}  // namespace vog
