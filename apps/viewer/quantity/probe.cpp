// probe.cpp: the sums of a pixel in words; marching along one ray.
#include "quantity/probe.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "vog/picture.h"

namespace vog::viewer {

namespace {

constexpr double kHalf = 0.6931471805599453;  ///< optical depth of a transmittance of a half
constexpr int kMostSteps = 20000;

/// A Gaussian met by the ray.
struct Met {
    double first, last;      ///< of its support, distances
    double nearest, spread;  ///< of its density along the ray: a normal distribution, distances
    double peak;             ///< largest density on the ray
    double value, slope;     ///< of its plane at `nearest`, and per distance
};

/// Gaussians along a ray whose direction has length 1, by the beginning of their supports.
std::vector<Met> met_by(const Gaussians& gaussians, const ScalarField& field, Vec3d origin,
                        Vec3d direction, RayInterval kept) {
    std::vector<Met> all;
    const double k2 = double{gaussians.cutoff} * double{gaussians.cutoff};
    const Vec3d from = origin - gaussians.origin;
    for (std::size_t i = 0; i < gaussians.size(); ++i) {
        const Vec3d mean = vec_cast<double>(gaussians.mean[i]);
        const Vec3d scale = vec_cast<double>(gaussians.scale[i]);
        Vec3d e = mean - from, d = direction;
        // A ball around the support first: most are far from the ray.
        const double along = dot(e, d);
        const double reach = double{gaussians.cutoff} * std::max({scale.x, scale.y, scale.z});
        if (dot(e, e) - along * along > reach * reach) continue;
        if (!gaussians.axis_aligned()) {
            const Mat3 own = transpose(matrix_from_quat(gaussians.rotation[i]));
            e = own * e, d = own * d;
        }
        for (int axis = 0; axis < 3; ++axis) e[axis] /= scale[axis], d[axis] /= scale[axis];
        const double c = dot(d, d), nearest = dot(e, d) / c;
        const double m2 = dot(e, e) - c * nearest * nearest;
        if (!(m2 < k2)) continue;
        const double spread = 1 / std::sqrt(c), half = std::sqrt(k2 - m2) * spread;
        const double first = std::max(nearest - half, kept.first);
        const double last = std::min(nearest + half, kept.last);
        if (first >= last) continue;
        const Vec3d gradient = vec_cast<double>(field.gradient[i]);
        const Vec3d aside = from + nearest * direction - mean;
        all.push_back({first, last, nearest, spread,
                       double{gaussians.density[i]} * std::exp(-0.5 * std::max(m2, 0.0)),
                       double{field.value[i]} + dot(gradient, aside), dot(gradient, direction)});
    }
    std::ranges::sort(all, {}, &Met::first);
    return all;
}

}  // namespace

std::optional<OpaqueValue> first_opaque_value(const Gaussians& gaussians, const ScalarField& field,
                                              const ValueTransfer& transfer, const Clipping& clip,
                                              Vec3d origin, Vec3d direction) {
    const Vec3d along = (1 / length(direction)) * direction;
    const RayInterval kept = clipped_ray(clip, origin, along);
    if (kept.first >= kept.last) return std::nullopt;
    const std::vector<Met> met = met_by(gaussians, field, origin, along, kept);
    std::vector<const Met*> here;
    std::size_t next = 0;
    double depth = 0;
    double at = met.empty() ? 0 : met.front().first;
    for (int n = 0; n < kMostSteps; ++n) {
        while (next < met.size() && met[next].first <= at) here.push_back(&met[next++]);
        std::erase_if(here, [&](const Met* each) { return each->last <= at; });
        if (here.empty()) {
            if (next == met.size()) return std::nullopt;
            at = met[next].first;
            continue;
        }
        double step = std::numeric_limits<double>::infinity();
        for (const Met* each : here) step = std::min(step, 0.25 * each->spread);
        const double middle = at + 0.5 * step;
        double measure = 0, sum = 0;
        for (const Met* each : here) {
            const double z = (middle - each->nearest) / each->spread;
            const double density = each->peak * std::exp(-0.5 * z * z);
            measure += density;
            sum += density * (each->value + each->slope * (middle - each->nearest));
        }
        if (measure > 0) {
            const double value = sum / measure;
            depth += step * light_of(transfer, value).extinction * (field.is_measure ? 1 : measure);
            if (depth >= kHalf) return OpaqueValue{value, middle};
        }
        at += step;
    }
    return std::nullopt;
}

std::string probe_text(const Quantity& quantity, const Fields& fields, const Sums& numbers,
                       std::size_t pixel, float most, double extinction) {
    const double column = numbers.column.empty() ? 1 : double{numbers.column[pixel]};
    if (quantity.show == Show::depth)
        return fmt::format("T {:.4g}, V {:.4g}", column * extinction,
                           -std::expm1(-column * extinction));
    if (quantity.show == Show::column) return fmt::format("column density {:.4g}", column);
    const bool largest = is_by_value(quantity.show);
    const std::vector<float>& shown = largest ? numbers.maximum : numbers.mean;
    if (shown.empty() || !std::isfinite(shown[pixel]) || !(column > kLeastColumn * double{most}))
        return "";
    const ScalarField* scalar = fields.find_scalar(quantity.field.field);
    const VectorField* vector = fields.find_vector(quantity.field.field);
    const std::string name = scalar ? scalar->unit : vector ? vector->unit : "";
    const std::string label = field_label(quantity.field), of = name.empty() ? "" : " " + name;
    if (largest)
        return fmt::format("{} {:.4g}{}", quantity_label(quantity.show, label), shown[pixel], of);
    if (quantity.field.part == FieldPart::magnitude)
        return fmt::format("{} {:.4g}{}, column density {:.4g}", label, shown[pixel], of, column);
    return fmt::format("{}: mean {:.4g}, deviation {:.4g}{}, column density {:.4g}", label,
                       shown[pixel], numbers.deviation[pixel], of, column);
}

std::string opaque_text(const Quantity& quantity, const Fields& fields,
                        const std::optional<OpaqueValue>& found) {
    if (!found) return "clear";
    const ScalarField* field = fields.find_scalar(quantity.field.field);
    const std::string unit = field && !field->unit.empty() ? " " + field->unit : "";
    return fmt::format("{} {:.4g}{} where half is absorbed, at distance {:.4g}",
                       field_label(quantity.field), found->value, unit, found->distance);
}

}  // namespace vog::viewer
