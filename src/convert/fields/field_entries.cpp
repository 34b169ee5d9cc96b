// field_entries.cpp: sums over a Gaussian's part of the voxels to its planes and residuals.
#include "convert/fields/field_entries.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "convert/moments/covariance_adjugate.h"
#include "core/paging.h"
#include "data/fields/field_limits.h"
#include "vog/error.h"

namespace vog::joint {

namespace {

float as_float(double number) {
    constexpr double kMost = std::numeric_limits<float>::max();
    return static_cast<float>(std::clamp(number, -kMost, kMost));
}
Vec3f as_floats(Vec3d v) { return {as_float(v.x), as_float(v.y), as_float(v.z)}; }

/// Residuals below this share of the field's range are rounding of floats.
constexpr double kRounding = 1e-6;

/// Range over all levels.
std::pair<double, double> range_of(const std::vector<VoxelField>& levels) {
    double lower = levels.front().lower, upper = levels.front().upper;
    for (const VoxelField& level : levels)
        lower = std::min(lower, level.lower), upper = std::max(upper, level.upper);
    return {lower, upper};
}

/// Whether a field is the volume's own values.
bool is_measure(const VoxelField& field) {
    const VoxelValues& values = field.component.front();
    return !field.is_vector() && values.leaf.empty() && values.tile.empty();
}

/// Background of all levels of the measure.
double background_of(const std::vector<VoxelField>& levels) {
    for (const VoxelField& level : levels)
        if (level.background != levels.front().background)
            throw Error(
                fmt::format("field '{}': backgrounds {} and {}, expected volumes of one background "
                            "(--set background-value=VALUE sets it)",
                            level.name, levels.front().background, level.background));
    return levels.front().background;
}

void set_scalar(ScalarField& field, std::size_t i, const Layout::Part& part,
                const WorldPlane& plane, const double* residuals, double mass) {
    const double unit{part.unit};
    field.value[i] = as_float(double{part.reference} + unit * plane.value);
    field.gradient[i] = as_floats(unit * plane.gradient);
    if (!(mass > 0)) return;
    const double variance = std::max(residuals[0] / mass, 0.0), r = std::sqrt(variance);
    if (r < kRounding) return;
    constexpr double kMostSkewness = 3;
    field.deviation[i] = as_float(unit * r);
    field.skewness[i] = static_cast<float>(
        std::clamp(residuals[1] / (mass * variance * r), -kMostSkewness, kMostSkewness));
}

void set_vector(VectorField& field, std::size_t i, const Layout::Part& part,
                const WorldPlane* planes, const double* residuals, double mass) {
    const double unit{part.unit};
    for (std::size_t c = 0; c < 3; ++c) {
        field.value[i][static_cast<int>(c)] = as_float(unit * planes[c].value);
        field.gradient[c][i] = as_floats(unit * planes[c].gradient);
    }
    if (!(mass > 0)) return;
    for (std::size_t n = 0; n < kVectorSums; ++n)
        field.covariance[i][n] = as_float(unit * unit * (residuals[n] / mass));
}

}  // namespace

Layout::Layout(std::span<const std::vector<VoxelField>> fields) {
    for (std::size_t f = 0; f < fields.size(); ++f) {
        const VoxelField& field = fields[f].front();
        first_part.push_back(parts.size());
        first_sum.push_back(residual_sums);
        residual_sums += field.is_vector() ? kVectorSums : kScalarSums;
        const auto [lower, upper] = range_of(fields[f]);
        // A vector's range is that of its magnitude: components lie on both sides of 0.
        const double middle = field.is_vector() ? 0 : 0.5 * (lower + upper);
        const double half = field.is_vector() ? upper : 0.5 * (upper - lower);
        const double unit = half > 0 ? std::exp2(std::clamp(std::ilogb(half), -120, 120)) : 1;
        for (std::size_t c = 0; c < field.component.size(); ++c)
            parts.push_back({f, c, static_cast<float>(middle), static_cast<float>(unit)});
    }
}

std::vector<Component> Layout::components(const Volume& volume,
                                          std::span<const std::vector<VoxelField>> fields,
                                          std::size_t level) const {
    std::vector<Component> all;
    for (const Part& part : parts) {
        const VoxelField& field = fields[part.field][level];
        // The volume has its own values without the background.
        const double background = is_measure(field) ? field.background : 0;
        all.push_back({&volume, &field.component[part.component],
                       static_cast<float>(double{part.reference} - background), part.unit});
    }
    return all;
}

Vec3d least_squares(std::array<double, 6> covariance, Vec3d with) {
    // In units of the spread, whose squares may leave the range of doubles otherwise.
    const double trace = covariance[0] + covariance[3] + covariance[5];
    if (!(trace > 0)) return {};
    for (double& entry : covariance) entry /= trace;
    const auto [a, det] = moments::adjugate_of(covariance);
    if (!(det > 0)) return {};
    const Vec3d w = (1 / trace) * with;
    return (1 / det) * Vec3d{a[0] * w.x + a[1] * w.y + a[2] * w.z,
                             a[1] * w.x + a[3] * w.y + a[4] * w.z,
                             a[2] * w.x + a[4] * w.y + a[5] * w.z};
}

FieldEntries::FieldEntries(std::span<const std::vector<VoxelField>> fields, const Layout& layout,
                           std::size_t gaussians)
    : fields_(fields), layout_(layout), scalar_(fields.size()), vector_(fields.size()) {
    for (std::size_t f = 0; f < fields.size(); ++f) {
        const VoxelField& about = fields[f].front();
        const auto describe = [&](auto& field) {
            field.name = about.name, field.unit = about.unit;
            std::tie(field.lower, field.upper) = range_of(fields[f]);
            resize_kept(field.value, gaussians);
        };
        if (about.is_vector()) {
            VectorField& field = vector_[f];
            describe(field);
            resize_kept(field.covariance, gaussians);
            for (auto& gradient : field.gradient) resize_kept(gradient, gaussians);
        } else {
            ScalarField& field = scalar_[f];
            describe(field);
            field.is_measure = std::ranges::all_of(fields[f], is_measure);
            if (field.is_measure) field.background = background_of(fields[f]);
            ValueCounts counts;
            for (const VoxelField& level : fields[f]) counts.add(level.counts);
            field.spread = counts.spread();
            resize_kept(field.gradient, gaussians);
            resize_kept(field.deviation, gaussians), resize_kept(field.skewness, gaussians);
        }
    }
}

void FieldEntries::set(std::size_t i, const WorldPlane* planes, const double* residuals,
                       double mass) {
    for (std::size_t f = 0; f < fields_.size(); ++f) {
        const std::size_t part = layout_.first_part[f];
        const double* of_field = residuals + layout_.first_sum[f];
        if (fields_[f].front().is_vector())
            set_vector(vector_[f], i, layout_.parts[part], planes + part, of_field, mass);
        else
            set_scalar(scalar_[f], i, layout_.parts[part], planes[part], of_field, mass);
    }
}

void FieldEntries::move_to(Gaussians& model) && {
    for (std::size_t f = 0; f < fields_.size(); ++f)
        if (fields_[f].front().is_vector())
            model.fields.vector.push_back(std::move(vector_[f]));
        else
            model.fields.scalar.push_back(std::move(scalar_[f]));
    limit_planes(model);
}

}  // namespace vog::joint
