// choose_transfer.cpp: transfer function of a volume picture, and its unit distance.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "data/fields/field_limits.h"
#include "render/reference/fields/field_grid.h"
#include "vog/error.h"
#include "vog/picture.h"

namespace vog {

namespace {

/// Rounded to some digits, so that a text of them repeats the picture.
double rounded(double value, int digits) {
    return std::stod(fmt::format("{:.{}g}", value, digits));
}

/// Whether a field at voxels is the volume's own values.
bool is_measure(const VoxelField& field) {
    return field.component.front().leaf.empty() && field.component.front().tile.empty();
}

/// Adds the values of Gaussian i: seven of equal weight, of a normal distribution.
void add_values(const Gaussians& gaussians, const ScalarField& field, std::size_t i, double mass,
                ValueCounts& counts) {
    constexpr double kAt[7] = {-1.465, -0.792, -0.366, 0, 0.366, 0.792, 1.465};
    const double deviation =
        std::hypot(double{field.deviation[i]}, std::sqrt(plane_variance(gaussians, field, i)));
    for (const double at : kAt) {
        const double value = double{field.value[i]} + at * deviation;
        counts.add(static_cast<float>(std::clamp(value, field.lower, field.upper)), mass / 7);
    }
}

/// throws  vog::Error for values that are all outside the data
void require_inside(const TransferRequest& request, const ValueData& data) {
    const auto require = [&](const std::string& what, double lower, double upper) {
        if (lower <= data.upper && upper > data.lower) return;
        throw Error(fmt::format("{} is outside the data's values, {:.6g} to {:.6g}", what,
                                data.lower, data.upper));
    };
    if (const auto& window = request.window)
        require(fmt::format("the window {},{}", window->first, window->second),
                window->first - window->second / 2, HUGE_VAL);
    for (const ValueBand& band : request.bands) {
        if (!std::isinf(band.upper)) {
            require(fmt::format("the band from {} to {}", band.lower, band.upper), band.lower,
                    band.upper);
            continue;
        }
        // Densities have a surface towards empty space, too, which has the background.
        const bool encloses =
            band.lower >= data.lower || (data.is_measure && band.lower > data.background);
        require(fmt::format("the surface at {}", band.lower), encloses ? band.lower : HUGE_VAL,
                HUGE_VAL);
    }
}

/// The spread, of values as near to each other as the bins of ValueCounts by all that is known: within two bins, and in the data where
/// these have no others.
ValueSpread spread_of(const ValueData& data) {
    ValueSpread spread = data.spread;
    const double largest = std::max(std::abs(spread.low), std::abs(spread.high));
    const bool is_one = data.upper - data.lower <= 1e-6 * largest;  // value, but for rounding
    if (!spread.known || is_one || spread.high - spread.low > largest / 32) return spread;
    spread.low -= largest / 64, spread.high += largest / 64;
    if (data.upper - data.lower <= largest / 32)
        spread.low = std::max(spread.low, data.lower),
        spread.high = std::min(spread.high, data.upper);
    spread.middle = 0.5 * (spread.low + spread.high);
    return spread;
}

}  // namespace

ValueData value_data(const Gaussians& gaussians, const ScalarField& field) {
    ValueData data{field.lower, field.upper,      field.spread, view_box(gaussians),
                   0,           field.is_measure, {},           field.background};
    data.content = gaussians.content.hull_box();
    const double full = std::pow(2 * std::numbers::pi, 1.5) * mass_within(double{gaussians.cutoff});
    for (std::size_t i = 0; i < gaussians.size(); ++i) {
        const Vec3d s = vec_cast<double>(gaussians.scale[i]);
        const double mass = full * double{gaussians.density[i]} * s.x * s.y * s.z;
        data.mass += mass;
        if (!field.spread.known) add_values(gaussians, field, i, mass, data.counts);
    }
    if (!field.spread.known) data.spread = data.counts.spread();
    return data;
}

ValueData value_data(std::span<const Volume> volumes, std::span<const VoxelField> fields,
                     const Box& box) {
    ValueData data;
    data.box = box;
    if (volumes.empty()) return data;
    data.lower = std::ranges::min(fields, {}, &VoxelField::lower).lower;
    data.upper = std::ranges::max(fields, {}, &VoxelField::upper).upper;
    data.is_measure = is_measure(fields.front());
    if (data.is_measure) data.background = fields.front().background;
    for (std::size_t n = 0; n < volumes.size(); ++n) {
        data.mass += mass(volumes[n]);
        data.counts.add(fields[n].counts);
    }
    data.spread = data.counts.spread();
    return data;
}

double steepest_gradient(const Scene& scene, const std::string& field) {
    ValueCounts counts;
    const auto add = [&](double magnitude, double mass) {
        counts.add(static_cast<float>(magnitude), mass);
    };
    if (scene.has_voxels()) {
        const VoxelSource& source = scene.voxels();
        const auto& values = std::ranges::find(source.fields, field, &SampledField::name)->values;
        const std::vector<reference::FieldGrid> grids =
            reference::field_grids(source.volumes->volumes, values, FieldPart::value);
        for (std::size_t g = 0; g < grids.size(); ++g) {
            const auto& leaves = source.volumes->volumes[g].leaves;
            for (std::size_t l = 0; l < leaves.size(); ++l)
                for (int n = 0; n < kLeafVoxels; ++n) {
                    if (!leaves[l].active(n)) continue;
                    const auto offset = static_cast<std::size_t>(n);
                    const double density{leaves[l].value[offset]};
                    const Vec3i index = leaves[l].origin + Vec3i{n >> 6, n >> 3 & 7, n & 7};
                    const double value =
                        grids[g].own() ? density : double{values[g].component[0].leaf[l][offset]};
                    add(length(grids[g].gradient({density, value, false, index, {}})), density);
                }
        }
    } else if (!scene.has_cells()) {
        const Gaussians& model = *scene.model().model;
        const ScalarField& of = *model.fields.find_scalar(field);
        for (std::size_t i = 0; i < model.size(); ++i)
            add(length(vec_cast<double>(of.gradient[i])), mass(model, i));
    }
    return counts.spread().high;
}

ColorScale value_scale(const ValueData& data, std::optional<bool> log) {
    using Kind = ColorScale::Kind;
    // Rays end in outer layers of low values: linear colours of a decade and more would be dark.
    constexpr double kLogRatio = 10, kDecades = 1e4;
    // Where most of the data has the least value, that lies as far above the range's low end, not at it, where nothing is seen; 0 stands
    // for nothing.
    constexpr double kLeast = 0.15;
    const ValueSpread spread = spread_of(data);
    const double high = spread.known ? spread.high : data.upper;
    double low = spread.known ? spread.low : data.lower;
    const bool from_0 = data.background == 0 && low >= 0;
    const double above = spread.middle - low;
    const bool is_least = spread.known && low < high && above <= 0.01 * (high - low) &&
                          (!from_0 || (low > 0 && above <= 0.02 * low));
    // Values above a background have a zero of their own: ratios of them mean nothing.
    if (log.value_or(data.background == 0 && low > 0 && high >= kLogRatio * low)) {
        if (!(high > 0))
            throw Error(fmt::format("a logarithmic range of values from {} to {}, expected above 0",
                                    data.lower, data.upper));
        if (is_least && low > 0) low *= std::pow(low / high, kLeast);
        low = std::max(low, high / kDecades);
        return {Kind::log, low < high ? low : high / 10, high};
    }
    if (is_least) low = std::max(low - kLeast * (high - low), from_0 ? 0.0 : -HUGE_VAL);
    if (low < high) return {Kind::linear, low, high};
    // Data of one value: from 0, which has no opacity, to that value.
    if (high == 0) return {Kind::linear, 0, 1};
    return {Kind::linear, std::min(0.0, high), std::max(0.0, high)};
}

double rough_unit_distance(const ValueData& data) {
    const double radius = data.box.empty() ? 0 : data.box.radius();
    if (!(radius > 0)) return 1;
    const Box& shown = data.content.empty() ? data.box : data.content;
    const Vec3d edge = shown.upper - shown.lower;
    const double density = data.mass / (edge.x * edge.y * edge.z);
    const double unit = 0.02 * radius * (data.is_measure ? 1 : density);
    return rounded(unit > 0 && std::isfinite(unit) ? unit : 0.02 * radius, 4);
}

MapUnit map_unit(const ValueData& data) {
    const Vec3d edge = data.box.upper - data.box.lower;
    // Mean over all directions, a quarter of the surface.
    const double silhouette = 0.5 * (edge.x * edge.y + edge.y * edge.z + edge.z * edge.x);
    const double middle = spread_of(data).middle;
    // Twice: the pictures of exposure_test.cpp then have a mean luminance of 0.35 to 0.65 where they show anything.
    constexpr double kDepth = 2;
    const double absorbing = data.is_measure ? data.mass / (middle - data.background) : data.mass;
    return {middle, absorbing / silhouette / kDepth};
}

double map_unit_distance(const ValueData& data, const ColorScale& scale) {
    if (data.box.empty()) return 1;
    const MapUnit of = map_unit(data);
    const double share = scale_position(scale, of.middle);
    const double opacity = scale.kind == ColorScale::Kind::log ? share * share : share;
    const double unit = std::max(opacity, 0.1) * of.thickness;
    return unit > 0 && std::isfinite(unit) ? rounded(unit, 2) : rough_unit_distance(data);
}

ChosenTransfer choose_transfer(const TransferRequest& request, const ValueData& data) {
    if (request.window && !request.bands.empty())
        throw Error("window and bands, expected one of them");
    if (!request.may_be_empty) require_inside(request, data);
    ChosenTransfer chosen;
    using Kind = ColorScale::Kind;
    chosen.scale = request.range
                       ? ColorScale{request.log.value_or(false) ? Kind::log : Kind::linear,
                                    request.range->first, request.range->second}
                       : value_scale(data, request.log);
    const bool log = chosen.scale.kind == Kind::log;
    const double unit = request.unit_distance.value_or(rough_unit_distance(data));
    if (!request.unit_distance) chosen.unit_distance = UnitDistance::rough;
    bool is_ramp = false;
    if (request.window) {
        chosen.transfer = window_transfer(request.window->first, request.window->second, unit);
        const std::vector<ValueColor>& ends = chosen.transfer.color;
        chosen.scale = {Kind::linear, ends.front().value, ends.back().value};
    } else if (!request.bands.empty()) {
        chosen.transfer = band_transfer(request.bands, unit);
    } else {
        const TransferPoints& points = request.points;
        if (points.at_values) chosen.scale = {Kind::linear, points.lower, points.upper};
        chosen.transfer = over_range(points, chosen.scale.low, chosen.scale.high, unit, log);
        is_ramp = points.points.opacity.empty();
        if (points.has_unit_distance) chosen.unit_distance = UnitDistance::stated;
    }
    if (request.unit_distance) chosen.transfer.unit_distance = unit;
    if (!request.gradient.empty()) chosen.transfer.gradient = request.gradient;
    validate(chosen.transfer.gradient);
    if (!chosen.transfer.gradient.empty() && !(data.lower < data.upper) && !request.may_be_empty)
        throw RequestError(
            "gradient_opacity",
            fmt::format(": the field has no gradient, all its values are {}", data.lower));
    if (is_ramp && chosen.unit_distance == UnitDistance::rough) {
        chosen.transfer.unit_distance = map_unit_distance(data, chosen.scale);
        chosen.unit_distance = UnitDistance::of_map;
    }
    if (request.threshold) chosen.transfer = above(std::move(chosen.transfer), *request.threshold);
    chosen.most_opacity = most_opacity(chosen.transfer, data.lower, data.upper);
    if (!(chosen.most_opacity > 0) && !request.may_be_empty)
        throw Error(
            fmt::format("the transfer function shows none of the data's values, {:.6g} to {:.6g}",
                        data.lower, data.upper));
    return chosen;
}

}  // namespace vog
