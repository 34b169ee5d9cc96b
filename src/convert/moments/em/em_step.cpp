// em_step.cpp: the EM step over batches of bricks: overlaps of supports with batches,
// responsibilities, new moments of cells that no later batch overlaps.
#include "convert/moments/em/em_step.h"

#include <tbb/blocked_range.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "core/paging.h"
#include "core/parallel.h"

namespace vog::moments {

namespace {

/// Cells per parallel task.
constexpr std::size_t kChunk = 256;
std::size_t chunks_of(std::size_t cells) { return (cells + kChunk - 1) / kChunk; }

/// Whether the variance exceeds `least` in every direction: C - least I is positive definite, by
/// Sylvester's criterion.
bool wider_than(const std::array<double, 6>& c, double least) {
    const double xx = c[0] - least, yy = c[3] - least, zz = c[5] - least;
    const double minor = xx * yy - c[1] * c[1];
    const double det = xx * (yy * zz - c[4] * c[4]) - c[1] * (c[1] * zz - c[4] * c[2]) +
                       c[2] * (c[1] * c[4] - yy * c[2]);
    return xx > 0 && minor > 0 && det > 0;
}

/// Raises every eigenvalue to the variance of a voxel, which moments of points may fall below.
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

/// The change from one state of a cell to another.
EmHistory::Momentum packed_step(const Moments& from, const Moments& to) {
    const Vec3d step = to.mean - from.mean;
    EmHistory::Momentum packed;
    const auto set = [&](std::size_t n, double value) {
        packed[n] = to_bfloat16(static_cast<float>(value));
    };
    set(0, to.mass - from.mass), set(1, step.x), set(2, step.y), set(3, step.z);
    for (std::size_t n = 0; n < 6; ++n) set(4 + n, to.covariance[n] - from.covariance[n]);
    return packed;
}

/// from + times * step
Moments moved(const Moments& from, const EmHistory::Momentum& step, double times) {
    const auto part = [&](std::size_t n) { return times * double{from_bfloat16(step[n])}; };
    Moments to{from.mass + part(0), from.mean + Vec3d{part(1), part(2), part(3)}, from.covariance};
    for (std::size_t n = 0; n < 6; ++n) to.covariance[n] += part(4 + n);
    return to;
}

/// Nesterov extrapolation: adds momentum times the last step, unless the covariance would lose
/// positive definiteness.
/// step  in: the last step; out: the extrapolation
void extrapolate(PackedCells& cells, std::size_t i, EmHistory::Momentum& step, double momentum) {
    const Moments from = cells[i];
    Moments to = moved(from, step, momentum);
    to.mass = std::max(to.mass, 0.5 * from.mass);
    step = packed_step(from, to);
    to = moved(from, step, 1);
    if (wider_than(to.covariance, 0.5 * kBoxVariance))
        cells.set(i, to);
    else
        step = {};
}

/// M step of one cell: its moments become those of the sums.
/// sums  about the cell's mean
/// step  in: the extrapolation; out: the whole step, from before the extrapolation
void set_from_sums(PackedCells& cells, std::size_t i, const MomentSums& sums,
                   EmHistory::Momentum& step) {
    const Moments ahead = cells[i];
    Moments to;
    if (sums.mass > 0) {
        to = moments_of(sums);
        to.mean = to.mean + ahead.mean;
        widen_to_voxel(to.covariance);
    }
    cells.set(i, to);
    step = packed_step(moved(ahead, step, -1), to);
}

/// The cell whose mean is nearest to a point.
std::uint32_t nearest_cell(const Vec3d& center, const PackedCells& cells) {
    std::size_t nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const Vec3d d = cells[i].mean - center;
        if (dot(d, d) < least) least = dot(d, d), nearest = i;
    }
    return static_cast<std::uint32_t>(nearest);
}

}  // namespace

