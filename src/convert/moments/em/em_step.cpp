// em_step.cpp: a soft step, batch by batch of bricks: who reaches them, what each takes, the
// new moments of those that no later batch is reached by.
#include "convert/moments/em/em_step.h"

#include <tbb/blocked_range.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "core/parallel.h"

namespace vog::moments {

namespace {

/// Cells go to threads in runs of this many.
constexpr std::size_t kChunk = 256;
std::size_t chunks_of(std::size_t cells) { return (cells + kChunk - 1) / kChunk; }

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

EmHistory::Momentum packed_way(const Moments& from, const Moments& to) {
    const Vec3d way = to.mean - from.mean;
    EmHistory::Momentum packed;
    const auto set = [&](std::size_t n, double value) {
        packed[n] = to_bfloat16(static_cast<float>(value));
    };
    set(0, to.mass - from.mass), set(1, way.x), set(2, way.y), set(3, way.z);
    for (std::size_t n = 0; n < 6; ++n) set(4 + n, to.covariance[n] - from.covariance[n]);
    return packed;
}

/// `times` the way from `from`.
Moments gone(const Moments& from, const EmHistory::Momentum& way, double times) {
    const auto part = [&](std::size_t n) { return times * double{from_bfloat16(way[n])}; };
    Moments to{from.mass + part(0), from.mean + Vec3d{part(1), part(2), part(3)}, from.covariance};
    for (std::size_t n = 0; n < 6; ++n) to.covariance[n] += part(4 + n);
    return to;
}

/// Moves a cell as far again, times `momentum`, as it came last; not where that is no ellipsoid.
/// way  how it came; then how far it was moved
void look_ahead(PackedCells& cells, std::size_t i, EmHistory::Momentum& way, double momentum) {
    const Moments from = cells[i];
    Moments to = gone(from, way, momentum);
    to.mass = std::max(to.mass, 0.5 * from.mass);
    way = packed_way(from, to);
    to = gone(from, way, 1);
    if (wider_than(to.covariance, 0.5 * kBoxVariance))
        cells.set(i, to);
    else
        way = {};
}

/// Gives a cell the moments of what it took.
/// sums  about the cell's mean
/// way   how far it was moved ahead; then how it came from where it was before that
void settle(PackedCells& cells, std::size_t i, const MomentSums& sums, EmHistory::Momentum& way) {
    const Moments ahead = cells[i];
    Moments to;
    if (sums.mass > 0) {
        to = moments_of(sums);
        to.mean = to.mean + ahead.mean;
        widen_to_voxel(to.covariance);
    }
    cells.set(i, to);
    way = packed_way(gone(ahead, way, -1), to);
}

/// For a brick out of everyone's reach: the cell whose mean is nearest.
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

EmSolver::EmSolver(std::span<const Brick> bricks) : bricks_(bricks) {
    while ((bricks.size() >> batch_log2_) >= kMostBatches) ++batch_log2_;
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

template <class Take>
void EmSolver::for_each_brick(const Moments& cell, const Take& take) const {
    const Vec3d reach = reach_of(cell), lower = cell.mean - reach, upper = cell.mean + reach;
    for (const Grid& grid : grids_) {
        // Bricks whose samples may lie in the box: samples are half a spacing inside the brick.
        const double per_edge = 1 / (grid.spacing * kLeafEdge);  // exact: a power of two
        const auto brick_at = [&](double index) {
            const double at = (index + 0.5) * per_edge;
            const auto toward_zero = static_cast<std::int32_t>(at);
            return toward_zero - (at < toward_zero);
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
                    take(place->brick);
            }
    }
}

EmSolver::Reached EmSolver::reached_by(const PackedCells& cells) const {
    Reached reached;
    reached.batches.resize(cells.size());
    std::vector<std::atomic<bool>> brick_is_reached(bricks_.size());
    std::vector<double> highest(chunks_of(cells.size()));
    vog::parallel_for(std::size_t{0}, highest.size(), [&](std::size_t chunk) {
        const std::size_t end = std::min((chunk + 1) * kChunk, cells.size());
        for (std::size_t i = chunk * kChunk; i < end; ++i) {
            const Moments cell = cells[i];
            highest[chunk] = std::max(highest[chunk], kernel_of(cell).peak);
            for_each_brick(cell, [&](std::uint32_t brick) {
                brick_is_reached[brick].store(true, std::memory_order_relaxed);
                reached.batches[i] |= batch_bit(brick);
            });
        }
    });
    for (const double peak : highest) reached.highest = std::max(reached.highest, peak);
    for (std::size_t b = 0; b < bricks_.size(); ++b) {
        if (brick_is_reached[b]) continue;
        const std::uint32_t cell = nearest_cell(brick_cell_center(bricks_[b], 0, 8), cells);
        reached.lonely.push_back({static_cast<std::uint32_t>(b), cell});
        reached.batches[cell] |= batch_bit(b);
    }
    reached.begins.resize(chunks_of(cells.size()));
    std::array<std::ptrdiff_t, kMostBatches + 1> change{};
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const std::uint64_t batches = reached.batches[i];
        if (batches == 0) continue;
        reached.begins[i / kChunk] |= batches & (~batches + 1);
        ++change[static_cast<std::size_t>(std::countr_zero(batches))];
        --change[static_cast<std::size_t>(std::bit_width(batches))];
    }
    std::ptrdiff_t open = 0, most_open = 0;
    for (const std::ptrdiff_t more : change) most_open = std::max(most_open, open += more);
    reached.most_open = static_cast<std::size_t>(most_open);
    return reached;
}

void EmSolver::open_cells(const Reached& reached, Batch& batch) const {
    const std::uint64_t bit = batch_bit(batch.first_brick);
    const auto on = static_cast<std::ptrdiff_t>(batch.open.size());
    for (std::size_t chunk = 0; chunk < reached.begins.size(); ++chunk) {
        if (!(reached.begins[chunk] & bit)) continue;
        const std::size_t end = std::min((chunk + 1) * kChunk, reached.batches.size());
        for (std::size_t i = chunk * kChunk; i < end; ++i) {
            if ((reached.batches[i] & (bit | (bit - 1))) != bit) continue;
            batch.open.push_back({static_cast<std::uint32_t>(i), batch.free.back()});
            batch.sums[batch.free.back()] = {};
            batch.free.pop_back();
        }
    }
    std::inplace_merge(batch.open.begin(), batch.open.begin() + on, batch.open.end(),
                       [](const Open& a, const Open& b) { return a.cell < b.cell; });
}

EmSolver::Lists EmSolver::lists_of(const PackedCells& cells, const Reached& reached,
                                   const Batch& batch) const {
    const std::uint64_t bit = batch_bit(batch.first_brick);
    std::vector<std::vector<Pair>> pairs(chunks_of(batch.open.size()) + 1);
    vog::parallel_for(std::size_t{0}, pairs.size() - 1, [&](std::size_t chunk) {
        const std::size_t end = std::min((chunk + 1) * kChunk, batch.open.size());
        for (std::size_t n = chunk * kChunk; n < end; ++n) {
            const std::uint32_t cell = batch.open[n].cell;
            if (!(reached.batches[cell] & bit)) continue;
            for_each_brick(cells[cell], [&](std::uint32_t brick) {
                if (batch_bit(brick) == bit)
                    pairs[chunk].push_back({brick, static_cast<std::uint32_t>(n)});
            });
        }
    });
    for (const Pair& pair : reached.lonely) {
        if (batch_bit(pair.brick) != bit) continue;
        const auto place = std::ranges::lower_bound(batch.open, pair.cell, {}, &Open::cell);
        pairs.back().push_back(
            {pair.brick, static_cast<std::uint32_t>(place - batch.open.begin())});
    }

    // In the order of cells: a counting sort.
    Lists lists;
    lists.first.resize(batch.end_brick - batch.first_brick + 1);
    for (const auto& chunk : pairs)
        for (const Pair& pair : chunk) ++lists.first[pair.brick - batch.first_brick + 1];
    std::partial_sum(lists.first.begin(), lists.first.end(), lists.first.begin());
    lists.places.resize(lists.first.back());
    std::vector<std::size_t> next(lists.first.begin(), lists.first.end() - 1);
    for (const auto& chunk : pairs)
        for (const Pair& pair : chunk)
            lists.places[next[pair.brick - batch.first_brick]++] = pair.cell;
    return lists;
}

void EmSolver::share(const PackedCells& cells, double highest, const Lists& lists,
                     Batch& batch) const {
    BigVector<MomentSums> parts(lists.places.size());
    vog::parallel_for(
        tbb::blocked_range<std::size_t>(batch.first_brick, batch.end_brick, 2),
        [&](const tbb::blocked_range<std::size_t>& range) {
            BrickScratch& scratch = batch.scratches.local();
            for (std::size_t b = range.begin(); b != range.end(); ++b) {
                const std::size_t n = b - batch.first_brick, first = lists.first[n],
                                  count = lists.first[n + 1] - first;
                scratch.kernels.clear();
                for (const std::uint32_t place : std::span(lists.places).subspan(first, count)) {
                    scratch.kernels.push_back(kernel_of(cells[batch.open[place].cell]));
                    scratch.kernels.back().peak /= highest;
                }
                share_brick(bricks_[b], scratch, std::span(parts).subspan(first, count));
            }
        });
    for (std::size_t n = 0; n < parts.size(); ++n)
        add_shifted(batch.sums[batch.open[lists.places[n]].sums], parts[n], {});
}

void EmSolver::settle_done(PackedCells& cells, const Reached& reached, Batch& batch,
                           EmHistory& steps) const {
    const std::uint64_t bit = batch_bit(batch.first_brick), later = ~(bit | (bit - 1));
    const auto is_done = [&](const Open& open) { return !(reached.batches[open.cell] & later); };
    vog::parallel_for(std::size_t{0}, batch.open.size(), [&](std::size_t n) {
        const auto [cell, sums] = batch.open[n];
        if (is_done(batch.open[n])) settle(cells, cell, batch.sums[sums], steps.momenta[cell]);
    });
    for (const Open& open : batch.open)
        if (is_done(open)) batch.free.push_back(open.sums);
    std::erase_if(batch.open, is_done);
}

void EmSolver::step(PackedCells& cells, EmHistory& steps) const {
    // Nesterov's momentum: from 0 at the start to 0.8. Whatever Gaussians the shares are taken by,
    // they add up to the whole, so that mass is conserved all the same.
    constexpr double kMostMomentum = 0.8;
    const double momentum = std::min(kMostMomentum, steps.taken / (steps.taken + 3.0));
    steps.momenta.resize(cells.size());
    if (steps.taken++ > 0)
        vog::parallel_for(std::size_t{0}, cells.size(),
                          [&](std::size_t i) { look_ahead(cells, i, steps.momenta[i], momentum); });

    const Reached reached = reached_by(cells);
    Batch batch;
    batch.open.reserve(reached.most_open);
    batch.sums.resize(reached.most_open);
    batch.free.resize(reached.most_open);
    std::iota(batch.free.begin(), batch.free.end(), std::uint32_t{0});
    for (; batch.first_brick < bricks_.size(); batch.first_brick = batch.end_brick) {
        batch.end_brick =
            std::min(batch.first_brick + (std::size_t{1} << batch_log2_), bricks_.size());
        open_cells(reached, batch);
        share(cells, reached.highest, lists_of(cells, reached, batch), batch);
        settle_done(cells, reached, batch, steps);
    }

    // A cell without mass, or that reaches no brick, took nothing.
    std::size_t kept = 0;
    cells.keep_if([&](std::size_t i) {
        const bool stays = reached.batches[i] != 0 && cells.mass(i) > 0;
        if (stays) steps.momenta[kept++] = steps.momenta[i];
        return stays;
    });
    steps.momenta.resize(kept);
}

void EmSolver::soften(PackedCells& cells, int steps) const {
    EmHistory taken;
    for (int n = 0; n < steps; ++n) step(cells, taken);
}

}  // namespace vog::moments
