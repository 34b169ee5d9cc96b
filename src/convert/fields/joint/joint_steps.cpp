// joint_steps.cpp: likelihoods from planes and residuals, sums over shares, new moments.
#include "convert/fields/joint/joint_steps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <utility>

#include "convert/fields/share_sums.h"
#include "core/paging.h"
#include "core/parallel.h"

namespace vog::joint {

namespace {

/// Mean square residual of a component of a field.
/// residuals  the Gaussian's sums
double residual_variance(const Layout& layout, std::size_t part, const double* residuals,
                         double mass) {
    const std::size_t field = layout.parts[part].field, c = layout.parts[part].component;
    constexpr std::array<std::size_t, 3> kDiagonal{0, 3, 5};
    return std::max(0.0, residuals[layout.first_sum[field] + kDiagonal[c]] / mass);
}

/// A part's mean position relative to its Gaussian's mean, and the covariance of its positions.
struct PartShape {
    Vec3d center;
    std::array<double, 6> covariance{};  ///< xx xy xz yy yz zz
    explicit PartShape(const WorldSums& sums) : center((1 / sums.mass) * sums.first) {
        std::size_t n = 0;
        for (int row = 0; row < 3; ++row)
            for (int column = row; column < 3; ++column)
                covariance[n++] =
                    sums.second(row, column) / sums.mass - center[row] * center[column];
    }
};

/// Planes and residuals of all Gaussians about their means.
struct Distributions {
    SharePlanes found;
    BigVector<double> residuals;

