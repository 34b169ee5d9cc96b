// gaussians.cpp: mass, bounds, whitening, joining and validation of Gaussian models.
#include "vog/gaussians.h"

#include <fmt/core.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/paging.h"
#include "data/fields/field_arrays.h"
#include "vog/error.h"
#include "vog/units.h"

namespace vog {

namespace {

/// Means relative to another origin. throws vog::Error as set_origin does
BigVector<Vec3f> means_from(const Gaussians& gaussians, Vec3d origin) {
    const Vec3d shift = gaussians.origin - origin;
    BigVector<Vec3f> means;
    means.reserve(gaussians.size());
    for (std::size_t i = 0; i < gaussians.size(); ++i) {
        const Vec3d exact = vec_cast<double>(gaussians.mean[i]) + shift;
        means.push_back(vec_cast<float>(exact));
        const double rounding = length(vec_cast<double>(means.back()) - exact);
        const Vec3f s = gaussians.scale[i];
        if (!(rounding <= 0.125 * double{std::max({s.x, s.y, s.z})}))
            throw Error(fmt::format(
                "{}: Gaussian {} of scale {:.3g} would move by {:.3g} in a model of origin {} {} "
                "{}, whose means are 32-bit floats: expected models nearer to each other",
                gaussians.source.empty() ? "model" : gaussians.source, i, std::max({s.x, s.y, s.z}),
                rounding, origin.x, origin.y, origin.z));
        keep_memory_at(i);
    }
    return means;
}

}  // namespace

Vec3d model_origin(const Box& box) {
    if (box.empty()) return {};
    double farthest = 0;
    for (int axis = 0; axis < 3; ++axis)
        farthest = std::max({farthest, std::abs(box.lower[axis]), std::abs(box.upper[axis])});
    // Floats resolve 2^-24 of a coordinate: at 32 radii 1/150 of a voxel of a volume of 4096^3.
    constexpr double kFar = 32;
    const double radius = box.radius();
    if (!(farthest > kFar * radius)) return {};
    // Rounded, so that boxes of about one size and place give one origin, of few digits.
    Vec3d origin = box.center();
    const double unit = radius > 0 ? std::exp2(std::ilogb(radius)) : 0;
    for (int axis = 0; axis < 3; ++axis) {
        const double rounded = unit * std::round(origin[axis] / unit);
        if (std::isfinite(rounded)) origin[axis] = rounded + 0.0;  // not -0
    }
    return origin;
}

void set_origin(Gaussians& gaussians, Vec3d origin) {
    if (origin == gaussians.origin) return;
    gaussians.mean = means_from(gaussians, origin);
    gaussians.origin = origin;
}

double mass_within(double cutoff) {
    return std::erf(cutoff / std::numbers::sqrt2) -
           std::sqrt(2 / std::numbers::pi) * cutoff * std::exp(-0.5 * cutoff * cutoff);
}

double variance_within(double cutoff) {
    // P_5(x) = P_3(x) - x^(3/2) e^(-x/2) / (3 sqrt(pi/2)) at x = k², the chi-square recurrence.
    const double k2 = cutoff * cutoff;
    const double p3 = mass_within(cutoff);
    const double p5 =
        p3 - k2 * cutoff * std::exp(-0.5 * k2) / (3 * std::sqrt(std::numbers::pi / 2));
    return p5 / p3;
}

double cutoff_of_kappa(double kappa, double otherwise) {
    if (kappa == 0) return otherwise;
    // Bounds that keep the cutoff sqrt(-2 ln kappa) within (0, 8], the range of every model.
    if (!(kappa >= 1.3e-14 && kappa < 1))
        throw Error(
            fmt::format("kappa {}, expected in [1.3e-14, 1), or 0: the model's own cutoff", kappa));
    return std::sqrt(-2 * std::log(kappa));
}

double mass(const Gaussians& gaussians, std::size_t i) {
    const double full = std::pow(2 * std::numbers::pi, 1.5) * mass_within(gaussians.cutoff);
    const Vec3d s = vec_cast<double>(gaussians.scale[i]);
    return full * gaussians.density[i] * s.x * s.y * s.z;
}

double mass(const Gaussians& gaussians) {
    double sum = 0;
    for (std::size_t i = 0; i < gaussians.size(); ++i) {
        sum += mass(gaussians, i);
        keep_memory_at(i);
    }
    return sum;
}

Box support_box(const Gaussians& gaussians, std::size_t i) {
    // Half extent along world axis j: k sqrt(Sigma_jj), Sigma = R diag(s²) Rᵀ.
    const Mat3 r = gaussians.axis_aligned() ? Mat3{} : matrix_from_quat(gaussians.rotation[i]);
    const Vec3d s = vec_cast<double>(gaussians.scale[i]);
    const Vec3d center = world_mean(gaussians, i);
    Box box{center, center};
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3d row = r.row[static_cast<std::size_t>(axis)];
        const double extent =
            gaussians.cutoff * length(Vec3d{row.x * s.x, row.y * s.y, row.z * s.z});
        box.lower[axis] -= extent;
        box.upper[axis] += extent;
    }
    return box;
}

