// moment_soften.cpp: brick by brick: the sum of all Gaussians at each sample, then each one's
// share.
#include "convert/moment_soften.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

// The inner loops, also compiled for AVX2 and chosen at run time: the same operations in the same
// order, so the same bytes.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__)
#define VOG_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define VOG_WIDE
#endif

namespace vog {

namespace {

/// Gaussians reach this many standard deviations. Wider costs its cube and moves no figure.
constexpr double kReach = 3;
constexpr float kHalfReach2 = 0.5f * static_cast<float>(kReach * kReach);

/// Cells of less variance than this along an axis, in samples squared, feel a sample's own box.
constexpr double kFineVariance = 2.5;

using Row = std::array<float, kLeafEdge>;

/// A cell's Gaussian, ready for samples.
struct Kernel {
    Vec3d mean;
    std::array<float, 6> half_inverse{};  ///< half the inverse covariance
    float peak = 0;
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
    kernel.peak = static_cast<float>(m.mass / std::sqrt(det));  // any common factor cancels
    return kernel;
}

/// exp(-x) for x in [0, kHalfReach2], 1e-6 relative: (exp(-x/16))^16 with five terms of the series.
inline float exp_minus(float x) {
    const float t = x * 0.0625f;
    float y = 1 - t * (1 - t * 0.5f * (1 - t * (1.0f / 3) * (1 - t * 0.25f * (1 - t * 0.2f))));
    y *= y, y *= y, y *= y;
    return y * y;
}

/// The rows of a brick (8 samples along z) that a Gaussian reaches.
struct Reach {
    std::uint32_t cell = 0;
    int x0 = 0, x1 = -1, y0 = 0, y1 = -1;
    std::size_t first_row = 0;  ///< of its values
};

/// One point in each sample of a brick, all at the same place of it.
struct Points {
    Vec3d first;        ///< of the first sample; the next ones a spacing apart
    double volume = 1;  ///< voxels that a point stands for
};

/// What a thread needs for a brick.
struct Scratch {
    std::vector<Reach> reaches;
    std::vector<Row> values;
    std::array<float, kLeafVoxels> sum;
};

/// First and last of the samples first, first + spacing, ... (8 of them) within [lower, upper].
std::pair<int, int> sample_range(double lower, double upper, double first, double spacing) {
    const double low = std::ceil((lower - first) / spacing);
    const double high = std::floor((upper - first) / spacing);
    return {static_cast<int>(std::clamp(low, 0.0, 8.0)),
            static_cast<int>(std::clamp(high, -1.0, 7.0))};
}

Vec3d half_extent(const Moments& m) {
    return {kReach * std::sqrt(m.covariance[0]), kReach * std::sqrt(m.covariance[3]),
            kReach * std::sqrt(m.covariance[5])};
}

/// Values of one Gaussian at the samples it reaches, added to the sum of all.
VOG_WIDE void add_values(const Kernel& k, const Vec3d& first, double spacing, const Reach& reach,
                         Scratch& scratch) {
    const auto step = static_cast<float>(spacing);
    const auto dz0 = static_cast<float>(first.z - k.mean.z);
    Row* row = scratch.values.data() + reach.first_row;
    for (int x = reach.x0; x <= reach.x1; ++x)
        for (int y = reach.y0; y <= reach.y1; ++y, ++row) {
            const auto dx = static_cast<float>(first.x - k.mean.x) + step * static_cast<float>(x);
            const auto dy = static_cast<float>(first.y - k.mean.y) + step * static_cast<float>(y);
            const float c0 = k.half_inverse[0] * dx * dx + 2 * k.half_inverse[1] * dx * dy +
                             k.half_inverse[3] * dy * dy;
            const float c1 = 2 * (k.half_inverse[2] * dx + k.half_inverse[4] * dy);
            float* sum = scratch.sum.data() + leaf_offset(x, y, 0);
            for (int z = 0; z < kLeafEdge; ++z) {
                const float dz = dz0 + step * static_cast<float>(z);
                const float e = c0 + dz * (c1 + k.half_inverse[5] * dz);
                const float inside = e < kHalfReach2 ? k.peak : 0.0f;
                const float value = inside * exp_minus(std::min(std::max(e, 0.0f), kHalfReach2));
                (*row)[static_cast<std::size_t>(z)] = value;
                sum[z] += value;
            }
        }
}

/// Adds the shares one Gaussian has of the samples to `to`, about its mean. Each of the eight lanes
/// along z sums for itself: powers of x and y; those of z follow at the end.
VOG_WIDE void take_shares(const Kernel& k, const Vec3d& first, double spacing, const Reach& reach,
                          const Scratch& scratch, MomentSums& to) {
    Row s0{}, sx{}, sy{}, sxx{}, sxy{}, syy{};
    const auto step = static_cast<float>(spacing);
    const Row* row = scratch.values.data() + reach.first_row;
    for (int x = reach.x0; x <= reach.x1; ++x)
        for (int y = reach.y0; y <= reach.y1; ++y, ++row) {
            const auto dx = static_cast<float>(first.x - k.mean.x) + step * static_cast<float>(x);
            const auto dy = static_cast<float>(first.y - k.mean.y) + step * static_cast<float>(y);
            const float xx = dx * dx, xy = dx * dy, yy = dy * dy;
            const float* weight = scratch.sum.data() + leaf_offset(x, y, 0);
            for (std::size_t z = 0; z < kLeafEdge; ++z) {
                const float share = (*row)[z] * weight[z];
                s0[z] += share, sx[z] += share * dx, sy[z] += share * dy;
                sxx[z] += share * xx, sxy[z] += share * xy, syy[z] += share * yy;
            }
        }
    for (std::size_t z = 0; z < kLeafEdge; ++z) {
        const double dz = first.z - k.mean.z + spacing * static_cast<double>(z);
        to.mass += double{s0[z]};
        to.first = to.first + Vec3d{double{sx[z]}, double{sy[z]}, s0[z] * dz};
        to.second[0] += double{sxx[z]}, to.second[1] += double{sxy[z]};
        to.second[2] += sx[z] * dz, to.second[3] += double{syy[z]};
        to.second[4] += sy[z] * dz, to.second[5] += s0[z] * dz * dz;
    }
}

/// Samples that no Gaussian reaches go whole to the one nearest in its own standard deviations.
void take_orphans(const Brick& brick, const Points& points, std::span<const Kernel> kernels,
                  const Scratch& scratch, const std::array<bool, kLeafVoxels>& orphan,
                  std::span<MomentSums> parts) {
    for (int n = 0; n < kLeafVoxels; ++n) {
        if (!orphan[static_cast<std::size_t>(n)]) continue;
        const Vec3d at =
            points.first + brick.spacing * Vec3d{double(n >> 6), double(n >> 3 & 7), double(n & 7)};
        std::size_t nearest = 0;
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < scratch.reaches.size(); ++i) {
            const Kernel& k = kernels[scratch.reaches[i].cell];
            const Vec3d d = at - k.mean;
            const auto& h = k.half_inverse;
            const double e = h[0] * d.x * d.x + h[3] * d.y * d.y + h[5] * d.z * d.z +
                             2 * (h[1] * d.x * d.y + h[2] * d.x * d.z + h[4] * d.y * d.z);
            if (e < least) least = e, nearest = i;
        }
        const double mass = brick.sample(n) * points.volume;
        const Vec3d d = at - kernels[scratch.reaches[nearest].cell].mean;
        add_shifted(parts[nearest], {mass, {}, {}}, d);
    }
}

/// What each Gaussian of the list takes of the points of one brick, added to parts[i] about its
/// mean.
void share_points(const Brick& brick, const Points& points, std::span<const std::uint32_t> list,
                  std::span<const Moments> cells, std::span<const Kernel> kernels, Scratch& scratch,
                  std::span<MomentSums> parts) {
    const Vec3d first = points.first;
    scratch.reaches.clear();
    std::size_t rows = 0;
    for (const std::uint32_t cell : list) {
        const Vec3d mean = cells[cell].mean, half = half_extent(cells[cell]);
        Reach reach{cell, 0, -1, 0, -1, rows};
        std::tie(reach.x0, reach.x1) =
            sample_range(mean.x - half.x, mean.x + half.x, first.x, brick.spacing);
        std::tie(reach.y0, reach.y1) =
            sample_range(mean.y - half.y, mean.y + half.y, first.y, brick.spacing);
        if (reach.x1 >= reach.x0 && reach.y1 >= reach.y0)
            rows += static_cast<std::size_t>((reach.x1 - reach.x0 + 1) * (reach.y1 - reach.y0 + 1));
        scratch.reaches.push_back(reach);
    }
    scratch.values.resize(std::max(rows, scratch.values.size()));
    scratch.sum.fill(0);
    for (const Reach& reach : scratch.reaches)
        add_values(kernels[reach.cell], first, brick.spacing, reach, scratch);

    // From sums to the weight of each share: the point's mass over the sum.
    std::array<bool, kLeafVoxels> orphan{};
    bool any_orphan = false;
    for (int n = 0; n < kLeafVoxels; ++n) {
        float& sum = scratch.sum[static_cast<std::size_t>(n)];
        const float mass = brick.sample(n) * static_cast<float>(points.volume);
        const float weight = sum > 0 ? mass / sum : 0;
        const bool shared = sum > 0 && std::isfinite(weight);
        if (mass > 0 && !shared) orphan[static_cast<std::size_t>(n)] = any_orphan = true;
        sum = shared ? weight : 0;
    }
    for (std::size_t i = 0; i < scratch.reaches.size(); ++i)
        take_shares(kernels[scratch.reaches[i].cell], first, brick.spacing, scratch.reaches[i],
                    scratch, parts[i]);
    if (any_orphan) take_orphans(brick, points, kernels, scratch, orphan, parts);
}

/// What each Gaussian of the list takes of one brick: parts[i] for list[i], about its mean.
void share_brick(const Brick& brick, std::span<const std::uint32_t> list,
                 std::span<const Moments> cells, std::span<const Kernel> kernels, Scratch& scratch,
                 std::span<MomentSums> parts) {
    const Vec3d center = brick_cell_center(brick, 0, 1);
    const double box = kBoxVariance * brick.spacing * brick.spacing;
    bool fine = false;
    for (const std::uint32_t cell : list) {
        const std::array<double, 6>& c = cells[cell].covariance;
        fine = fine || std::min({c[0], c[3], c[5]}) < kFineVariance * brick.spacing * brick.spacing;
    }
    if (!fine) {
        // Samples at their centres, their own variance added to what is taken. Where all densities
        // are even this widens a cell by as much at every step, which a large one does not feel.
        share_points(brick, {center, brick.sample_volume()}, list, cells, kernels, scratch, parts);
        for (MomentSums& part : parts)
            for (const std::size_t n : {0, 3, 5}) part.second[n] += box * part.mass;
        return;
    }
    // Four points in each sample, the corners of a tetrahedron with the variance of the box: 1.5 dB
    // better for cells of two voxels.
    constexpr double kPoints = 4;
    const double offset = std::sqrt(box);
    for (const Vec3d& corner :
         {Vec3d{1, 1, 1}, Vec3d{1, -1, -1}, Vec3d{-1, 1, -1}, Vec3d{-1, -1, 1}})
        share_points(brick, {center + offset * corner, brick.sample_volume() / kPoints}, list,
                     cells, kernels, scratch, parts);
}

/// Raises the variance to a voxel's own in every direction: what shares of single points lack.
void widen_to_voxel(std::array<double, 6>& c) {
    // Sylvester: c - kBoxVariance I is positive definite for nearly all.
    const double xx = c[0] - kBoxVariance, yy = c[3] - kBoxVariance, zz = c[5] - kBoxVariance;
    const double minor = xx * yy - c[1] * c[1];
    const double det = xx * (yy * zz - c[4] * c[4]) - c[1] * (c[1] * zz - c[4] * c[2]) +
                       c[2] * (c[1] * c[4] - yy * c[2]);
    if (xx > 0 && minor > 0 && det > 0) return;
    Eigen3 eigen = symmetric_eigen(
        {{Vec3d{c[0], c[1], c[2]}, Vec3d{c[1], c[3], c[4]}, Vec3d{c[2], c[4], c[5]}}});
    Mat3 scaled = eigen.axes;
    for (int axis = 0; axis < 3; ++axis)
        for (int row = 0; row < 3; ++row)
            scaled(row, axis) *= std::max(eigen.values[axis], kBoxVariance);
    const Mat3 wide = scaled * transpose(eigen.axes);
    c = {wide(0, 0), wide(0, 1), wide(0, 2), wide(1, 1), wide(1, 2), wide(2, 2)};
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

void Softener::step(std::vector<Moments>& cells) const {
    // Gaussians, and the bricks each one reaches.
    constexpr std::size_t kCellChunk = 1024;
    std::vector<Kernel> kernels(cells.size());
    std::vector<std::vector<Pair>> found((cells.size() + kCellChunk - 1) / kCellChunk);
    tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t chunk) {
        const std::size_t end = std::min((chunk + 1) * kCellChunk, cells.size());
        for (std::size_t i = chunk * kCellChunk; i < end; ++i) {
            kernels[i] = kernel_of(cells[i]);
            const Vec3d half = half_extent(cells[i]);
            find_bricks(cells[i].mean - half, cells[i].mean + half, static_cast<std::uint32_t>(i),
                        found[chunk]);
        }
    });

