// gaussians.cpp: mass, bounds, whitening, joining and validation of Gaussian models.
#include "vog/gaussians.h"

#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "core/paging.h"
#include "vog/error.h"

namespace vog {

namespace {

bool finite(Vec3f v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

}  // namespace

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
    const Vec3d center = vec_cast<double>(gaussians.mean[i]);
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

void append(Gaussians& gaussians, const Gaussians& other) {
    if (gaussians.size() == 0 && gaussians.source.empty()) {
        gaussians = other;
        return;
    }
    if (gaussians.cutoff != other.cutoff)
        throw Error(
            fmt::format("{}: cutoff {}, expected {} as in {}: models with different kernels "
                        "cannot be one model",
                        other.source, other.cutoff, gaussians.cutoff, gaussians.source));
    if (!gaussians.axis_aligned() || !other.axis_aligned()) {
        resize_kept(gaussians.rotation, gaussians.size());
        append_kept(gaussians.rotation, other.rotation);
        resize_kept(gaussians.rotation, gaussians.size() + other.size());
    }
    append_kept(gaussians.mean, other.mean);
    append_kept(gaussians.scale, other.scale);
    append_kept(gaussians.density, other.density);
    gaussians.box.include(other.box);
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
    some.cutoff = gaussians.cutoff;
    some.box = gaussians.box;
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
    return some;
}

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
    if (!(gaussians.cutoff > 0 && gaussians.cutoff <= 8))
        fail(fmt::format("cutoff {}, expected in (0, 8] standard deviations", gaussians.cutoff));
    for (std::size_t i = 0; i < n; ++i) {
        keep_memory_at(i);
        const Vec3f s = gaussians.scale[i];
        const Vec3f mean = gaussians.mean[i];
        if (!finite(mean))
            fail(fmt::format("Gaussian {}: mean {} {} {}, expected finite", i, mean.x, mean.y,
                             mean.z));
        if (!finite(s) || !(s.x > 0 && s.y > 0 && s.z > 0))
            fail(fmt::format("Gaussian {}: scales {} {} {}, expected finite and > 0", i, s.x, s.y,
                             s.z));
        if (!(gaussians.density[i] >= 0) || !std::isfinite(gaussians.density[i]))
            fail(fmt::format("Gaussian {}: density {}, expected finite and >= 0", i,
                             gaussians.density[i]));
        if (gaussians.axis_aligned()) continue;
        const Quat q = gaussians.rotation[i];
        const float norm2 = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
        if (!(norm2 > 1e-12f) || !std::isfinite(norm2))
            fail(
                fmt::format("Gaussian {}: rotation {} {} {} {}, expected a quaternion of finite, "
                            "nonzero length",
                            i, q.w, q.x, q.y, q.z));
    }
}

}  // namespace vog
