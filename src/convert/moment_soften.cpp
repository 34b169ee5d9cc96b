// moment_soften.cpp: brick by brick: the sum of all Gaussians at each sample, then each one's
// share.
#include "convert/moment_soften.h"

#include <hwy/aligned_allocator.h>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "convert/moment_share.h"
#include "parallel.h"
#include "vog/memory.h"

namespace vog {

namespace {

/// Cells of less variance than this along an axis, in samples squared, feel a sample's own box.
constexpr double kFineVariance = 1;

/// A cell's Gaussian, ready for samples. As large as a cell: made anew for each brick.
struct Kernel {
    Vec3d mean, reach;                    ///< half extents of the box it reaches
    std::array<float, 6> half_inverse{};  ///< half the inverse covariance
    double peak = 0;
};

Kernel kernel_of(const Moments& m) {
    const std::array<double, 6>& c = m.covariance;
    const double xx = c[3] * c[5] - c[4] * c[4], xy = c[2] * c[4] - c[1] * c[5],
                 xz = c[1] * c[4] - c[2] * c[3], yy = c[0] * c[5] - c[2] * c[2],
                 yz = c[1] * c[2] - c[0] * c[4], zz = c[0] * c[3] - c[1] * c[1];
    const double det = c[0] * xx + c[1] * xy + c[2] * xz;
    Kernel kernel;
    kernel.mean = m.mean;
    const std::array<double, 6> inverse{xx, xy, xz, yy, yz, zz};
    for (std::size_t n = 0; n < 6; ++n)
        kernel.half_inverse[n] = static_cast<float>(0.5 * inverse[n] / det);
    kernel.peak = m.mass / std::sqrt(det);  // any common factor cancels
    kernel.reach = {kShareReach * std::sqrt(c[0]), kShareReach * std::sqrt(c[3]),
                    kShareReach * std::sqrt(c[5])};
    return kernel;
}

/// One point in each sample of a brick, all at the same place of it.
struct Points {
    Vec3d first;        ///< of the first sample; the next ones a spacing apart
    double volume = 1;  ///< voxels that a point stands for
};

/// What a thread needs for a brick.
struct Scratch {
    std::vector<Kernel> kernels;  ///< of the brick's list
    std::vector<RunKernel> runs;
    hwy::AlignedFreeUniquePtr<float[]> values;
    std::size_t capacity = 0;  ///< runs of values
    alignas(64) BrickFloats sum;
    BrickFloats tile;  ///< values, where there is no leaf
};

/// First and last of the places 0, 1, ... 7 in [low, high].
std::pair<int, int> places_between(float low, float high) {
    const float from = std::clamp(low, 0.0f, 8.0f), to = std::clamp(high, -1.0f, 7.0f) + 1;
    const int first = static_cast<int>(from), last = static_cast<int>(to) - 1;
    return {first + (static_cast<float>(first) < from), last};
}

/// Where a Gaussian lies among the points of a brick.
RunKernel run_kernel(const Kernel& kernel, const Points& points, double spacing) {
    RunKernel run;
    const Vec3f d = vec_cast<float>(points.first - kernel.mean);
    run.dx = d.x, run.dy = d.y, run.dz = d.z, run.step = static_cast<float>(spacing);
    const auto& h = kernel.half_inverse;
    constexpr float kPart = 1.0f / 16;
    run.xx = kPart * h[0], run.yy = kPart * h[3], run.zz = kPart * h[5];
    run.xy = 2 * kPart * h[1], run.xz = 2 * kPart * h[2], run.yz = 2 * kPart * h[4];
    run.peak = static_cast<float>(kernel.peak);
    const float per_step = 1 / run.step;
    const Vec3f half = vec_cast<float>(kernel.reach);
    std::tie(run.x0, run.x1) =
        places_between(per_step * (-half.x - d.x), per_step * (half.x - d.x));
    std::tie(run.y0, run.y1) =
        places_between(per_step * (-half.y - d.y), per_step * (half.y - d.y));
    if (run.y1 < run.y0) run.x1 = run.x0 - 1;
    run.y0 /= 2, run.y1 /= 2;
    return run;
}

/// Samples that no Gaussian reaches go whole to the one nearest in its own standard deviations.
void take_orphans(const Brick& brick, const Points& points, std::span<const Kernel> kernels,
                  const BrickFloats& weight, std::span<MomentSums> parts) {
    for (int n = 0; n < kLeafVoxels; ++n) {
        if (brick.sample(n) <= 0 || weight[static_cast<std::size_t>(n)] > 0) continue;
        const Vec3d at =
            points.first + brick.spacing * Vec3d{double(n >> 6), double(n >> 3 & 7), double(n & 7)};
        std::size_t nearest = 0;
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < kernels.size(); ++i) {
            const Kernel& k = kernels[i];
            const Vec3d d = at - k.mean;
            const auto& h = k.half_inverse;
            const double e = h[0] * d.x * d.x + h[3] * d.y * d.y + h[5] * d.z * d.z +
                             2 * (h[1] * d.x * d.y + h[2] * d.x * d.z + h[4] * d.y * d.z);
            if (e < least) least = e, nearest = i;
        }
        const double mass = brick.sample(n) * points.volume;
        const Vec3d d = at - kernels[nearest].mean;
        add_shifted(parts[nearest], {mass, {}, {}}, d);
    }
}

/// What each of the scratch's Gaussians takes of the points of one brick, added to parts[i] about
/// its mean.
void share_points(const Brick& brick, const Points& points, Scratch& scratch,
                  std::span<MomentSums> parts) {
    scratch.runs.clear();
    std::size_t count = 0;
    for (const Kernel& kernel : scratch.kernels) {
        scratch.runs.push_back(run_kernel(kernel, points, brick.spacing));
        scratch.runs.back().first_run = count;
        count += scratch.runs.back().run_count();
    }
    if (count > scratch.capacity) {
        scratch.capacity = 2 * count;
        scratch.values = hwy::AllocateAligned<float>(kRun * scratch.capacity);
    }
    scratch.sum.fill(0);
    add_values(scratch.runs, scratch.values.get(), scratch.sum);

    const float* value = brick.leaf ? brick.leaf->value.data() : scratch.tile.data();
    const bool any_orphan = weights_of(value, static_cast<float>(points.volume), scratch.sum);
    take_shares(scratch.runs, scratch.values.get(), scratch.sum, parts);
    if (any_orphan) take_orphans(brick, points, scratch.kernels, scratch.sum, parts);
}

/// What each Gaussian of the list takes of one brick: parts[i] for list[i], about its mean.
/// highest  peak of all Gaussians
void share_brick(const Brick& brick, std::span<const std::uint32_t> list,
                 std::span<const Moments> cells, double highest, Scratch& scratch,
                 std::span<MomentSums> parts) {
    const Vec3d center = brick_cell_center(brick, 0, 1);
    const double box = kBoxVariance * brick.spacing * brick.spacing;
    if (!brick.leaf) scratch.tile.fill(brick.value);
    bool fine = false;
    scratch.kernels.clear();
    for (const std::uint32_t cell : list) {
        scratch.kernels.push_back(kernel_of(cells[cell]));
        scratch.kernels.back().peak /= highest;
        const std::array<double, 6>& c = cells[cell].covariance;
        fine = fine || std::min({c[0], c[3], c[5]}) < kFineVariance * brick.spacing * brick.spacing;
    }
    if (!fine) {
        // Samples at their centres, their own variance added to what is taken. Where all densities
        // are even this widens a cell by as much at every step, which a large one does not feel.
        share_points(brick, {center, brick.sample_volume()}, scratch, parts);
        for (MomentSums& part : parts)
            for (const std::size_t n : {0, 3, 5}) part.second[n] += box * part.mass;
        return;
    }
    // Four points in each sample, the corners of a tetrahedron with half of the box's variance, the
    // rest added to what is taken. With all of it in the points the cells of single voxels start to
    // follow them (smoke at 13.5 %: L2 0.012 against 0.009); with less, cells of two widen.
    constexpr double kPoints = 4, kPointShare = 0.5;
    const double offset = std::sqrt(kPointShare * box);
    for (const Vec3d& corner :
         {Vec3d{1, 1, 1}, Vec3d{1, -1, -1}, Vec3d{-1, 1, -1}, Vec3d{-1, -1, 1}})
        share_points(brick, {center + offset * corner, brick.sample_volume() / kPoints}, scratch,
                     parts);
    for (MomentSums& part : parts)
        for (const std::size_t n : {0, 3, 5}) part.second[n] += (1 - kPointShare) * box * part.mass;
}

/// Whether the variance is more than `least` in every direction: Sylvester's criterion.
bool wider_than(const std::array<double, 6>& c, double least) {
    const double xx = c[0] - least, yy = c[3] - least, zz = c[5] - least;
    const double minor = xx * yy - c[1] * c[1];
    const double det = xx * (yy * zz - c[4] * c[4]) - c[1] * (c[1] * zz - c[4] * c[2]) +
                       c[2] * (c[1] * c[4] - yy * c[2]);
    return xx > 0 && minor > 0 && det > 0;
}

/// Raises the variance to a voxel's own in every direction: what shares of single points lack.
void widen_to_voxel(std::array<double, 6>& c) {
    if (wider_than(c, kBoxVariance)) return;
    Eigen3 eigen = symmetric_eigen(
        {{Vec3d{c[0], c[1], c[2]}, Vec3d{c[1], c[3], c[4]}, Vec3d{c[2], c[4], c[5]}}});
    Mat3 scaled = eigen.axes;
    for (int axis = 0; axis < 3; ++axis)
        for (int row = 0; row < 3; ++row)
            scaled(row, axis) *= std::max(eigen.values[axis], kBoxVariance);
    const Mat3 wide = scaled * transpose(eigen.axes);
    c = {wide(0, 0), wide(0, 1), wide(0, 2), wide(1, 1), wide(1, 2), wide(2, 2)};
}

/// As far again, times `momentum`, as the cell has come from `last`; where it is if that is no
/// ellipsoid.
Moments ahead(const Moments& cell, const Moments& last, double momentum) {
    Moments moved;
    moved.mass = std::max(cell.mass + momentum * (cell.mass - last.mass), 0.5 * cell.mass);
    moved.mean = cell.mean + momentum * (cell.mean - last.mean);
    for (std::size_t n = 0; n < 6; ++n)
        moved.covariance[n] =
            cell.covariance[n] + momentum * (cell.covariance[n] - last.covariance[n]);
    return wider_than(moved.covariance, 0.5 * kBoxVariance) ? moved : cell;
}

/// For a brick out of everyone's reach: the cell whose mean is nearest.
std::uint32_t nearest_cell(const Vec3d& center, std::span<const Moments> cells) {
    std::size_t nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const Vec3d d = cells[i].mean - center;
        if (dot(d, d) < least) least = dot(d, d), nearest = i;
    }
    return static_cast<std::uint32_t>(nearest);
}

}  // namespace