Box view_box(const Gaussians& gaussians) {
    if (!gaussians.box.empty()) return gaussians.box;
    Box box;
    for (std::size_t i = 0; i < gaussians.size(); ++i) box.include(support_box(gaussians, i));
    return box;
}

Mat3 whitening(const Gaussians& gaussians, std::size_t i) {
    const Vec3d s = vec_cast<double>(gaussians.scale[i]);
    Mat3 w = gaussians.axis_aligned() ? Mat3{} : transpose(matrix_from_quat(gaussians.rotation[i]));
    for (int axis = 0; axis < 3; ++axis)
        w.row[static_cast<std::size_t>(axis)] =
            (1 / s[axis]) * w.row[static_cast<std::size_t>(axis)];
    return w;
}

void Content::include(const Content& other) {
    if (!standing.known()) standing = other.standing;
    if (units.length.empty())
        units.length = other.units.length;
    else if (!other.units.length.empty() &&
             length_unit_name(units.length) != length_unit_name(other.units.length))
        units.length.clear();
    if (units.density != other.units.density) units.density.clear();
    by_value &= other.by_value;
    voxels.include(other.voxels);
    if (hull.empty() || other.hull.empty())
        hull.clear();
    else
        hull.insert(hull.end(), other.hull.begin(), other.hull.end());
}

void append(Gaussians& gaussians, const Gaussians& other) {
    if (gaussians.size() == 0 && gaussians.source.empty()) {
        gaussians = other;
        return;
    }
    if (gaussians.cutoff != other.cutoff)
        throw Error(
            fmt::format("{}: cutoff {}, expected {} as in {}: models with different kernels cannot "
                        "be one model",
                        other.source, other.cutoff, gaussians.cutoff, gaussians.source));
    require_same_length(other.content.units.length, other.source, gaussians.content.units.length,
                        gaussians.source);
    BigVector<Vec3f> moved;  // means of `other`, if origins differ
    const bool same_origin = gaussians.origin == other.origin;
    if (!same_origin) {
        Box both = view_box(gaussians);
        both.include(view_box(other));
        set_origin(gaussians, model_origin(both));
        moved = means_from(other, gaussians.origin);
    }
    try {
        append(gaussians.fields, gaussians.size(), other.fields, other.size());
    } catch (const Error& error) {
        throw Error(
            fmt::format("{}: {}", other.source.empty() ? "model" : other.source, error.what()));
    }
    if (!gaussians.axis_aligned() || !other.axis_aligned()) {
        resize_kept(gaussians.rotation, gaussians.size());
        append_kept(gaussians.rotation, other.rotation);
        resize_kept(gaussians.rotation, gaussians.size() + other.size());
    }
    append_kept(gaussians.mean, same_origin ? other.mean : moved);
    append_kept(gaussians.scale, other.scale);
    append_kept(gaussians.density, other.density);
    gaussians.box.include(other.box);
    gaussians.content.include(other.content);
    gaussians.source_voxels += other.source_voxels;
    if (gaussians.source != other.source) gaussians.source += " + " + other.source;
    if (gaussians.method != other.method) gaussians.method += " + " + other.method;
    if (gaussians.options != other.options) gaussians.options += " + " + other.options;
    if (gaussians.summary != other.summary) gaussians.summary += " + " + other.summary;
}

