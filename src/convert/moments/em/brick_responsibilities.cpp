// brick_responsibilities.cpp: density of the mixture at each sample of a brick, then
// responsibilities.
#include "convert/moments/em/brick_responsibilities.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "convert/moments/covariance_adjugate.h"

namespace vog::moments {

Vec3d support_half_extent(const Moments& cell) {
    const std::array<double, 6>& c = cell.covariance;
    return {kSupportDeviations * std::sqrt(c[0]), kSupportDeviations * std::sqrt(c[3]),
            kSupportDeviations * std::sqrt(c[5])};
}

CellKernel cell_kernel(const Moments& m) {
    const std::array<double, 6>& c = m.covariance;
    const auto [inverse, det] = adjugate_of(c);
    CellKernel kernel;
    kernel.mean = m.mean;
    for (std::size_t n = 0; n < 6; ++n)
        kernel.half_inverse[n] = static_cast<float>(0.5 * inverse[n] / det);
    kernel.peak = m.mass / std::sqrt(det);  // common factors cancel
    kernel.half_extent = support_half_extent(m);
    kernel.least_variance = std::min({c[0], c[3], c[5]});
    return kernel;
}

namespace {

/// Variance along an axis, samples squared, below which a cell needs four points in each sample.
constexpr double kFineVariance = 1;

/// A lattice with one point in each sample of a brick.
struct Points {
    Vec3d first;        ///< point of the first sample, index space; spacing as the brick's
    double volume = 1;  ///< volume that a point stands for, voxels
};

/// First and last of the integers 0 ... 7 in [low, high].
void indices_between(float low, float high, int& first, int& last) {
    const float from = std::clamp(low, 0.0f, 8.0f), to = std::clamp(high, -1.0f, 7.0f) + 1;
    first = static_cast<int>(from), last = static_cast<int>(to) - 1;
    first += static_cast<float>(first) < from;
}

/// Planes of x and pairs of rows of y that hold a brick's active samples, inclusive. Where data end, and where voxels
/// are scattered, most runs have none.
struct ActiveRuns {
    int x0 = 0, x1 = kLeafEdge - 1, y0 = 0, y1 = kLeafEdge / 2 - 1;
};
ActiveRuns active_runs(const Brick& brick) {
    ActiveRuns runs;
    if (!brick.leaf) return runs;
    const auto& mask = brick.leaf->mask;
    std::uint64_t rows = 0;
    for (const std::uint64_t plane : mask) rows |= plane;
    if (rows == 0) return runs;
    const auto plane = [&](int x) { return mask[static_cast<std::size_t>(x)]; };
    while (plane(runs.x0) == 0) ++runs.x0;
    while (plane(runs.x1) == 0) --runs.x1;
    runs.y0 = std::countr_zero(rows) / kRun;
    runs.y1 = (63 - std::countl_zero(rows)) / kRun;
    return runs;
}

/// Coefficients of a Gaussian relative to the points of a brick, and the runs that it covers.
/// run  out; written in place, as copying it costs a tenth of a step's time
void set_run(const CellKernel& kernel, const Points& points, double spacing,
             const ActiveRuns& active, RunKernel& run) {
    const Vec3f d = vec_cast<float>(points.first - kernel.mean);
    run.dx = d.x, run.dy = d.y, run.dz = d.z, run.step = static_cast<float>(spacing);
    const auto& h = kernel.half_inverse;
    constexpr float kPart = 1.0f / 16;
    run.xx = kPart * h[0], run.yy = kPart * h[3], run.zz = kPart * h[5];
    run.xy = 2 * kPart * h[1], run.xz = 2 * kPart * h[2], run.yz = 2 * kPart * h[4];
    run.peak = static_cast<float>(kernel.peak);
    const float per_step = 1 / run.step;
    const Vec3f half = vec_cast<float>(kernel.half_extent);
    indices_between(per_step * (-half.x - d.x), per_step * (half.x - d.x), run.x0, run.x1);
    indices_between(per_step * (-half.y - d.y), per_step * (half.y - d.y), run.y0, run.y1);
    if (run.y1 < run.y0) run.x1 = run.x0 - 1;
    run.x0 = std::max(run.x0, active.x0), run.x1 = std::min(run.x1, active.x1);
    run.y0 = std::max(run.y0 / 2, active.y0), run.y1 = std::min(run.y1 / 2, active.y1);
}

/// Calls take(sample, kernel, point - mean) for each sample outside all supports, with the Gaussian of the
/// least Mahalanobis distance.
template <class Take>
void for_each_uncovered(const Brick& brick, const Points& points,
                        std::span<const CellKernel> kernels, const BrickFloats& weight,
                        const Take& take) {
    for (int n = 0; n < kLeafVoxels; ++n) {
        if (brick.sample(n) <= 0 || weight[static_cast<std::size_t>(n)] > 0) continue;
        const Vec3d at =
            points.first + brick.spacing * Vec3d{double(n >> 6), double(n >> 3 & 7), double(n & 7)};
        std::size_t nearest = 0;
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < kernels.size(); ++i) {
            const CellKernel& k = kernels[i];
            const Vec3d d = at - k.mean;
            const auto& h = k.half_inverse;
            const double e = h[0] * d.x * d.x + h[3] * d.y * d.y + h[5] * d.z * d.z +
                             2 * (h[1] * d.x * d.y + h[2] * d.x * d.z + h[4] * d.y * d.z);
            if (e < least) least = e, nearest = i;
        }
        take(n, nearest, at - kernels[nearest].mean);
    }
}

/// Values of the kernels at the points, and their sums.
void evaluate_points(const Brick& brick, const Points& points, BrickScratch& scratch) {
    scratch.runs.clear();
    const ActiveRuns active = active_runs(brick);
    std::size_t count = 0;
    for (const CellKernel& kernel : scratch.kernels) {
        RunKernel& run = scratch.runs.emplace_back();
        set_run(kernel, points, brick.spacing, active, run);
        run.first_run = count;
        count += run.run_count();
    }
    if (count > scratch.capacity) {
        scratch.capacity = 2 * count;
        scratch.values = hwy::AllocateAligned<float>(kRun * scratch.capacity);
    }
    scratch.sum.fill(0);
    add_values(scratch.runs, scratch.values.get(), scratch.sum);
}

/// Replaces the sums by the weights that divide the mass.
/// returns  whether a point with mass is outside all supports
bool divide_points(const Brick& brick, const Points& points, BrickScratch& scratch) {
    const float* value = brick.leaf ? brick.leaf->value.data() : scratch.tile.data();
    return responsibility_weights(value, static_cast<float>(points.volume), scratch.sum);
}

/// Responsibilities for one lattice of points: adds kernel i's part to parts[i], about its mean.
void add_point_responsibilities(const Brick& brick, const Points& points, BrickScratch& scratch,
                                std::span<MomentSums> parts) {
    evaluate_points(brick, points, scratch);
    const bool any_uncovered = divide_points(brick, points, scratch);
    add_responsibilities(scratch.runs, scratch.values.get(), scratch.sum, parts);
    if (!any_uncovered) return;
    for_each_uncovered(brick, points, scratch.kernels, scratch.sum,
                       [&](int sample, std::size_t kernel, Vec3d from_mean) {
                           const double mass = brick.sample(sample) * points.volume;
                           add_shifted(parts[kernel], {mass, {}, {}}, from_mean);
                       });
}

}  // namespace

