// split_merge.cpp: the worst cells split in two, in the storage of one of each pair that is merged.
#include "convert/moments/refine/split_merge.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <tuple>
#include <vector>

#include "core/parallel.h"

namespace vog::moments {

namespace {

using Id = std::uint32_t;

double log_determinant(const Moments& cell) {
    const auto& [xx, xy, xz, yy, yz, zz] = cell.covariance;
    const double determinant =
        xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
    constexpr double kLeast = 1e-30;  // rounding may make that of a thin cell 0
    return std::log(std::max(determinant, kLeast));
}

/// Two Gaussians with the moments of the halves of `cell` on either side of its mean, across its
/// longest axis: means at +-sqrt(2 / pi) standard deviations. Together they have the moments of
/// `cell`.
std::array<Moments, 2> split_in_two(const Moments& cell) {
    const auto& [xx, xy, xz, yy, yz, zz] = cell.covariance;
    const Eigen3 eigen =
        symmetric_eigen({{Vec3d{xx, xy, xz}, Vec3d{xy, yy, yz}, Vec3d{xz, yz, zz}}});
    int longest = 0;
    for (int axis = 1; axis < 3; ++axis)
        if (eigen.values[axis] > eigen.values[longest]) longest = axis;
    const Vec3d axis = eigen.axes.column(longest);
    const double offset2 = eigen.values[longest] * 2 / std::numbers::pi;
    const std::array<double, 6> square{axis.x * axis.x, axis.x * axis.y, axis.x * axis.z,
                                       axis.y * axis.y, axis.y * axis.z, axis.z * axis.z};
    std::array<Moments, 2> parts{cell, cell};
    for (Moments& part : parts) {
        part.mass *= 0.5;
        for (std::size_t n = 0; n < 6; ++n) part.covariance[n] -= offset2 * square[n];
    }
    parts[0].mean = cell.mean - std::sqrt(offset2) * axis;
    parts[1].mean = cell.mean + std::sqrt(offset2) * axis;
    return parts;
}

/// Two cells and the loss by merging them.
struct Pair {
    double cost = 0;
    Id a = 0, b = 0;

    bool operator<(const Pair& other) const {
        return std::tie(cost, a, b) < std::tie(other.cost, other.a, other.b);
    }
};

/// Pairs of nearby cells that are cheap to merge.
class PairSearch {
  public:
    PairSearch(const PackedCells& cells, const VisibilityWeight& visibility)
        : cells_(cells), visibility_(visibility) {}

    /// For each cell the cheapest partner within its bucket of up to 16 cells, cheapest pairs
    /// first.
    /// ids  reordered
    std::vector<Pair> cheapest_pairs(std::span<Id> ids) {
        buckets_.clear();
        divide(ids);
        std::vector<std::vector<Pair>> found(buckets_.size());
        vog::parallel_for(std::size_t{0}, buckets_.size(),
                          [&](std::size_t n) { found[n] = cheapest(buckets_[n]); });
        std::vector<Pair> pairs;
        for (const std::vector<Pair>& bucket : found)
            pairs.insert(pairs.end(), bucket.begin(), bucket.end());
        std::sort(pairs.begin(), pairs.end());
        return pairs;
    }

  private:
    /// Median splits across the longest edge of the box around the means.
    void divide(std::span<Id> ids) {
        constexpr std::size_t kBucket = 16;
        if (ids.size() <= kBucket) return buckets_.push_back(ids);
        Box box;
        for (const Id id : ids) box.include(cells_[id].mean);
        const Vec3d edge = box.upper - box.lower;
        int axis = 0;
        for (int other = 1; other < 3; ++other)
            if (edge[other] > edge[axis]) axis = other;
        const std::size_t middle = ids.size() / 2;
        std::nth_element(ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(middle), ids.end(),
                         [&](Id a, Id b) {
                             const double at_a = cells_[a].mean[axis], at_b = cells_[b].mean[axis];
                             return std::tie(at_a, a) < std::tie(at_b, b);
                         });
        divide(ids.first(middle));
        divide(ids.subspan(middle));
    }

    std::vector<Pair> cheapest(std::span<const Id> ids) const {
        struct Candidate {
            Moments cell;
            double log_determinant, visibility;
        };
        std::vector<Candidate> candidates;
        for (const Id id : ids) {
            const Moments cell = cells_[id];
            candidates.push_back({cell, moments::log_determinant(cell), visibility_(cell.mean)});
        }
        std::vector<Pair> pairs;
        for (std::size_t a = 0; a + 1 < ids.size(); ++a) {
            Pair best;
            for (std::size_t b = a + 1; b < ids.size(); ++b) {
                const std::array<Moments, 2> both{candidates[a].cell, candidates[b].cell};
                const Moments joined = joined_moments(both);
                const double divergence = 0.5 * (joined.mass * moments::log_determinant(joined) -
                                                 both[0].mass * candidates[a].log_determinant -
                                                 both[1].mass * candidates[b].log_determinant);
                const double cost = divergence * 0.5 *
                                    (candidates[a].visibility + candidates[b].visibility) /
                                    std::sqrt(joined.mass);
                const Pair pair{cost, std::min(ids[a], ids[b]), std::max(ids[a], ids[b])};
                if (b == a + 1 || pair < best) best = pair;
            }
            pairs.push_back(best);
        }
        return pairs;
    }

    const PackedCells& cells_;
    const VisibilityWeight& visibility_;
    std::vector<std::span<Id>> buckets_;
};

}  // namespace

void split_and_merge(PackedCells& cells, std::span<const float> error, double share,
                     const VisibilityWeight& visibility) {
    std::vector<Id> ids(cells.size());
    std::iota(ids.begin(), ids.end(), Id{0});
    const auto split_count = static_cast<std::size_t>(share * static_cast<double>(ids.size()));
    const auto worst = std::span(ids).first(split_count),
               others = std::span(ids).subspan(split_count);
    std::partial_sort(
        ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(split_count), ids.end(),
        [&](Id a, Id b) { return error[a] != error[b] ? error[a] > error[b] : a < b; });
    std::vector<bool> joined(cells.size());
    std::size_t splits_made = 0;
    for (const Pair& pair : PairSearch(cells, visibility).cheapest_pairs(others)) {
        if (splits_made == split_count) break;
        if (joined[pair.a] || joined[pair.b]) continue;
        joined[pair.a] = joined[pair.b] = true;
        const std::array<Moments, 2> both{cells[pair.a], cells[pair.b]};
        const std::array<Moments, 2> parts = split_in_two(cells[worst[splits_made]]);
        cells.set(pair.a, joined_moments(both));
        cells.set(worst[splits_made++], parts[0]);
        cells.set(pair.b, parts[1]);
    }
}

}  // namespace vog::moments
