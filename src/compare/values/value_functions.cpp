// value_functions.cpp: the ramp, the bands and the step of pictures by value.
#include "compare/values/value_functions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace vog::comparison {

namespace {

/// Light at a share of the values: extinction per unit distance, and colour.
struct ShareLight {
    double extinction;
    std::array<double, 3> color;
};

ShareLight ramp(double q) {
    return {
        q,
        {std::min(1.0, 3 * q), std::clamp(3 * q - 1, 0.0, 1.0), std::clamp(3 * q - 2, 0.0, 1.0)}};
}

/// Three triangles: thin blue, orange, dense yellow.
ShareLight bands(double q) {
    const auto band = [q](double middle, double half) {
        return std::max(0.0, 1 - std::abs(q - middle) / half);
    };
    const double a = 0.15 * band(0.12, 0.05), b = 0.6 * band(0.45, 0.08), c = 2 * band(0.85, 0.15);
    const double all = a + b + c;
    if (all == 0) return {0, {0, 0, 0}};
    return {2 * all,
            {(a * 0.2 + b + c) / all, (a * 0.5 + b * 0.6 + c * 0.95) / all,
             (a + b * 0.1 + c * 0.8) / all}};
}

ValueTransfer sampled(const std::string& name, ShareLight (*light)(double), int points,
                      const ValueRange& range, double unit_distance) {
    ValueTransfer transfer{name, {}, {}, unit_distance};
    for (int n = 0; n < points; ++n) {
        const double q = double(n) / (points - 1);
        const double value = range.lower + (range.upper - range.lower) * q;
        const auto [extinction, c] = light(q);
        transfer.color.push_back(
            {value, static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2])});
        transfer.opacity.push_back({value, std::min(-std::expm1(-extinction), kMostOpacity)});
    }
    return transfer;
}

/// Calls take(value, voxels) for every value of a scalar field.
template <class Take>
void for_each_value(const Volume& volume, const VoxelField& field, const Take& take) {
    const VoxelValues& values = field.component.front();
    const bool own = values.leaf.empty() && values.tile.empty();
    const double shift = own ? field.background : 0;
    for (std::size_t l = 0; l < volume.leaves.size(); ++l) {
        const Leaf& leaf = volume.leaves[l];
        for (int n = 0; n < kLeafVoxels; ++n)
            if (leaf.active(n))
                take((own ? leaf.value : values.leaf[l])[static_cast<std::size_t>(n)] + shift, 1.0);
    }
    for (std::size_t t = 0; t < volume.tiles.size(); ++t)
        take((own ? volume.tiles[t].value : values.tile[t]) + shift,
             std::pow(double(volume.tiles[t].edge), 3));
}

}  // namespace

std::vector<ValueTransfer> value_functions(const ValueRange& range, double radius) {
    const double unit_distance = radius / 12,
                 surface = range.lower + 0.3 * (range.upper - range.lower);
    return {sampled("ramp", ramp, 301, range, unit_distance),
            sampled("bands", bands, 1001, range, unit_distance),
            {"step",
             {{range.lower, 0, 1, 0.5F}, {range.upper, 1, 0, 0.5F}},
             {{range.lower, 0}, {surface, 0}, {surface, kMostOpacity}, {range.upper, kMostOpacity}},
             unit_distance}};
}

ValueRange value_range(std::span<const Volume> volumes, std::span<const VoxelField> field) {
    constexpr std::size_t kBins = 65536;
    constexpr double kTail = 0.001;
    const VoxelField& any = field.front();
    const bool own = any.component.front().leaf.empty() && any.component.front().tile.empty();
    double least = std::ranges::min(field, {}, &VoxelField::lower).lower;
    const double largest = std::ranges::max(field, {}, &VoxelField::upper).upper;
    const bool from_empty = own && least >= any.background;
    if (from_empty) least = any.background;
    if (!(largest > least)) return {least, largest};
    std::vector<double> count(kBins, 0);
    double all = 0;
    for (std::size_t v = 0; v < volumes.size(); ++v)
        for_each_value(volumes[v], field[v], [&](double value, double voxels) {
            const double bin = std::clamp((value - least) / (largest - least), 0.0, 1.0) * kBins;
            count[std::min(static_cast<std::size_t>(bin), kBins - 1)] += voxels;
            all += voxels;
        });
    const auto bin_above = [&](double share) {
        std::size_t bin = 0;
        for (double below = count[0]; bin + 1 < kBins && below <= share * all;)
            below += count[++bin];
        return bin;
    };
    const double width = (largest - least) / kBins;
    return {from_empty ? least : least + width * double(bin_above(kTail)),
            least + width * double(bin_above(1 - kTail) + 1)};
}

}  // namespace vog::comparison