void add_brick_responsibilities(const Brick& brick, BrickScratch& scratch,
                                std::span<MomentSums> parts) {
    const Vec3d center = brick_cell_center(brick, 0, 1);
    const double sample = brick.spacing * brick.spacing, box = kBoxVariance * sample;
    if (!brick.leaf) scratch.tile.fill(brick.value);
    const bool fine = std::ranges::any_of(scratch.kernels, [&](const CellKernel& kernel) {
        return kernel.least_variance < kFineVariance * sample;
    });
    if (!fine) {
        // Points at the samples' centres, whose variance is added to the parts. In a constant field
        // this widens a cell by that much in every step, which is little for a large one.
        add_point_responsibilities(brick, {center, brick.sample_volume()}, scratch, parts);
        for (MomentSums& part : parts)
            for (const std::size_t n : {0, 3, 5}) part.second[n] += box * part.mass;
        return;
    }
    // Four points in each sample, the corners of a tetrahedron with half the variance of the box;
    // the other half is added to the parts. With all of it in the points, cells of single voxels
    // begin to fit the points (smoke at 13.5 %: L2 0.012 against 0.009); with less, cells of two
    // voxels widen.
    constexpr double kPoints = 4, kPointShare = 0.5;
    const double offset = std::sqrt(kPointShare * box);
    for (const Vec3d& corner :
         {Vec3d{1, 1, 1}, Vec3d{1, -1, -1}, Vec3d{-1, 1, -1}, Vec3d{-1, -1, 1}})
        add_point_responsibilities(
            brick, {center + offset * corner, brick.sample_volume() / kPoints}, scratch, parts);
    for (MomentSums& part : parts)
        for (const std::size_t n : {0, 3, 5}) part.second[n] += (1 - kPointShare) * box * part.mass;
}

void divide_samples(const Brick& brick, BrickScratch& scratch,
                    const std::function<void(BrickScratch&)>& weigh,
                    std::vector<UncoveredSample>& uncovered) {
    uncovered.clear();
    if (!brick.leaf) scratch.tile.fill(brick.value);
    const Points centers{brick_cell_center(brick, 0, 1), brick.sample_volume()};
    evaluate_points(brick, centers, scratch);
    if (weigh) weigh(scratch);
    if (!divide_points(brick, centers, scratch)) return;
    for_each_uncovered(brick, centers, scratch.kernels, scratch.sum,
                       [&](int sample, std::size_t kernel, Vec3d) {
                           uncovered.push_back({sample, kernel});
                       });
}

}  // namespace vog::moments
