// split_merge.h: split-and-merge of mixture components at a constant count.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <span>
#include <tuple>
#include <vector>

#include "convert/moments/cells/packed_cells.h"
#include "convert/moments/cut/visibility.h"
#include "core/parallel.h"

namespace vog::moments {

/// Log of the determinant of a covariance, xx xy xz yy yz zz.
double log_determinant(const std::array<double, 6>& covariance);
/// Variance between the means of the halves of a normal distribution, share of the whole: 2 / pi.
inline constexpr double kHalvesVariance = 2 / std::numbers::pi;
/// Two Gaussians on either side of a cell's mean, which together have its moments.
/// shift  from its mean to theirs; shift shift^T must leave a covariance
std::array<Moments, 2> split_in_two(const Moments& cell, Vec3d shift);
/// Two Gaussians with the moments of the halves of `cell` on either side of its mean, across its
/// longest axis: means at +-sqrt(2 / pi) standard deviations. Together they have the moments of
/// `cell`.
std::array<Moments, 2> split_in_two(const Moments& cell);

/// Two cells and the loss by merging them.
struct CellPair {
    double cost = 0;
    std::uint32_t a = 0, b = 0;

    bool operator<(const CellPair& other) const {
        return std::tie(cost, a, b) < std::tie(other.cost, other.a, other.b);
    }
};

/// Divides cells into buckets of up to 16 near each other: median splits across the longest edge of the box around
/// their means.
/// ids      reordered
/// mean_of  mean of a cell
template <class MeanOf>
void divide_cells(std::span<std::uint32_t> ids, const MeanOf& mean_of,
                  std::vector<std::span<const std::uint32_t>>& buckets) {
    constexpr std::size_t kBucket = 16;
    if (ids.size() <= kBucket) return buckets.push_back(ids);
    Box box;
    for (const std::uint32_t id : ids) box.include(mean_of(id));
    const Vec3d edge = box.upper - box.lower;
    int axis = 0;
    for (int other = 1; other < 3; ++other)
        if (edge[other] > edge[axis]) axis = other;
    const std::size_t middle = ids.size() / 2;
    std::nth_element(ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(middle), ids.end(),
                     [&](std::uint32_t a, std::uint32_t b) {
                         const double at_a = mean_of(a)[axis], at_b = mean_of(b)[axis];
                         return std::tie(at_a, a) < std::tie(at_b, b);
                     });
    divide_cells(ids.first(middle), mean_of, buckets);
    divide_cells(ids.subspan(middle), mean_of, buckets);
}

/// For each cell the cheapest partner within its bucket, cheapest pairs first.
/// rules  mean(cell); candidate(cell), all that the cost needs to know of it; cost(a, b) of two candidates
template <class Cells, class Rules>
std::vector<CellPair> cheapest_pairs(const Cells& cells, std::span<std::uint32_t> ids,
                                     const Rules& rules) {
    std::vector<std::span<const std::uint32_t>> buckets;
    divide_cells(
        ids, [&](std::uint32_t id) { return rules.mean(cells[id]); }, buckets);
    std::vector<std::vector<CellPair>> found(buckets.size());
    vog::parallel_for(std::size_t{0}, buckets.size(), [&](std::size_t n) {
        const auto bucket = buckets[n];
        std::vector<decltype(rules.candidate(cells[0]))> candidates;
        for (const std::uint32_t id : bucket) candidates.push_back(rules.candidate(cells[id]));
        for (std::size_t a = 0; a + 1 < bucket.size(); ++a) {
            CellPair best;
            for (std::size_t b = a + 1; b < bucket.size(); ++b) {
                const CellPair pair{rules.cost(candidates[a], candidates[b]),
                                    std::min(bucket[a], bucket[b]), std::max(bucket[a], bucket[b])};
                if (b == a + 1 || pair < best) best = pair;
            }
            found[n].push_back(best);
        }
    });
    std::vector<CellPair> pairs;
    for (const std::vector<CellPair>& bucket : found)
        pairs.insert(pairs.end(), bucket.begin(), bucket.end());
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

/// Splits the cells with the largest error in two and merges as many pairs of the others, those of least cost. The count
/// stays.
/// cells  size(), cells[i], set(i, cell)
/// error  of each cell, any unit
/// share  of the cells to split, [0, 1/3]
/// rules  as above; split(cell) and joined(a, b) keep the moments of the whole
template <class Cells, class Rules>
void split_and_merge(Cells& cells, std::span<const float> error, double share, const Rules& rules) {
    std::vector<std::uint32_t> ids(cells.size());
    std::iota(ids.begin(), ids.end(), 0u);
    const auto split_count = static_cast<std::size_t>(share * static_cast<double>(ids.size()));
    const auto worst = std::span(ids).first(split_count),
               others = std::span(ids).subspan(split_count);
    std::partial_sort(ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(split_count),
                      ids.end(), [&](std::uint32_t a, std::uint32_t b) {
                          return error[a] != error[b] ? error[a] > error[b] : a < b;
                      });
    std::vector<bool> joined(cells.size());
    std::size_t splits_made = 0;
    for (const CellPair& pair : cheapest_pairs(cells, others, rules)) {
        if (splits_made == split_count) break;
        if (joined[pair.a] || joined[pair.b]) continue;
        joined[pair.a] = joined[pair.b] = true;
        const auto both = rules.joined(cells[pair.a], cells[pair.b]);
        const auto parts = rules.split(cells[worst[splits_made]]);
        cells.set(pair.a, both);
        cells.set(worst[splits_made++], parts[0]);
        cells.set(pair.b, parts[1]);
    }
}

/// The same of cells of density alone. Pairs have the least upper bound on the Kullback-Leibler divergence by merging
/// (A. Runnalls, "Kullback-Leibler approach to Gaussian mixture reduction", 2007), weighted by visibility /
/// sqrt(mass).
void split_and_merge(PackedCells& cells, std::span<const float> error, double share,
                     const VisibilityWeight& visibility);

}  // namespace vog::moments