Softener::Softener(std::span<const Brick> bricks) : bricks_(bricks) {
    for (std::size_t b = 0; b < bricks.size(); ++b) {
        const double spacing = bricks[b].spacing;
        auto grid = std::find_if(grids_.begin(), grids_.end(),
                                 [&](const Grid& g) { return g.spacing == spacing; });
        if (grid == grids_.end()) grid = grids_.insert(grid, Grid{spacing, {}});
        const auto edge = static_cast<std::int32_t>(spacing * kLeafEdge);
        const Vec3i o = bricks[b].origin;  // a multiple of the edge
        grid->places.push_back(
            {{o.x / edge, o.y / edge, o.z / edge}, static_cast<std::uint32_t>(b)});
    }
    for (Grid& grid : grids_)
        std::sort(grid.places.begin(), grid.places.end(), [](const Place& a, const Place& b) {
            return std::tie(a.at.x, a.at.y, a.at.z) < std::tie(b.at.x, b.at.y, b.at.z);
        });
}

void Softener::find_bricks(const Vec3d& lower, const Vec3d& upper, std::uint32_t cell,
                           std::vector<Pair>& found) const {
    for (const Grid& grid : grids_) {
        // Bricks whose samples may lie in the box: samples are half a spacing inside the brick.
        const double edge = grid.spacing * kLeafEdge;
        const auto brick_at = [&](double index) {
            return static_cast<std::int32_t>(std::floor((index + 0.5) / edge));
        };
        for (std::int32_t x = brick_at(lower.x); x <= brick_at(upper.x); ++x)
            for (std::int32_t y = brick_at(lower.y); y <= brick_at(upper.y); ++y) {
                const std::int32_t last = brick_at(upper.z);
                const auto begin = std::lower_bound(
                    grid.places.begin(), grid.places.end(), Vec3i{x, y, brick_at(lower.z)},
                    [](const Place& place, Vec3i at) {
                        return std::tie(place.at.x, place.at.y, place.at.z) <
                               std::tie(at.x, at.y, at.z);
                    });
                for (auto place = begin; place != grid.places.end() && place->at.x == x &&
                                         place->at.y == y && place->at.z <= last;
                     ++place)
                    found.push_back({place->brick, cell});
            }
    }
}

