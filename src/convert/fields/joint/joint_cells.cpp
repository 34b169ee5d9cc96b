// joint_cells.cpp: moments of position and value of halves and of pairs.
#include "convert/fields/joint/joint_cells.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "convert/moments/refine/split_merge.h"
#include "core/parallel.h"

namespace vog::joint {

namespace {

/// Covariance times a vector.
Vec3d times(const std::array<double, 6>& c, Vec3d v) {
    return {c[0] * v.x + c[1] * v.y + c[2] * v.z, c[1] * v.x + c[3] * v.y + c[4] * v.z,
            c[2] * v.x + c[4] * v.y + c[5] * v.z};
}

/// The cell with the moments of both.
JointCell joined(const JointCell& a, const JointCell& b) {
    JointCell both{moments::joined_moments(std::array{a.moments, b.moments}), {}};
    const double mass = both.moments.mass;
    const double value =
        (a.moments.mass * a.value.plane.value + b.moments.mass * b.value.plane.value) / mass;
    Vec3d with;  // covariance of position and value
    double variance = 0;
    for (const JointCell& cell : {a, b}) {
        const double share = cell.moments.mass / mass;
        const Vec3d gradient = cell.value.plane.gradient;
        const Vec3d along = times(cell.moments.covariance, gradient);
        const double from_mean = cell.value.plane.value - value;
        with = with + share * (along + from_mean * (cell.moments.mean - both.moments.mean));
        variance += share * (dot(gradient, along) + cell.value.variance + from_mean * from_mean);
    }
    both.value.plane = {value, least_squares(both.moments.covariance, with)};
    both.value.variance = std::max(0.0, variance - dot(both.value.plane.gradient, with));
    return both;
}

/// Halves with the plane of the whole.
std::array<JointCell, 2> split_along(const JointCell& cell, SplitAlong along) {
    const Vec3d gradient = cell.value.plane.gradient;
    const Vec3d with = times(cell.moments.covariance, gradient);
    const double variance = dot(gradient, with);
    const auto halves =
        along == SplitAlong::gradient && variance > 0
            ? moments::split_in_two(cell.moments,
                                    std::sqrt(moments::kHalvesVariance / variance) * with)
            : moments::split_in_two(cell.moments);
    std::array<JointCell, 2> parts{cell, cell};
    for (std::size_t n = 0; n < 2; ++n) {
        parts[n].moments = halves[n];
        parts[n].value.plane.value += dot(gradient, halves[n].mean - cell.moments.mean);
    }
    return parts;
}

struct JointRules {
    SplitAlong along;
    double length, least_variance;

    struct Candidate {
        JointCell cell;
        double log_determinant;
    };
    static Vec3d mean(const JointCell& cell) { return cell.moments.mean; }
    /// Of the covariance of position and value.
    double log_determinant(const JointCell& cell) const {
        std::array<double, 6> covariance = cell.moments.covariance;
        for (double& entry : covariance) entry /= length * length;
        return moments::log_determinant(covariance) +
               std::log(std::max(cell.value.variance, least_variance));
    }
    Candidate candidate(const JointCell& cell) const { return {cell, log_determinant(cell)}; }
    static JointCell joined(const JointCell& a, const JointCell& b) { return joint::joined(a, b); }
    std::array<JointCell, 2> split(const JointCell& cell) const { return split_along(cell, along); }
    double cost(const Candidate& a, const Candidate& b) const {
        const JointCell both = joint::joined(a.cell, b.cell);
        const double divergence = both.moments.mass * log_determinant(both) -
                                  a.cell.moments.mass * a.log_determinant -
                                  b.cell.moments.mass * b.log_determinant;
        return 0.5 * divergence / std::sqrt(both.moments.mass);
    }
};

}  // namespace

JointCells::JointCells(const Gaussians& model, const ScalarField& field, const Layout::Part& part)
    : cells_(model.size()) {
    const double unit{part.unit}, within = variance_within(double{model.cutoff});
    vog::parallel_for(std::size_t{0}, cells_.size(), [&](std::size_t i) {
        JointCell& cell = cells_[i];
        cell.moments = {mass(model, i), vec_cast<double>(model.mean[i]),
                        moments::kernel_covariance(model, i)};
        for (double& entry : cell.moments.covariance) entry *= within;
        const double r = double{field.deviation[i]} / unit;
        cell.value = {{(double{field.value[i]} - double{part.reference}) / unit,
                       (1 / unit) * vec_cast<double>(field.gradient[i])},
                      r * r};
    });
    double all = 0, extent = 0, first = 0, second = 0;
    for (const JointCell& cell : cells_) {
        const double m = cell.moments.mass;
        const auto& c = cell.moments.covariance;
        const Vec3d g = cell.value.plane.gradient;
        all += m, extent += m * std::sqrt((c[0] + c[3] + c[5]) / 3);
        first += m * cell.value.plane.value;
        second += m * (cell.value.plane.value * cell.value.plane.value + dot(g, times(c, g)) +
                       cell.value.variance);
    }
    if (!(all > 0)) return;
    length_ = extent / all;
    least_variance_ = kLeastDeviation * kLeastDeviation *
                      std::max(second / all - (first / all) * (first / all), 1e-30);
}

void JointCells::split_and_merge(std::span<const float> error, double share, SplitAlong along) {
    moments::split_and_merge(*this, error, share, JointRules{along, length_, least_variance_});
}

Gaussians JointCells::to_gaussians(const Gaussians& of) const {
    Gaussians model;
    model.origin = of.origin, model.cutoff = of.cutoff, model.box = of.box;
    model.content = of.content;
    model.source_voxels = of.source_voxels;
    model.source = of.source, model.method = of.method;
    model.options = of.options, model.summary = of.summary;
    moments::resize(model, size(), of.axis_aligned());
    const moments::MomentFrame frame =
        moments::moment_frame(Affine{}, of.axis_aligned(), 1, double{of.cutoff});
    vog::parallel_for(std::size_t{0}, size(), [&](std::size_t i) {
        moments::set_gaussian(model, i, cells_[i].moments, frame);
    });
    return model;
}

std::vector<ValueDistribution> JointCells::distributions() const {
    std::vector<ValueDistribution> all;
    for (const JointCell& cell : cells_) all.push_back(cell.value);
    return all;
}

}  // namespace vog::joint