EmSolver::EmSolver(std::span<const Brick> bricks, std::vector<Vec3d> shifts)
    : bricks_(bricks), shifts_(std::move(shifts)), tree_(bricks) {
    shifts_.insert(shifts_.begin(), Vec3d{});
    while ((bricks.size() >> batch_log2_) >= kMostBatches) ++batch_log2_;
}

template <class Take>
void EmSolver::for_each_brick(const Moments& cell, std::size_t begin, std::size_t end,
                              const Take& take) const {
    const Vec3d half = support_half_extent(cell);
    for (std::uint32_t shift = 0; shift < shifts_.size(); ++shift) {
        const Vec3d at = cell.mean + shifts_[shift];
        tree_.for_each(voxel_box(at - half, at + half), begin, end,
                       [&](std::uint32_t brick) { take(brick, shift); });
    }
}

EmSolver::Overlaps EmSolver::find_overlaps(const PackedCells& cells) const {
    Overlaps overlaps;
    overlaps.batches.resize(cells.size());
    std::vector<std::atomic<bool>> is_covered(bricks_.size());
    std::vector<double> max_peak(chunks_of(cells.size()));
    vog::parallel_for(std::size_t{0}, max_peak.size(), [&](std::size_t chunk) {
        const std::size_t end = std::min((chunk + 1) * kChunk, cells.size());
        for (std::size_t i = chunk * kChunk; i < end; ++i) {
            const Moments cell = cells[i];
            max_peak[chunk] = std::max(max_peak[chunk], cell_kernel(cell).peak);
            for_each_brick(cell, 0, bricks_.size(), [&](std::uint32_t brick, std::uint32_t) {
                is_covered[brick].store(true, std::memory_order_relaxed);
                overlaps.batches[i] |= batch_bit(brick);
            });
        }
    });
    for (const double peak : max_peak) overlaps.max_peak = std::max(overlaps.max_peak, peak);
    for (std::size_t b = 0; b < bricks_.size(); ++b) {
        if (is_covered[b]) continue;
        const std::uint32_t cell = nearest_cell(brick_cell_center(bricks_[b], 0, 8), cells);
        overlaps.uncovered.push_back({static_cast<std::uint32_t>(b), cell, 0});
        overlaps.batches[cell] |= batch_bit(b);
    }
    overlaps.first_batches.resize(chunks_of(cells.size()));
    std::array<std::ptrdiff_t, kMostBatches + 1> change{};
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const std::uint64_t batches = overlaps.batches[i];
        if (batches == 0) continue;
        overlaps.first_batches[i / kChunk] |= batches & (~batches + 1);
        ++change[static_cast<std::size_t>(std::countr_zero(batches))];
        --change[static_cast<std::size_t>(std::bit_width(batches))];
    }
    std::ptrdiff_t active = 0, max_active = 0;
    for (const std::ptrdiff_t more : change) max_active = std::max(max_active, active += more);
    overlaps.max_active = static_cast<std::size_t>(max_active);
    return overlaps;
}

void EmSolver::activate(const Overlaps& overlaps, Batch& batch) const {
    const std::uint64_t bit = batch_bit(batch.first_brick);
    const auto carried = static_cast<std::ptrdiff_t>(batch.active.size());
    for (std::size_t chunk = 0; chunk < overlaps.first_batches.size(); ++chunk) {
        if (!(overlaps.first_batches[chunk] & bit)) continue;
        const std::size_t end = std::min((chunk + 1) * kChunk, overlaps.batches.size());
        for (std::size_t i = chunk * kChunk; i < end; ++i) {
            if ((overlaps.batches[i] & (bit | (bit - 1))) != bit) continue;
            batch.active.push_back({static_cast<std::uint32_t>(i), batch.free_sums.back()});
            batch.sums[batch.free_sums.back()] = {};
            batch.free_sums.pop_back();
        }
    }
    std::inplace_merge(batch.active.begin(), batch.active.begin() + carried, batch.active.end(),
                       [](const ActiveCell& a, const ActiveCell& b) { return a.cell < b.cell; });
}

