// shown_field.cpp: Planes of a field in the unit of a picture.
#include "render/shown_field.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "vog/error.h"

namespace vog {

namespace {

using device::FieldPlane;
using device::VectorPlane;

constexpr std::size_t kGrain = 1 << 14;

double value_at(const ScalarField& field, std::size_t i) { return double{field.value[i]}; }
device::Double3 gradient_at(const BigVector<Vec3f>& gradient, std::size_t i) {
    return plain(vec_cast<double>(gradient[i]));
}

/// The vector field in Gaussian i as it is stored.
VectorPlane stored(const VectorField& field, std::size_t i) {
    VectorPlane plane;
    const Vec3f value = field.value[i];
    plane.value = {value.x, value.y, value.z};
    for (std::size_t c = 0; c < 3; ++c) {
        const Vec3f g = field.gradient[c][i];
        plane.gradient[c] = {g.x, g.y, g.z};
    }
    std::ranges::copy(field.covariance[i], plane.covariance);
    return plane;
}

double weight(const Gaussians& gaussians, std::size_t i) {
    const Vec3d s = vec_cast<double>(gaussians.scale[i]);
    return double{gaussians.density[i]} * s.x * s.y * s.z;
}

/// Mean of the field over the model, weighted by mass.
Vec3d mean_over(const Gaussians& gaussians, const ShownField& shown) {
    struct Sum {
        double weight = 0;
        Vec3d value;
    };
    const Sum all = tbb::parallel_deterministic_reduce(
        tbb::blocked_range<std::size_t>(0, gaussians.size(), kGrain), Sum{},
        [&](const tbb::blocked_range<std::size_t>& range, Sum sum) {
            for (std::size_t i = range.begin(); i < range.end(); ++i) {
                const double w = weight(gaussians, i);
                sum.weight += w;
                if (shown.along_rays)
                    sum.value = sum.value + w * vec_cast<double>(shown.vector->value[i]);
                else
                    sum.value.x += w * shown.plane(i).value;
            }
            return sum;
        },
        [](const Sum& a, const Sum& b) {
            return Sum{a.weight + b.weight, a.value + b.value};
        });
    // A model without mass draws nothing.
    return all.weight > 0 ? (1 / all.weight) * all.value : Vec3d{};
}

/// Bound of |field - reference| and of the residual inside a support.
double reach_of(const Gaussians& gaussians, const ShownField& shown, double cutoff, std::size_t i) {
    const Vec3f s = gaussians.scale[i];
    const double radius = cutoff * double{std::max({s.x, s.y, s.z})};
    if (!shown.along_rays) {
        const FieldPlane p = shown.plane(i);
        return std::abs(p.value) + radius * length(vec(p.gradient)) + std::sqrt(p.variance);
    }
    const VectorField& field = *shown.vector;
    double slope2 = 0;
    for (const auto& gradient : field.gradient) {
        const Vec3d g = vec(gradient_at(gradient, i));
        slope2 += dot(g, g);
    }
    const auto& r = field.covariance[i];
    const double variance = std::max(double{r[0]} + double{r[3]} + double{r[5]}, 0.0);
    return length(vec_cast<double>(field.value[i]) - shown.reference) + radius * std::sqrt(slope2) +
           std::sqrt(variance);
}

double field_unit(const Gaussians& gaussians, const ShownField& shown, double cutoff) {
    const double largest = tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, gaussians.size(), kGrain), 0.0,
        [&](const tbb::blocked_range<std::size_t>& range, double most) {
            for (std::size_t i = range.begin(); i < range.end(); ++i)
                most = std::max(most, reach_of(gaussians, shown, cutoff, i));
            return most;
        },
        [](double a, double b) { return std::max(a, b); });
    return largest > 0 ? std::ldexp(1.0, std::ilogb(largest) + 1) : 1;
}

}  // namespace