Gaussians select(const Gaussians& gaussians, std::span<const std::size_t> index) {
    for (const std::size_t i : index)
        if (i >= gaussians.size())
            throw Error(fmt::format("Gaussian {}, expected below {}", i, gaussians.size()));
    Gaussians some;
    some.origin = gaussians.origin;
    some.cutoff = gaussians.cutoff;
    some.box = gaussians.box;
    some.content = gaussians.content;
    some.source = gaussians.source;
    some.method = gaussians.method;
    some.options = gaussians.options;
    const auto take = [&](auto& to, const auto& from) {
        to.reserve(index.size());
        for (const std::size_t i : index) to.push_back(from[i]);
    };
    take(some.mean, gaussians.mean);
    take(some.scale, gaussians.scale);
    take(some.density, gaussians.density);
    if (!gaussians.axis_aligned()) take(some.rotation, gaussians.rotation);
    some.fields = empty_fields(gaussians.fields);
    each_array(take, some.fields, gaussians.fields);
    return some;
}

namespace {

/// Whether the numbers of a Gaussian are in range.
bool valid(const Gaussians& gaussians, std::size_t i) {
    const Vec3f s = gaussians.scale[i];
    const float density = gaussians.density[i];
    if (!finite(gaussians.mean[i]) || !finite(s) || !(s.x > 0 && s.y > 0 && s.z > 0) ||
        !(density >= 0) || !std::isfinite(density))
        return false;
    if (gaussians.axis_aligned()) return true;
    const Quat q = gaussians.rotation[i];
    const float norm2 = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
    return norm2 > 1e-12f && std::isfinite(norm2);
}

/// Number of the first Gaussian out of range; that of all where none is.
std::size_t first_invalid(const Gaussians& gaussians) {
    using Range = tbb::blocked_range<std::size_t>;
    constexpr std::size_t kGrain = 1 << 14;
    return tbb::parallel_reduce(
        Range(0, gaussians.size(), kGrain), gaussians.size(),
        [&](const Range& run, std::size_t first) {
            for (std::size_t i = run.begin(); i < run.end() && i < first; ++i) {
                keep_memory_at(i);
                if (!valid(gaussians, i)) first = i;
            }
            return first;
        },
        [](std::size_t a, std::size_t b) { return std::min(a, b); });
}

}  // namespace

void validate(const Gaussians& gaussians) {
    const auto fail = [&](const std::string& what) {
        throw Error(
            fmt::format("{}: {}", gaussians.source.empty() ? "model" : gaussians.source, what));
    };
    const std::size_t n = gaussians.size();
    if (gaussians.scale.size() != n || gaussians.density.size() != n ||
        (!gaussians.axis_aligned() && gaussians.rotation.size() != n))
        fail(fmt::format(
            "arrays of different lengths: {} means, {} scales, {} rotations, {} densities", n,
            gaussians.scale.size(), gaussians.rotation.size(), gaussians.density.size()));
    const Vec3d origin = gaussians.origin;
    if (!finite(origin))
        fail(fmt::format("origin {} {} {}, expected finite", origin.x, origin.y, origin.z));
    if (!(gaussians.cutoff > 0 && gaussians.cutoff <= 8))
        fail(fmt::format("cutoff {}, expected in (0, 8] standard deviations", gaussians.cutoff));
    const std::size_t i = first_invalid(gaussians);
    if (i < n) {
        const Vec3f mean = gaussians.mean[i], s = gaussians.scale[i];
        if (!finite(mean))
            fail(fmt::format("Gaussian {}: mean {} {} {}, expected finite", i, mean.x, mean.y,
                             mean.z));
        if (!finite(s) || !(s.x > 0 && s.y > 0 && s.z > 0))
            fail(fmt::format("Gaussian {}: scales {} {} {}, expected finite and > 0", i, s.x, s.y,
                             s.z));
        if (!(gaussians.density[i] >= 0) || !std::isfinite(gaussians.density[i]))
            fail(fmt::format("Gaussian {}: density {}, expected finite and >= 0", i,
                             gaussians.density[i]));
        const Quat q = gaussians.rotation[i];
        fail(fmt::format(
            "Gaussian {}: rotation {} {} {} {}, expected a quaternion of finite, nonzero length", i,
            q.w, q.x, q.y, q.z));
    }
    try {
        validate(gaussians.fields, n);
    } catch (const Error& error) {
        fail(error.what());
    }
}

}  // namespace vog
