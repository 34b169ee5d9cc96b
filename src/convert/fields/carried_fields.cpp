// carried_fields.cpp: deviations of fields, weighted by mass.
#include <array>
#include <cmath>
#include <limits>

#include "convert/fields/field_values.h"
#include "vog/convert_fields.h"
#include "vog/distributed.h"

namespace vog {

namespace {

/// Standard deviation of a field; of a vector field the root of the sum of its components' variances. 0 where it is
/// rounding of floats.
double deviation_of(std::span<const Volume> levels, const std::vector<VoxelField>& field,
                    const Collective& collective) {
    std::array<double, 3> mean{};
    double variance = 0;
    for (int pass = 0; pass < 2; ++pass) {  // the second about the mean: nothing cancels
        std::array<double, 5> sums{};  // mass, times each component about its mean, times squares
        const std::size_t components = field.empty() ? 0 : field.front().component.size();
        for (std::size_t c = 0; c < components; ++c)
            joint::for_each_value(levels, field, c, [&](float density, float value, double volume) {
                const double m = density * volume, from_mean = value - mean[c];
                sums[0] += c == 0 ? m : 0;
                sums[1 + c] += m * from_mean;
                sums[4] += m * from_mean * from_mean;
            });
        collective.sum(sums);
        if (!(sums[0] > 0)) return 0;
        for (std::size_t c = 0; c < 3; ++c) mean[c] += sums[1 + c] / sums[0];
        variance = sums[4] / sums[0];
    }
    const double deviation = std::sqrt(variance);
    constexpr double kRounding = std::numeric_limits<float>::epsilon();
    return deviation > kRounding * std::hypot(mean[0], mean[1], mean[2]) ? deviation : 0;
}

/// Whether any level of any process has values other than its densities.
bool has_values(const std::vector<VoxelField>& field, const Collective& collective) {
    double found = 0;
    for (const VoxelField& level : field)
        if (!level.component.front().leaf.empty() || !level.component.front().tile.empty())
            found = 1;
    collective.max(std::span(&found, 1));
    return found > 0;
}

}  // namespace

std::vector<CarriedField> carried_fields(std::span<const Volume> levels,
                                         std::span<const std::vector<VoxelField>> fields,
                                         const Collective* given) {
    const Collective& collective = collective_or_single(given);
    std::vector<CarriedField> carried;
    for (const std::vector<VoxelField>& field : fields) {
        if (!has_values(field, collective)) continue;
        const double deviation = deviation_of(levels, field, collective);
        if (deviation > 0) carried.push_back({&field, deviation});
    }
    return carried;
}

}  // namespace vog
