// carried_values.cpp: density times value as volumes, and their lattices.
#include "convert/moments/cut/carried_values.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "convert/fields/field_values.h"

namespace vog::moments {

CarriedValues::CarriedValues(const MomentJob& job) {
    // The mean over the fields: together they weigh as much as the density.
    const auto count = static_cast<double>(job.options.carried_fields.size());
    for (const CarriedField& field : job.options.carried_fields) {
        const double unit = field.deviation * std::sqrt(count);
        for (std::size_t c = 0; c < field.levels->front().component.size(); ++c) {
            std::vector<Volume>& parts = volumes_.emplace_back(job.parts.begin(), job.parts.end());
            double least = std::numeric_limits<double>::infinity();
            joint::for_each_value(job.parts, *field.levels, c, [&](float, float value, double) {
                least = std::min(least, double{value});
            });
            joint::for_each_value(
                std::span(parts), *field.levels, c, [&](float& density, float value, double) {
                    density = static_cast<float>(density * (1 + (value - least) / unit));
                });
            components_.push_back(job.fields(parts));
        }
    }
}

std::vector<const LatticeField*> CarriedValues::at(std::size_t n) const {
    std::vector<const LatticeField*> all;
    for (const std::vector<LatticeField>& component : components_) all.push_back(&component[n]);
    return all;
}

}  // namespace vog::moments