EmSolver::BrickLists EmSolver::brick_lists(const PackedCells& cells, const Overlaps& overlaps,
                                           const Batch& batch) const {
    const std::uint64_t bit = batch_bit(batch.first_brick);
    std::vector<std::vector<Pair>> pairs(chunks_of(batch.active.size()) + 1);
    vog::parallel_for(std::size_t{0}, pairs.size() - 1, [&](std::size_t chunk) {
        const std::size_t end = std::min((chunk + 1) * kChunk, batch.active.size());
        for (std::size_t n = chunk * kChunk; n < end; ++n) {
            const std::uint32_t cell = batch.active[n].cell;
            if (!(overlaps.batches[cell] & bit)) continue;
            for_each_brick(
                cells[cell], batch.first_brick, batch.end_brick,
                [&](std::uint32_t brick, std::uint32_t shift) {
                    pairs[chunk].push_back({brick, static_cast<std::uint32_t>(n), shift});
                });
        }
    });
    for (const Pair& pair : overlaps.uncovered) {
        if (batch_bit(pair.brick) != bit) continue;
        const auto place = std::ranges::lower_bound(batch.active, pair.cell, {}, &ActiveCell::cell);
        pairs.back().push_back(
            {pair.brick, static_cast<std::uint32_t>(place - batch.active.begin()), pair.shift});
    }

    // Counting sort by brick; the cells of a brick stay in ascending order.
    BrickLists lists;
    lists.first.resize(batch.end_brick - batch.first_brick + 1);
    for (const auto& chunk : pairs)
        for (const Pair& pair : chunk) ++lists.first[pair.brick - batch.first_brick + 1];
    std::partial_sum(lists.first.begin(), lists.first.end(), lists.first.begin());
    lists.entries.resize(lists.first.back());
    std::vector<std::size_t> next(lists.first.begin(), lists.first.end() - 1);
    for (const auto& chunk : pairs)
        for (const Pair& pair : chunk)
            lists.entries[next[pair.brick - batch.first_brick]++] = {pair.cell, pair.shift};
    return lists;
}

void EmSolver::set_kernels(const PackedCells& cells, double max_peak, const BrickLists& lists,
                           const Batch& batch, std::size_t n, BrickScratch& scratch) const {
    scratch.kernels.clear();
    for (std::size_t entry = lists.first[n]; entry < lists.first[n + 1]; ++entry) {
        const auto [active, shift] = lists.entries[entry];
        CellKernel& kernel =
            scratch.kernels.emplace_back(cell_kernel(cells[batch.active[active].cell]));
        kernel.mean = kernel.mean + shifts_[shift];
        kernel.peak /= max_peak;
    }
}

void EmSolver::e_step(const PackedCells& cells, double max_peak, const BrickLists& lists,
                      Batch& batch) const {
    BigVector<MomentSums> parts(lists.entries.size());
    vog::parallel_for(tbb::blocked_range<std::size_t>(batch.first_brick, batch.end_brick, 2),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          BrickScratch& scratch = batch.scratches.local();
                          for (std::size_t b = range.begin(); b != range.end(); ++b) {
                              const std::size_t n = b - batch.first_brick;
                              set_kernels(cells, max_peak, lists, batch, n, scratch);
                              add_brick_responsibilities(
                                  bricks_[b], scratch,
                                  std::span(parts).subspan(lists.first[n], scratch.kernels.size()));
                          }
                      });
    for (std::size_t n = 0; n < parts.size(); ++n)
        add_shifted(batch.sums[batch.active[lists.entries[n].active].sums], parts[n], {});
}

void EmSolver::m_step(PackedCells& cells, const Overlaps& overlaps, Batch& batch,
                      EmHistory& history) const {
    const std::uint64_t later = later_batches(batch.first_brick);
    vog::parallel_for(std::size_t{0}, batch.active.size(), [&](std::size_t n) {
        const auto [cell, sums] = batch.active[n];
        if (!(overlaps.batches[cell] & later))
            set_from_sums(cells, cell, batch.sums[sums], history.momenta[cell]);
    });
    release(overlaps, batch);
}