    explicit Distributions(const SharedFields& shared) : found(find_planes(shared)) {
        residuals = find_residuals(shared, found.planes);
    }
    /// Of the Gaussians of a model, whose part of the voxels is its own mass.
    Distributions(const Gaussians& model, const Layout& one,
                  std::span<const ValueDistribution> start) {
        const double within = variance_within(double{model.cutoff});
        resize_kept(residuals, one.residual_sums * model.size());
        for (std::size_t i = 0; i < model.size(); ++i) {
            WorldSums sums;
            sums.mass = mass(model, i);
            const auto c = moments::kernel_covariance(model, i);
            const double w = sums.mass * within;
            sums.second = {{Vec3d{w * c[0], w * c[1], w * c[2]},
                            Vec3d{w * c[1], w * c[3], w * c[4]},
                            Vec3d{w * c[2], w * c[4], w * c[5]}}};
            found.positions.push_back(sums);
            found.planes.push_back(start[i].plane);
            residuals[one.residual_sums * i] = sums.mass * start[i].variance;
        }
    }
};

/// Standard deviation of each component over all voxels.
std::vector<double> whole_deviations(const Distributions& of, const Layout& layout) {
    const std::size_t count = layout.parts.size();
    std::vector<double> deviations;
    for (std::size_t c = 0; c < count; ++c) {
        double mass = 0, first = 0, second = 0;
        for (std::size_t i = 0; i < of.found.positions.size(); ++i) {
            keep_memory_at(i);
            const WorldSums& part = of.found.positions[i];
            if (!(part.mass > 0)) continue;
            const WorldPlane& plane = of.found.planes[count * i + c];
            const PartShape shape(part);
            const Vec3d g = plane.gradient;
            const auto& k = shape.covariance;
            const double mean = plane.value + dot(g, shape.center);
            const double along = g.x * g.x * k[0] + g.y * g.y * k[3] + g.z * g.z * k[5] +
                                 2 * (g.x * g.y * k[1] + g.x * g.z * k[2] + g.y * g.z * k[4]);
            const double residual =
                residual_variance(layout, c, &of.residuals[layout.residual_sums * i], part.mass);
            mass += part.mass, first += part.mass * mean;
            second += part.mass * (mean * mean + along + residual);
        }
        const double variance = mass > 0 ? second / mass - first * first / (mass * mass) : 0;
        deviations.push_back(std::sqrt(std::max(variance, 0.0)));
    }
    return deviations;
}

/// Divisions by the distributions of one field's values.
/// part   first component of the field in the layout
/// least  [components] of the field: least deviations, > 0
/// period  JointSteps::periodic
std::deque<SoftDivision> joint_divisions(const Gaussians& model, std::span<const Volume> levels,
                                         std::span<const std::vector<VoxelField>> field,
                                         const Layout& layout, const Distributions& of,
                                         std::span<const double> least,
                                         const std::optional<Box>& period) {
    const std::size_t count = layout.parts.size();
    std::deque<SoftDivision> divisions;
    for (std::size_t level = 0; level < levels.size(); ++level) {
        const Mat3 to_index = transpose(levels[level].world_from_index.linear);
        BigVector<ValueNormal> normals;
        resize_kept(normals, count * model.size());
        for (std::size_t i = 0; i < model.size(); ++i) {
            keep_memory_at(i);
            const double mass = of.found.positions[i].mass;
            for (std::size_t c = 0; c < count; ++c) {
                const WorldPlane& plane = of.found.planes[count * i + c];
                const double variance =
                    mass > 0 ? residual_variance(layout, c, &of.residuals[layout.residual_sums * i],
                                                 mass)
                             : 0;
                normals[count * i + c] = {
                    {static_cast<float>(plane.value), vec_cast<float>(to_index * plane.gradient)},
                    static_cast<float>(1 / std::max(std::sqrt(variance), least[c]))};
            }
        }
        divisions.emplace_back(
            model, levels[level], period,
            ValueLikelihood(layout.components(levels[level], field, level), std::move(normals)));
    }
    return divisions;
}

/// Gives every Gaussian the moments of its part, and makes planes relative to the new means.
void move_to_parts(Gaussians& model, SharePlanes& found, std::size_t components) {
    const moments::MomentFrame frame =
        moments::moment_frame(Affine{}, model.axis_aligned(), 1, model.cutoff);
    vog::parallel_for(std::size_t{0}, model.size(), [&](std::size_t i) {
        const WorldSums& part = found.positions[i];
        if (!(part.mass > 0)) {
            model.density[i] = 0;
            return;
        }
        const PartShape shape(part);
        const Vec3d mean = vec_cast<double>(model.mean[i]) + shape.center;
        moments::set_gaussian(model, i, {part.mass, mean, shape.covariance}, frame);
        for (std::size_t c = 0; c < components; ++c) {
            WorldPlane& plane = found.planes[components * i + c];
            plane.value += dot(plane.gradient, shape.center);
        }
    });
}

}  // namespace

void add_by_joint_steps(Gaussians& model, std::span<const Volume> levels,
                        std::span<const std::vector<VoxelField>> fields, const Layout& layout,
                        const JointSteps& joint, const Progress& progress, FieldEntries& entries) {
    const auto one = fields.subspan(joint.field, 1);
    const Layout own(one);
    std::deque<SoftDivision> divisions;
    if (joint.start.empty())
        for (const Volume& volume : levels) divisions.emplace_back(model, volume, joint.periodic);
    Distributions values = joint.start.empty()
                               ? Distributions(SharedFields{model, levels, divisions, one, own})
                               : Distributions(model, own, joint.start);
    std::vector<double> least = whole_deviations(values, own);
    for (double& deviation : least)
        // A constant field: all distributions alike.
        deviation = deviation > 0 ? kLeastDeviation * deviation : 1;
    for (int step = 1; step <= joint.steps; ++step) {
        if (progress) progress(static_cast<double>(step) / (joint.steps + 1));
        divisions = joint_divisions(model, levels, one, own, values, least, joint.periodic);
        if (step < joint.steps) {
            values = Distributions({model, levels, divisions, one, own});
            move_to_parts(model, values.found, own.parts.size());
            continue;
        }
        Distributions all({model, levels, divisions, fields, layout});
        move_to_parts(model, all.found, layout.parts.size());
        for (std::size_t i = 0; i < model.size(); ++i) {
            keep_memory_at(i);
            entries.set(i, &all.found.planes[layout.parts.size() * i],
                        &all.residuals[layout.residual_sums * i], all.found.positions[i].mass);
        }
    }
}

std::size_t remove_empty(Gaussians& model) {
    std::vector<std::size_t> kept;
    for (std::size_t i = 0; i < model.size(); ++i)
        if (model.density[i] > 0) kept.push_back(i);
    const std::size_t removed = model.size() - kept.size();
    if (removed == 0) return 0;
    Gaussians rest = select(model, kept);
    rest.source_voxels = model.source_voxels, rest.summary = model.summary;
    model = std::move(rest);
    return removed;
}

}  // namespace vog::joint