    // Each brick's Gaussians, in order: a counting sort.
    std::vector<std::size_t> first(bricks_.size() + 1);
    for (const auto& pairs : found)
        for (const Pair& pair : pairs) ++first[pair.brick + 1];
    for (std::size_t b = 0; b < bricks_.size(); ++b) {
        if (first[b + 1] == 0) first[b + 1] = 1;  // reached by none: a place for the nearest
        first[b + 1] += first[b];
    }
    constexpr std::uint32_t kNone = 0xffffffffu;
    std::vector<std::uint32_t> list(first.back(), kNone);
    std::vector<std::size_t> next(first.begin(), first.end() - 1);
    for (auto& pairs : found) {
        for (const Pair& pair : pairs) list[next[pair.brick]++] = pair.cell;
        pairs = {};
    }

    // Shares, batch by batch: the parts of a batch are held apart, then added in order.
    constexpr std::size_t kBatch = 512;
    std::vector<MomentSums> sums(cells.size()), parts;
    for (std::size_t batch = 0; batch < bricks_.size(); batch += kBatch) {
        const std::size_t end = std::min(batch + kBatch, bricks_.size());
        parts.assign(first[end] - first[batch], {});
        tbb::parallel_for(
            tbb::blocked_range<std::size_t>(batch, end, 4),
            [&](const tbb::blocked_range<std::size_t>& range) {
                Scratch scratch;
                for (std::size_t b = range.begin(); b != range.end(); ++b) {
                    const std::size_t count = first[b + 1] - first[b];
                    if (list[first[b]] == kNone)
                        list[first[b]] = nearest_cell(brick_cell_center(bricks_[b], 0, 8), cells);
                    share_brick(bricks_[b], std::span(list).subspan(first[b], count), cells,
                                kernels, scratch,
                                std::span(parts).subspan(first[b] - first[batch], count));
                }
            });
        for (std::size_t n = 0; n < parts.size(); ++n)
            add_shifted(sums[list[first[batch] + n]], parts[n], {});
    }

    // The new moments.
    tbb::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t i) {
        const Vec3d mean = cells[i].mean;
        cells[i].mass = 0;
        if (!(sums[i].mass > 0)) return;
        cells[i] = moments_of(sums[i]);
        cells[i].mean = cells[i].mean + mean;
        widen_to_voxel(cells[i].covariance);
    });
    std::erase_if(cells, [](const Moments& cell) { return !(cell.mass > 0); });
}

}  // namespace vog