void Softener::share(std::vector<Moments>& cells) const {
    // Gaussians, and the bricks each one reaches.
    constexpr std::size_t kCellChunk = 1024;
    struct Found {
        std::vector<Pair> pairs;
        double highest = 0;
    };
    std::vector<Found> found((cells.size() + kCellChunk - 1) / kCellChunk);
    vog::parallel_for(std::size_t{0}, found.size(), [&](std::size_t chunk) {
        auto& [pairs, highest] = found[chunk];
        const std::size_t end = std::min((chunk + 1) * kCellChunk, cells.size());
        for (std::size_t i = chunk * kCellChunk; i < end; ++i) {
            const Kernel kernel = kernel_of(cells[i]);
            highest = std::max(highest, kernel.peak);
            find_bricks(kernel.mean - kernel.reach, kernel.mean + kernel.reach,
                        static_cast<std::uint32_t>(i), pairs);
        }
        pairs.shrink_to_fit();
    });
    double highest = 0;
    for (const Found& chunk : found) highest = std::max(highest, chunk.highest);

    // Each brick's Gaussians, in order: a counting sort.
    std::vector<std::size_t> first(bricks_.size() + 1);
    for (const Found& chunk : found)
        for (const Pair& pair : chunk.pairs) ++first[pair.brick + 1];
    for (std::size_t b = 0; b < bricks_.size(); ++b) {
        if (first[b + 1] == 0) first[b + 1] = 1;  // reached by none: a place for the nearest
        first[b + 1] += first[b];
    }
    constexpr std::uint32_t kNone = 0xffffffffu;
    BigVector<std::uint32_t> list(first.back(), kNone);
    std::vector<std::size_t> next(first.begin(), first.end() - 1);
    for (auto& [pairs, _] : found) {
        for (const Pair& pair : pairs) list[next[pair.brick]++] = pair.cell;
        pairs = {};
    }

    // Shares, batch by batch: the parts of a batch are held apart, then added in order.
    // 64 batches, so that parts are few beside the cells; none too small for its threads.
    constexpr std::size_t kBatches = 64, kLeastBatch = 64;
    const std::size_t batch_size = std::max(kLeastBatch, bricks_.size() / kBatches);
    tbb::enumerable_thread_specific<Scratch> scratches;
    BigVector<MomentSums> sums(cells.size()), parts;
    for (std::size_t batch = 0; batch < bricks_.size(); batch += batch_size) {
        const std::size_t end = std::min(batch + batch_size, bricks_.size());
        parts.assign(first[end] - first[batch], {});
        vog::parallel_for(
            tbb::blocked_range<std::size_t>(batch, end, 2),
            [&](const tbb::blocked_range<std::size_t>& range) {
                Scratch& scratch = scratches.local();
                for (std::size_t b = range.begin(); b != range.end(); ++b) {
                    const std::size_t count = first[b + 1] - first[b];
                    if (list[first[b]] == kNone)
                        list[first[b]] = nearest_cell(brick_cell_center(bricks_[b], 0, 8), cells);
                    share_brick(bricks_[b], std::span(list).subspan(first[b], count), cells,
                                highest, scratch,
                                std::span(parts).subspan(first[b] - first[batch], count));
                }
            });
        for (std::size_t n = 0; n < parts.size(); ++n)
            add_shifted(sums[list[first[batch] + n]], parts[n], {});
    }

    // The new moments.
    vog::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t i) {
        const Vec3d mean = cells[i].mean;
        cells[i].mass = 0;
        if (!(sums[i].mass > 0)) return;
        cells[i] = moments_of(sums[i]);
        cells[i].mean = cells[i].mean + mean;
        widen_to_voxel(cells[i].covariance);
    });
    std::erase_if(cells, [](const Moments& cell) { return !(cell.mass > 0); });
}

void Softener::step(std::vector<Moments>& cells, SoftSteps& steps) const {
    // Nesterov's momentum: from 0 at the start to 0.8. Whatever Gaussians the shares are taken by,
    // they add up to the whole, so that mass is conserved all the same.
    constexpr double kMostMomentum = 0.8;
    const double momentum = std::min(kMostMomentum, steps.taken / (steps.taken + 3.0));
    const bool moving = steps.taken > 0 && steps.last.size() == cells.size();
    if (moving)
        vog::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t i) {
            const Moments from = cells[i];
            cells[i] = ahead(from, steps.last[i], momentum);
            steps.last[i] = from;
        });
    else
        steps.last = cells;
    ++steps.taken;
    share(cells);
}

void Softener::soften(std::vector<Moments>& cells, int steps) const {
    SoftSteps taken;
    for (int n = 0; n < steps; ++n) step(cells, taken);
}

}  // namespace vog
