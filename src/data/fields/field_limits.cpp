// field_limits.cpp: The limiter of T. J. Barth and D. C. Jespersen, "The design and application of upwind schemes on
// unstructured meshes" (1989), for the planes of Gaussians.
#include "data/fields/field_limits.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"

namespace vog {

double variance_along(const Gaussians& gaussians, std::size_t i, Vec3d direction) {
    const Vec3d own = gaussians.axis_aligned()
                          ? direction
                          : transpose(matrix_from_quat(gaussians.rotation[i])) * direction;
    const Vec3d s = vec_cast<double>(gaussians.scale[i]);
    const Vec3d across{own.x * s.x, own.y * s.y, own.z * s.z};
    return dot(across, across);
}

double plane_variance(const Gaussians& gaussians, const ScalarField& field, std::size_t i) {
    return variance_along(gaussians, i, vec_cast<double>(field.gradient[i]));
}

void limit_planes(Gaussians& model) {
    constexpr double kRounding = 1e-5;  // more than floats', so that limited planes stay
    const double reach{model.cutoff}, within = variance_within(reach);
    for (ScalarField& field : model.fields.scalar) {
        if (!(field.upper > field.lower)) continue;  // constant, or of no stated range
        vog::parallel_for(std::size_t{0}, model.size(), [&](std::size_t i) {
            const double variance = plane_variance(model, field, i);
            const double extent = reach * std::sqrt(variance), value{field.value[i]};
            const double room = std::max(std::min(field.upper - value, value - field.lower), 0.0);
            if (!(extent > (1 + kRounding) * room + 1e-6 * std::abs(value))) return;
            const double share = room / extent, r{field.deviation[i]};
            const double more = std::sqrt(r * r + (1 - share * share) * within * variance);
            field.gradient[i] = vec_cast<float>(share * vec_cast<double>(field.gradient[i]));
            field.deviation[i] =
                static_cast<float>(std::min(more, double{std::numeric_limits<float>::max()}));
            // The third moment stays.
            const double ratio = more > 0 ? r / more : 0;
            field.skewness[i] =
                static_cast<float>(double{field.skewness[i]} * ratio * ratio * ratio);
        });
    }
}

}  // namespace vog
