// value_functions.cpp: the ramp, the bands and the step of pictures by value.
#include "evaluate/values/value_functions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace vog::evaluation {

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
                      double upper, double unit_distance) {
    ValueTransfer transfer{name, {}, {}, unit_distance};
    for (int n = 0; n < points; ++n) {
        const double q = double(n) / (points - 1);
        const auto [extinction, c] = light(q);
        transfer.color.push_back({upper * q, static_cast<float>(c[0]), static_cast<float>(c[1]),
                                  static_cast<float>(c[2])});
        transfer.opacity.push_back({upper * q, std::min(-std::expm1(-extinction), kMostOpacity)});
    }
    return transfer;
}

}  // namespace

std::vector<ValueTransfer> value_functions(double upper, double radius) {
    const double unit_distance = radius / 12, surface = 0.3 * upper;
    return {sampled("ramp", ramp, 301, upper, unit_distance),
            sampled("bands", bands, 1001, upper, unit_distance),
            {"step",
             {{0, 0, 1, 0.5F}, {upper, 1, 0, 0.5F}},
             {{0, 0}, {surface, 0}, {surface, kMostOpacity}, {upper, kMostOpacity}},
             unit_distance}};
}

double high_value(std::span<const Volume> volumes, double largest) {
    constexpr std::size_t kBins = 65536;
    std::vector<double> count(kBins, 0);
    double all = 0;
    const auto add = [&](float value, double voxels) {
        const double bin = std::clamp(double{value} / largest, 0.0, 1.0) * kBins;
        count[std::min(static_cast<std::size_t>(bin), kBins - 1)] += voxels;
        all += voxels;
    };
    for (const Volume& volume : volumes) {
        for (const Leaf& leaf : volume.leaves)
            for (int n = 0; n < kLeafVoxels; ++n)
                if (leaf.active(n)) add(leaf.value[static_cast<std::size_t>(n)], 1);
        for (const Tile& tile : volume.tiles) add(tile.value, std::pow(double(tile.edge), 3));
    }
    std::size_t bin = 0;
    for (double below = count[0]; bin + 1 < kBins && below <= 0.999 * all;) below += count[++bin];
    return largest * double(bin + 1) / kBins;
}

}  // namespace vog::evaluation
