// soften.cpp: the E step over runs of particles, whose cells a tree of boxes finds, and the M step.
#include "convert/particles/soften.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "convert/moments/em/brick_responsibilities.h"
#include "core/paging.h"
#include "core/parallel.h"

namespace vog::particles {

namespace {

/// Particles of a run, evaluated together.
constexpr std::size_t kRunLength = 64;

struct FloatBox {
    Vec3f lower, upper;
    bool overlaps(const FloatBox& o) const {
        return bool((lower.x <= o.upper.x) & (o.lower.x <= upper.x) & (lower.y <= o.upper.y) &
                    (o.lower.y <= upper.y) & (lower.z <= o.upper.z) & (o.lower.z <= upper.z));
    }
};

/// Bounding boxes of supports, and of 8, 64, ... that follow each other.
class SupportTree {
  public:
    explicit SupportTree(std::span<const CellKernel> kernels) : levels_(1) {
        levels_[0].resize(kernels.size());
        vog::parallel_for(std::size_t{0}, kernels.size(), [&](std::size_t i) {
            const CellKernel& k = kernels[i];
            levels_[0][i] = {vec_cast<float>(k.mean - k.half_extent),
                             vec_cast<float>(k.mean + k.half_extent)};
        });
        while (levels_.back().size() > kFanout) {
            const BigVector<FloatBox>& fine = levels_.back();
            BigVector<FloatBox> coarse((fine.size() + kFanout - 1) / kFanout);
            for (std::size_t n = 0; n < fine.size(); ++n) {
                FloatBox& to = coarse[n / kFanout];
                if (n % kFanout == 0) to = fine[n];
                for (int axis = 0; axis < 3; ++axis) {
                    to.lower[axis] = std::min(to.lower[axis], fine[n].lower[axis]);
                    to.upper[axis] = std::max(to.upper[axis], fine[n].upper[axis]);
                }
            }
            levels_.push_back(std::move(coarse));
        }
    }
    /// Appends the supports that overlap a box, in ascending order.
    void find(const FloatBox& box, std::vector<std::uint32_t>& found) const {
        for (std::size_t n = 0; n < levels_.back().size(); ++n)
            find(box, levels_.size() - 1, n, found);
    }

  private:
    static constexpr std::size_t kFanout = 8;
    void find(const FloatBox& box, std::size_t level, std::size_t n,
              std::vector<std::uint32_t>& found) const {
        if (!levels_[level][n].overlaps(box)) return;
        if (level == 0) return found.push_back(static_cast<std::uint32_t>(n));
        const std::size_t end = std::min(kFanout * (n + 1), levels_[level - 1].size());
        for (std::size_t below = kFanout * n; below < end; ++below)
            find(box, level - 1, below, found);
    }

    std::vector<BigVector<FloatBox>> levels_;
};

using RunFloats = std::array<float, kRunLength>;

/// A run of particles, relative to the first one.
struct Run {
    std::span<const Particle> particles;
    Vec3d origin;
    FloatBox box;
    RunFloats x{}, y{}, z{};

