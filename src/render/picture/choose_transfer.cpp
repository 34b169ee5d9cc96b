// choose_transfer.cpp: transfer function of a volume picture, and its unit distance.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

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

/// Integral of density times field over the voxels.
double moment_of(const Volume& volume, const VoxelField& field) {
    const VoxelValues& values = field.component.front();
    double sum = 0;
    for (std::size_t l = 0; l < volume.leaves.size(); ++l)
        for (int n = 0; n < kLeafVoxels; ++n)
            if (volume.leaves[l].active(n))
                sum += double{volume.leaves[l].value[static_cast<std::size_t>(n)]} *
                       double{values.leaf[l][static_cast<std::size_t>(n)]};
    for (std::size_t t = 0; t < volume.tiles.size(); ++t)
        sum += std::pow(double(volume.tiles[t].edge), 3) * double{volume.tiles[t].value} *
               double{values.tile[t]};
    return sum * voxel_volume(volume);
}

}  // namespace

ValueData value_data(const Gaussians& gaussians, const ScalarField& field) {
    ValueData data{field.lower, field.upper, view_box(gaussians), 0, 0, field.is_measure};
    for (std::size_t i = 0; i < gaussians.size(); ++i) {
        const Vec3d s = vec_cast<double>(gaussians.scale[i]);
        const double weight = double{gaussians.density[i]} * s.x * s.y * s.z;
        data.mass += weight;
        data.moment += weight * double{field.value[i]};
    }
    const double full = std::pow(2 * std::numbers::pi, 1.5) * mass_within(double{gaussians.cutoff});
    data.mass *= full, data.moment *= full;
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
    for (std::size_t n = 0; n < volumes.size(); ++n) {
        data.mass += mass(volumes[n]);
        if (!data.is_measure) data.moment += moment_of(volumes[n], fields[n]);
    }
    return data;
}

std::pair<double, double> value_range(double lower, double upper) {
    if (lower < upper) return {lower, upper};
    // Data of one value: from 0, which has no opacity, to that value.
    if (upper == 0) return {0, 1};
    return std::minmax(0.0, upper);
}

double rough_unit_distance(const Box& box) {
    const double radius = box.empty() ? 0 : box.radius();
    return radius > 0 ? rounded(0.02 * radius, 4) : 1;
}

double map_unit_distance(const ValueData& data, double lower, double upper) {
    if (data.box.empty()) return 1;
    const Vec3d edge = data.box.upper - data.box.lower;
    // Mean over all directions, a quarter of the surface.
    const double silhouette = 0.5 * (edge.x * edge.y + edge.y * edge.z + edge.z * edge.x);
    double absorbing = data.mass / upper;
    if (!data.is_measure) {
        // A range that the mean lies beside shows a tenth of the data at least, and all at most.
        const double share = (data.moment / data.mass - lower) / (upper - lower);
        absorbing = data.mass * std::clamp(share, 0.1, 1.0);
    }
    const double unit = absorbing / silhouette;
    return unit > 0 && std::isfinite(unit) ? rounded(unit, 2) : rough_unit_distance(data.box);
}

ChosenTransfer choose_transfer(const TransferRequest& request, const ValueData& data) {
    if (request.window && !request.bands.empty())
        throw Error("window and bands, expected one of them");
    ChosenTransfer chosen;
    std::tie(chosen.lower, chosen.upper) =
        request.range ? *request.range : value_range(data.lower, data.upper);
    const double unit = request.unit_distance.value_or(rough_unit_distance(data.box));
    if (!request.unit_distance) chosen.unit_distance = UnitDistance::rough;
    bool is_ramp = false;
    if (request.window) {
        chosen.transfer = window_transfer(request.window->first, request.window->second, unit);
    } else if (!request.bands.empty()) {
        chosen.transfer = band_transfer(request.bands, unit);
    } else if (request.map) {
        chosen.transfer = over_range(*request.map, chosen.lower, chosen.upper, unit);
        is_ramp = request.map->opacity.empty();
    } else {
        const TransferPoints& points = request.points;
        if (points.at_values && request.range)
            throw Error(fmt::format("range: {} states values of its own, expected one of them",
                                    points.points.name));
        if (points.at_values) chosen.lower = points.lower, chosen.upper = points.upper;
        chosen.transfer = over_range(points, chosen.lower, chosen.upper, unit);
        is_ramp = points.points.opacity.empty();
        if (points.has_unit_distance) chosen.unit_distance = UnitDistance::stated;
    }
    if (request.unit_distance) chosen.transfer.unit_distance = unit;
    if (is_ramp && chosen.unit_distance == UnitDistance::rough) {
        chosen.transfer.unit_distance = map_unit_distance(data, chosen.lower, chosen.upper);
        chosen.unit_distance = UnitDistance::of_map;
    }
    if (request.threshold) chosen.transfer = above(std::move(chosen.transfer), *request.threshold);
    chosen.most_opacity = most_opacity(chosen.transfer, data.lower, data.upper);
    if (!(chosen.most_opacity > 0) && !request.may_be_empty)
        throw Error(fmt::format("the transfer function shows none of the data's values, {} to {}",
                                data.lower, data.upper));
    return chosen;
}

}  // namespace vog
