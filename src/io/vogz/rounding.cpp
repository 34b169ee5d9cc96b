// rounding.cpp: steps of equal effect. A change of a Gaussian g = exp(-x^2 / 2) by a displaced mean is e x g, by a scale
// at constant mass e (x^2 - 1) g, by a shear 2 e x y g, by its mass e g. Their squares, integrated over g^2 (of variance
// 1/2), are e^2 times 1/2, 3/4, 1 and 1: the steps are the inverse roots.
#include "io/vogz/rounding.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "io/vogz/log_shape.h"

namespace vog::vogz {

namespace {

/// Box of means, and sizes, of a run of Gaussians.
struct Extent {
    Box means;
    double largest = 0;     ///< product of three scales
    double logarithms = 0;  ///< of these products, added up
};

/// The same sums for any number of threads.
Extent extent_of(const Gaussians& model) {
    constexpr std::size_t kGrain = 1 << 14;
    return tbb::parallel_deterministic_reduce(
        tbb::blocked_range<std::size_t>(0, model.size(), kGrain), Extent{},
        [&](const tbb::blocked_range<std::size_t>& run, Extent extent) {
            std::vector<double> product(run.size());
            for (std::size_t n = 0; n < run.size(); ++n) {
                const Vec3d s = vec_cast<double>(model.scale[run.begin() + n]);
                product[n] = s.x * s.y * s.z;
                extent.largest = std::max(extent.largest, product[n]);
                extent.means.include(vec_cast<double>(model.mean[run.begin() + n]));
            }
            take_logarithms(product);
            for (const double logarithm : product) extent.logarithms += logarithm;
            return extent;
        },
        [](Extent a, const Extent& b) {
            a.means.include(b.means);
            a.largest = std::max(a.largest, b.largest);
            a.logarithms += b.logarithms;
            return a;
        });
}

}  // namespace

ShapeRounding shape_rounding(const Gaussians& model, double step) {
    const Extent extent = extent_of(model);
    const Box& means = extent.means;
    const double widest = std::cbrt(extent.largest);
    const double log_spread = model.size() ? std::numbers::log2e * extent.logarithms /
                                                 (3 * static_cast<double>(model.size()))
                                           : 0;
    ShapeRounding rounding;
    const Vec3d edges = model.size() ? means.upper - means.lower : Vec3d{};
    if (model.size() > 0) rounding.corner = means.lower;
    const double mean_step = std::numbers::sqrt2 * step;  // in standard deviations
    // Steps of means are edges divided by powers of two: the edge is as much larger than the means' box as makes them
    // exact for a Gaussian of typical size.
    const double box_edge = model.size() ? std::max({edges.x, edges.y, edges.z, widest}) : 1;
    const double halvings = std::log2(box_edge) - log_spread - std::log2(mean_step);
    rounding.edge = box_edge * std::exp2(std::ceil(halvings) - halvings);
    rounding.diagonal_step = std::sqrt(4.0 / 3) * step;
    rounding.shear_step = step;
    rounding.mass_step = step;
    // Rounded to the nearest power of two.
    rounding.exponent_at_zero = std::log2(mean_step / rounding.edge) + 0.5;
    rounding.exponent_per_trace = rounding.diagonal_step / 3 * std::numbers::log2e;
    return rounding;
}

namespace {

FieldRounding rounding_of(double reference, double unit, double step) {
    return {reference, unit > 0 && std::isfinite(unit) ? unit : 1, step};
}

}  // namespace

FieldRounding field_rounding(const ScalarField& field, double step) {
    return rounding_of(field.lower, field.upper - field.lower, step);
}
FieldRounding field_rounding(const VectorField& field, double step) {
    return rounding_of(0, field.upper, step);
}

}  // namespace vog::vogz