    explicit Run(std::span<const Particle> of) : particles(of), origin(of.front().place) {
        box = {vec_cast<float>(origin), vec_cast<float>(origin)};
        for (std::size_t k = 0; k < of.size(); ++k) {
            const Vec3d d = of[k].place - origin;
            x[k] = static_cast<float>(d.x), y[k] = static_cast<float>(d.y);
            z[k] = static_cast<float>(d.z);
            const Vec3f at = vec_cast<float>(of[k].place);
            for (int axis = 0; axis < 3; ++axis) {
                box.lower[axis] = std::min(box.lower[axis], at[axis]);
                box.upper[axis] = std::max(box.upper[axis], at[axis]);
            }
        }
    }
};

/// Values of a cell's Gaussian at the particles, 0 beyond its support; adds them to `sum`.
void add_values(const CellKernel& kernel, const Run& run, RunFloats& values, RunFloats& sum) {
    const Vec3f shift = vec_cast<float>(run.origin - kernel.mean);
    const auto& h = kernel.half_inverse;
    const float xy = 2 * h[1], xz = 2 * h[2], yz = 2 * h[4];
    const auto peak = static_cast<float>(kernel.peak);
    constexpr float kEnd = static_cast<float>(0.5 * kSupportDeviations * kSupportDeviations);
    for (std::size_t k = 0; k < kRunLength; ++k) {
        const float x = run.x[k] + shift.x, y = run.y[k] + shift.y, z = run.z[k] + shift.z;
        const float e = x * (h[0] * x + xy * y + xz * z) + y * (h[3] * y + yz * z) + h[5] * z * z;
        // exp(-e), as add_values in responsibility_kernels.cpp
        const float u = e > 0 ? e * (1.0f / 16) : 0;
        float t = 1 - u * (1 - 0.5f * u);
        t *= t, t *= t, t *= t, t *= t;
        const float value = e < kEnd ? peak * t : 0;
        values[k] = value;
        sum[k] += value;
    }
}

/// Adds a part of a particle to sums about a point.
void add_particle(MomentSums& to, const Particle& particle, double mass, Vec3d about) {
    MomentSums one{mass, {}, {}};
    for (std::size_t n = 0; n < 6; ++n) one.second[n] = mass * particle.covariance[n];
    add_shifted(to, one, particle.place - about);
}

/// The cell with the least Mahalanobis distance, of some or of all.
std::uint32_t nearest_cell(std::span<const CellKernel> kernels, std::span<const std::uint32_t> some,
                           Vec3d place) {
    std::uint32_t nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    const std::size_t count = some.empty() ? kernels.size() : some.size();
    for (std::size_t n = 0; n < count; ++n) {
        const auto i = some.empty() ? static_cast<std::uint32_t>(n) : some[n];
        const Vec3d d = place - kernels[i].mean;
        const auto& h = kernels[i].half_inverse;
        const double e = h[0] * d.x * d.x + h[3] * d.y * d.y + h[5] * d.z * d.z +
                         2 * (h[1] * d.x * d.y + h[2] * d.x * d.z + h[4] * d.y * d.z);
        if (e < least) least = e, nearest = i;
    }
    return nearest;
}

/// Parts of the particles of one run.
struct RunParts {
    std::vector<std::uint32_t> cell;  ///< that have some, ascending but for uncovered particles
    std::vector<MomentSums> sums;     ///< [cell] about its mean
    std::vector<ParticlePart> parts;  ///< where they are requested
};

/// Divides the particles of a run.
/// first  index of its first particle
void divide_run(const Run& run, std::size_t first, std::span<const CellKernel> kernels,
                const SupportTree& supports, bool with_parts, RunParts& to) {
    supports.find(run.box, to.cell);
    thread_local std::vector<RunFloats> values;
    values.resize(std::max(values.size(), to.cell.size()));
    RunFloats sum{};
    for (std::size_t n = 0; n < to.cell.size(); ++n)
        add_values(kernels[to.cell[n]], run, values[n], sum);
    to.sums.resize(to.cell.size());
    const auto add = [&](std::size_t n, std::size_t k, double share) {
        const Particle& particle = run.particles[k];
        add_particle(to.sums[n], particle, share * particle.mass, kernels[to.cell[n]].mean);
        if (with_parts)
            to.parts.push_back({to.cell[n], static_cast<std::uint32_t>(first + k), share});
    };
    const std::size_t found = to.cell.size();
    for (std::size_t n = 0; n < found; ++n)
        for (std::size_t k = 0; k < run.particles.size(); ++k)
            if (values[n][k] > 0 && sum[k] > kLeastSum) add(n, k, double{values[n][k]} / sum[k]);
    for (std::size_t k = 0; k < run.particles.size(); ++k) {
        if (sum[k] > kLeastSum) continue;
        to.cell.push_back(
            nearest_cell(kernels, std::span(to.cell).first(found), run.particles[k].place));
        to.sums.emplace_back();
        add(to.cell.size() - 1, k, 1);
    }
}

/// The parts of all particles, as sums about the means of the cells.
/// parts  null: not wanted
std::vector<MomentSums> divided(const PointTree& tree, std::span<const CellKernel> kernels,
                                BigVector<ParticlePart>* parts) {
    const SupportTree supports(kernels);
    std::vector<MomentSums> sums(kernels.size());
    const std::size_t count = tree.particles.size();
    constexpr std::size_t kBatch = 1024 * kRunLength;  // bounds the memory of sums of runs
    for (std::size_t begin = 0; begin < count; begin += kBatch) {
        const std::size_t end = std::min(begin + kBatch, count);
        std::vector<RunParts> runs((end - begin + kRunLength - 1) / kRunLength);
        vog::parallel_for(std::size_t{0}, runs.size(), [&](std::size_t r) {
            const std::size_t first = begin + r * kRunLength;
            const std::span all(tree.particles);
            const Run run(all.subspan(first, std::min(kRunLength, end - first)));
            divide_run(run, first, kernels, supports, parts != nullptr, runs[r]);
        });
        // In the order of runs: the same bytes for any number of threads.
        for (const RunParts& run : runs) {
            keep_memory();
            for (std::size_t n = 0; n < run.cell.size(); ++n)
                add_shifted(sums[run.cell[n]], run.sums[n], {});
            if (parts) parts->insert(parts->end(), run.parts.begin(), run.parts.end());
        }
    }
    return sums;
}

/// Whether C - least B is positive definite, by Sylvester's criterion.
bool exceeds(const std::array<double, 6>& c, const std::array<double, 6>& b, double least) {
    std::array<double, 6> d;
    for (std::size_t n = 0; n < 6; ++n) d[n] = c[n] - least * b[n];
    const double minor = d[0] * d[3] - d[1] * d[1];
    const double det = d[0] * (d[3] * d[5] - d[4] * d[4]) - d[1] * (d[1] * d[5] - d[4] * d[2]) +
                       d[2] * (d[1] * d[4] - d[3] * d[2]);
    return d[0] > 0 && minor > 0 && det > 0;
}

/// Nesterov extrapolation from the step before, as that of voxels (moments/em/em_step.cpp).
Moments extrapolated(const Moments& now, const Moments& before, double momentum) {
    Moments to = now;
    to.mass = std::max(now.mass + momentum * (now.mass - before.mass), 0.5 * now.mass);
    to.mean = now.mean + momentum * (now.mean - before.mean);
    for (std::size_t n = 0; n < 6; ++n)
        to.covariance[n] += momentum * (now.covariance[n] - before.covariance[n]);
    constexpr double kLeast = 0.2;  // of the variance in any direction
    return exceeds(to.covariance, now.covariance, kLeast) ? to : now;
}

}  // namespace

void soften(const PointTree& tree, BigVector<Moments>& cells, int steps,
            BigVector<ParticlePart>* parts) {
    constexpr double kMostMomentum = 0.8;
    BigVector<Moments> before;
    for (int taken = 0; taken < steps; ++taken) {
        const double momentum = std::min(kMostMomentum, taken / (taken + 3.0));
        std::vector<CellKernel> kernels(cells.size());
        vog::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t i) {
            kernels[i] = cell_kernel(before.empty() ? cells[i]
                                                    : extrapolated(cells[i], before[i], momentum));
        });
        double most = 0;
        for (const CellKernel& kernel : kernels) most = std::max(most, kernel.peak);
        for (CellKernel& kernel : kernels) kernel.peak /= most;
        const bool last = taken + 1 == steps;
        const std::vector<MomentSums> sums = divided(tree, kernels, last ? parts : nullptr);
        before = cells;
        std::vector<std::uint32_t> place(cells.size());
        std::size_t kept = 0;
        for (std::size_t i = 0; i < cells.size(); ++i) {
            if (!(sums[i].mass > 0)) continue;
            Moments of = moments_of(sums[i]);
            // Particles may be smaller than a voxel, the least that moments_of expects.
            for (const auto& [n, axis] : {std::pair{0u, 0}, {3u, 1}, {5u, 2}})
                of.covariance[n] =
                    std::max(sums[i].second[n] / sums[i].mass - of.mean[axis] * of.mean[axis], 0.0);
            of.mean = of.mean + kernels[i].mean;
            before[kept] = before[i];
            cells[kept] = of;
            place[i] = static_cast<std::uint32_t>(kept++);
        }
        cells.resize(kept), before.resize(kept);
        if (parts)
            for (ParticlePart& part : *parts) part.cell = place[part.cell];
    }
    if (parts) std::ranges::stable_sort(*parts, {}, &ParticlePart::cell);
}

}  // namespace vog::particles
