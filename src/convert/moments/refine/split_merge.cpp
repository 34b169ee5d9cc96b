// split_merge.cpp: halves of the worst in the place of one of each pair that is joined.
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
    constexpr double kLeast = 1e-30;  // rounding may leave a thin one none
    return std::log(std::max(determinant, kLeast));
}

/// BinarySplits of a Gaussian at its longest axis, as Gaussians: their means lie sqrt(2 / pi)
/// standard
/// deviations from its own, and they have its moments together.
std::array<Moments, 2> halves(const Moments& cell) {
    const auto& [xx, xy, xz, yy, yz, zz] = cell.covariance;
    const Eigen3 eigen =
        symmetric_eigen({{Vec3d{xx, xy, xz}, Vec3d{xy, yy, yz}, Vec3d{xz, yz, zz}}});
    int longest = 0;
    for (int axis = 1; axis < 3; ++axis)
        if (eigen.values[axis] > eigen.values[longest]) longest = axis;
    const Vec3d axis = eigen.axes.column(longest);
    const double apart2 = eigen.values[longest] * 2 / std::numbers::pi;
    const std::array<double, 6> square{axis.x * axis.x, axis.x * axis.y, axis.x * axis.z,
                                       axis.y * axis.y, axis.y * axis.z, axis.z * axis.z};
    std::array<Moments, 2> parts{cell, cell};
    for (Moments& part : parts) {
        part.mass *= 0.5;
        for (std::size_t n = 0; n < 6; ++n) part.covariance[n] -= apart2 * square[n];
    }
    parts[0].mean = cell.mean - std::sqrt(apart2) * axis;
    parts[1].mean = cell.mean + std::sqrt(apart2) * axis;
    return parts;
}

struct Pair {
    double cost = 0;
    Id a = 0, b = 0;

    bool operator<(const Pair& other) const {
        return std::tie(cost, a, b) < std::tie(other.cost, other.a, other.b);
    }
};

/// The cheapest partner of each cell among those that it shares a bucket of space with.
class Pairing {
  public:
    Pairing(const PackedCells& cells, const VisibilityWeight& seen) : cells_(cells), seen_(seen) {}

    std::vector<Pair> of(std::span<Id> ids) {
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
    /// BinarySplits of as many cells each, across the longest edge of the box around their means.
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
        struct Priced {
            Moments cell;
            double log_determinant, seen;
        };
        std::vector<Priced> of;
        for (const Id id : ids) {
            const Moments cell = cells_[id];
            of.push_back({cell, moments::log_determinant(cell), seen_(cell.mean)});
        }
        std::vector<Pair> pairs;
        for (std::size_t a = 0; a + 1 < ids.size(); ++a) {
            Pair best;
            for (std::size_t b = a + 1; b < ids.size(); ++b) {
                const std::array<Moments, 2> both{of[a].cell, of[b].cell};
                const Moments joined = joined_moments(both);
                const double divergence = 0.5 * (joined.mass * moments::log_determinant(joined) -
                                                 both[0].mass * of[a].log_determinant -
                                                 both[1].mass * of[b].log_determinant);
                const double cost =
                    divergence * 0.5 * (of[a].seen + of[b].seen) / std::sqrt(joined.mass);
                const Pair pair{cost, std::min(ids[a], ids[b]), std::max(ids[a], ids[b])};
                if (b == a + 1 || pair < best) best = pair;
            }
            pairs.push_back(best);
        }
        return pairs;
    }

    const PackedCells& cells_;
    const VisibilityWeight& seen_;
    std::vector<std::span<Id>> buckets_;
};

}  // namespace

void split_and_merge(PackedCells& cells, std::span<const float> error, double share,
                     const VisibilityWeight& seen) {
    std::vector<Id> ids(cells.size());
    std::iota(ids.begin(), ids.end(), Id{0});
    const auto wanted = static_cast<std::size_t>(share * static_cast<double>(ids.size()));
    const auto worst = std::span(ids).first(wanted), others = std::span(ids).subspan(wanted);
    std::partial_sort(
        ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(wanted), ids.end(),
        [&](Id a, Id b) { return error[a] != error[b] ? error[a] > error[b] : a < b; });
    std::vector<bool> joined(cells.size());
    std::size_t parted = 0;
    for (const Pair& pair : Pairing(cells, seen).of(others)) {
        if (parted == wanted) break;
        if (joined[pair.a] || joined[pair.b]) continue;
        joined[pair.a] = joined[pair.b] = true;
        const std::array<Moments, 2> both{cells[pair.a], cells[pair.b]};
        const std::array<Moments, 2> parts = halves(cells[worst[parted]]);
        cells.set(pair.a, joined_moments(both));
        cells.set(worst[parted++], parts[0]);
        cells.set(pair.b, parts[1]);
    }
}

}  // namespace vog::moments