FieldPlane ShownField::plane(std::size_t i) const {
    FieldPlane p;
    if (scalar) {
        const double deviation = double{scalar->deviation[i]};
        p = {value_at(*scalar, i), gradient_at(scalar->gradient, i), deviation * deviation};
    } else {
        p = device::plane_along(stored(*vector, i), plain(direction));
    }
    return {(p.value - reference.x) / unit, (1 / unit) * p.gradient,
            std::max(p.variance, 0.0) / (unit * unit)};
}

VectorPlane ShownField::vector_plane(std::size_t i) const {
    VectorPlane plane = stored(*vector, i);
    const double per_unit = 1 / unit;
    plane.value = device::to_float(per_unit * (device::to_double(plane.value) - plain(reference)));
    for (device::Float3& g : plane.gradient) g = device::to_float(per_unit * device::to_double(g));
    for (float& r : plane.covariance) r = static_cast<float>(double{r} * per_unit * per_unit);
    return plane;
}

FieldPlane constant_plane(const FieldPlane& plane, const Gaussians& gaussians, std::size_t i,
                          double share) {
    const Mat3 world_from_own =
        gaussians.axis_aligned() ? Mat3{} : matrix_from_quat(gaussians.rotation[i]);
    const Vec3d own = transpose(world_from_own) * vec(plane.gradient);
    const Vec3d s = vec_cast<double>(gaussians.scale[i]);
    const Vec3d over{own.x * s.x, own.y * s.y, own.z * s.z};
    return {plane.value, {0, 0, 0}, plane.variance + share * dot(over, over)};
}

ShownField field_towards(const Gaussians& gaussians, const FieldChoice& choice, Vec3d direction) {
    ShownField shown;
    if (choice.part == FieldPart::value)
        shown.scalar = gaussians.fields.find_scalar(choice.field);
    else
        shown.vector = gaussians.fields.find_vector(choice.field);
    if (!shown.scalar && !shown.vector) {
        (void)field_choice(choice.field, gaussians.fields);  // names the fields
        throw Error("field '" + choice.field + "': " +
                    (choice.part == FieldPart::value ? "a vector field, expected one of its parts"
                                                     : "a scalar field, which has no parts"));
    }
    shown.direction = choice.part == FieldPart::x   ? Vec3d{1, 0, 0}
                      : choice.part == FieldPart::y ? Vec3d{0, 1, 0}
                      : choice.part == FieldPart::z ? Vec3d{0, 0, 1}
                                                    : normalized(direction);
    return shown;
}

ShownField shown_field(const Gaussians& gaussians, const FieldChoice& choice,
                       const CameraFrame& frame, double cutoff) {
    ShownField shown = field_towards(gaussians, choice, frame.forward);
    shown.along_rays = choice.part == FieldPart::view && !frame.orthographic;
    shown.reference = mean_over(gaussians, shown);
    shown.unit = field_unit(gaussians, shown, cutoff);
    return shown;
}

FieldMaps magnitude_maps(const Progress& progress,
                         const std::function<FieldMaps(FieldPart, const Progress&)>& render) {
    FieldMaps maps;
    std::vector<double> square, variance;  // sums over the components
    int done = 0;
    for (const FieldPart part : {FieldPart::x, FieldPart::y, FieldPart::z}) {
        const Progress own =
            progress ? Progress([&](double fraction) { progress((done + fraction) / 3); })
                     : Progress{};
        maps = render(part, own);
        square.resize(maps.mean.size());
        variance.resize(maps.mean.size());
        for (std::size_t n = 0; n < maps.mean.size(); ++n) {
            const double mean{maps.mean[n]}, deviation{maps.deviation[n]};
            square[n] += mean * mean + deviation * deviation;
            variance[n] += deviation * deviation;
        }
        ++done;
    }
    for (std::size_t n = 0; n < maps.mean.size(); ++n) {
        maps.mean[n] = static_cast<float>(std::sqrt(square[n]));
        maps.deviation[n] = static_cast<float>(std::sqrt(variance[n]));
    }
    return maps;
}

FieldMaps empty_maps(int width, int height) {
    const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
    return {width, height, std::vector<float>(pixels), std::vector<float>(pixels, kNothing),
            std::vector<float>(pixels, kNothing)};
}

}  // namespace vog