void EmSolver::release(const Overlaps& overlaps, Batch& batch) const {
    const std::uint64_t later = later_batches(batch.first_brick);
    const auto is_done = [&](const ActiveCell& active) {
        return !(overlaps.batches[active.cell] & later);
    };
    for (const ActiveCell& active : batch.active)
        if (is_done(active)) batch.free_sums.push_back(active.sums);
    std::erase_if(batch.active, is_done);
}

void EmSolver::make_room(const Overlaps& overlaps, Batch& batch) {
    batch.active.reserve(overlaps.max_active);
    batch.sums.resize(overlaps.max_active);
    batch.free_sums.resize(overlaps.max_active);
    std::iota(batch.free_sums.begin(), batch.free_sums.end(), std::uint32_t{0});
}

std::size_t EmSolver::end_of_batch(std::size_t first_brick) const {
    return std::min(first_brick + (std::size_t{1} << batch_log2_), bricks_.size());
}

void EmSolver::add_shares(const PackedCells& cells, std::size_t width, const BrickParts& parts_of,
                          std::span<double> sums) const {
    const Overlaps overlaps = find_overlaps(cells);
    Batch batch;
    make_room(overlaps, batch);
    for (; batch.first_brick < bricks_.size(); batch.first_brick = batch.end_brick) {
        batch.end_brick = end_of_batch(batch.first_brick);
        activate(overlaps, batch);
        const BrickLists lists = brick_lists(cells, overlaps, batch);
        std::vector<std::uint32_t> cell(lists.entries.size());
        for (std::size_t n = 0; n < cell.size(); ++n)
            cell[n] = batch.active[lists.entries[n].active].cell;
        BigVector<double> parts(width * cell.size());
        vog::parallel_for(batch.first_brick, batch.end_brick, [&](std::size_t b) {
            BrickScratch& scratch = batch.scratches.local();
            const std::size_t n = b - batch.first_brick;
            set_kernels(cells, overlaps.max_peak, lists, batch, n, scratch);
            const std::size_t first = lists.first[n], count = scratch.kernels.size();
            parts_of(b, std::span(cell).subspan(first, count), scratch,
                     std::span(parts).subspan(width * first, width * count));
        });
        for (std::size_t n = 0; n < cell.size(); ++n) {
            keep_memory_at(n);
            for (std::size_t sum = 0; sum < width; ++sum)
                sums[width * cell[n] + sum] += parts[width * n + sum];
        }
        release(overlaps, batch);
    }
}

void EmSolver::step(PackedCells& cells, EmHistory& history) const {
    // Nesterov's momentum n / (n + 3), at most 0.8. Responsibilities of any Gaussians add up to 1,
    // so extrapolation does not change the total mass.
    constexpr double kMostMomentum = 0.8;
    const double momentum = std::min(kMostMomentum, history.taken / (history.taken + 3.0));
    history.momenta.resize(cells.size());
    if (history.taken++ > 0)
        vog::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t i) {
            extrapolate(cells, i, history.momenta[i], momentum);
        });

    const Overlaps overlaps = find_overlaps(cells);
    Batch batch;
    make_room(overlaps, batch);
    for (; batch.first_brick < bricks_.size(); batch.first_brick = batch.end_brick) {
        batch.end_brick = end_of_batch(batch.first_brick);
        activate(overlaps, batch);
        e_step(cells, overlaps.max_peak, brick_lists(cells, overlaps, batch), batch);
        m_step(cells, overlaps, batch, history);
    }

    // Cells without mass, and those whose support overlaps no brick, are removed.
    std::size_t kept = 0;
    cells.keep_if([&](std::size_t i) {
        const bool is_kept = overlaps.batches[i] != 0 && cells.mass(i) > 0;
        if (is_kept) history.momenta[kept++] = history.momenta[i];
        return is_kept;
    });
    history.momenta.resize(kept);
}

}  // namespace vog::moments
