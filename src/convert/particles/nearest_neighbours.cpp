// nearest_neighbours.cpp: k-nearest-neighbour search in an 8-ary tree of bounding boxes.
// Particles in Morton order are grouped by eights, groups again by eights. The eight particles of a
// group search together, beginning with the groups beside them in Morton order, which hold most
// neighbours.
#include "convert/particles/nearest_neighbours.h"

#include <tbb/blocked_range.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/paging.h"
#include "core/parallel.h"

// The inner loops are compiled for AVX2 as well and chosen at run time. Operations and their order
// are the same, so the bytes are.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__)
#define VOG_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define VOG_WIDE
#endif

namespace vog::particles {

namespace {

constexpr std::size_t kGroup = 8;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Coordinate of the padding of the last group: beyond all particles, with a finite square.
constexpr float kNowhere = 1e18f;

/// One coordinate of eight positions or eight box faces.
using Eight = std::array<float, kGroup>;
struct Group {
    std::array<Eight, 3> at;
};
struct Boxes {
    std::array<Eight, 3> lower, upper;
};

struct Bounds {
    std::array<float, 3> lower{kInfinity, kInfinity, kInfinity};
    std::array<float, 3> upper{-kInfinity, -kInfinity, -kInfinity};
};

Bounds bounds_of(const Group& group) {
    Bounds bounds;
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (const float at : group.at[axis]) {
            if (at == kNowhere) continue;
            bounds.lower[axis] = std::min(bounds.lower[axis], at);
            bounds.upper[axis] = std::max(bounds.upper[axis], at);
        }
    return bounds;
}
Bounds bounds_of(const Boxes& boxes) {
    Bounds bounds;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        bounds.lower[axis] = *std::ranges::min_element(boxes.lower[axis]);
        bounds.upper[axis] = *std::ranges::max_element(boxes.upper[axis]);
    }
    return bounds;
}

struct Tree {
    std::size_t count = 0;
    BigVector<Group> groups;
    std::vector<BigVector<Boxes>>
        levels;  ///< [0]: boxes of the groups, eight an entry; [1]: of those; ...
};

/// Bounding boxes of `things`, eight an entry.
template <class Thing>
BigVector<Boxes> boxes_of(const BigVector<Thing>& things) {
    BigVector<Boxes> boxes;
    resize_kept(boxes, (things.size() + kGroup - 1) / kGroup);
    vog::parallel_for(std::size_t{0}, boxes.size(), [&](std::size_t n) {
        for (std::size_t lane = 0; lane < kGroup; ++lane) {
            const std::size_t thing = n * kGroup + lane;
            const Bounds bounds = thing < things.size() ? bounds_of(things[thing]) : Bounds{};
            for (std::size_t axis = 0; axis < 3; ++axis) {
                boxes[n].lower[axis][lane] = bounds.lower[axis];
                boxes[n].upper[axis][lane] = bounds.upper[axis];
            }
        }
    });
    return boxes;
}

Tree tree_of(const BigVector<Vec3f>& places) {
    Tree tree;
    tree.count = places.size();
    resize_kept(tree.groups, (places.size() + kGroup - 1) / kGroup);
    for (std::size_t n = 0; n < tree.groups.size() * kGroup; ++n) {
        for (int axis = 0; axis < 3; ++axis)
            tree.groups[n / kGroup].at[static_cast<std::size_t>(axis)][n % kGroup] =
                n < places.size() ? places[n][axis] : kNowhere;
        keep_memory_at(n);
    }
    tree.levels.push_back(boxes_of(tree.groups));
    while (tree.levels.back().size() > 1) tree.levels.push_back(boxes_of(tree.levels.back()));
    return tree;
}

/// Squared distances between boxes; infinite for empty ones.
VOG_WIDE void box_distances2(const Boxes& boxes, const Bounds& to, Eight& distance2) {
    distance2.fill(0);
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (std::size_t lane = 0; lane < kGroup; ++lane) {
            const float below = to.lower[axis] - boxes.upper[axis][lane];
            const float above = boxes.lower[axis][lane] - to.upper[axis];
            const float gap = std::max(std::max(below, above), 0.0f);
            distance2[lane] += gap * gap;
        }
}

VOG_WIDE void place_distances2(const Group& group, const std::array<float, 3>& to,
                               Eight& distance2) {
    for (std::size_t lane = 0; lane < kGroup; ++lane) {
        const float x = group.at[0][lane] - to[0], y = group.at[1][lane] - to[1],
                    z = group.at[2][lane] - to[2];
        distance2[lane] = x * x + y * y + z * z;
    }
}

/// Nearest neighbours of the eight particles of one group.
class GroupSearch {
  public:
    GroupSearch(const Tree& tree, std::size_t group, int k)
        : tree_(tree),
          own_(group),
          k_(static_cast<std::size_t>(k)),
          bounds_(bounds_of(tree.groups[group])) {
        for (auto& nearest : nearest_) std::fill_n(nearest.begin(), k_, kInfinity);
        const std::size_t reach = k_ / kGroup + 1;
        first_ = group > reach ? group - reach : 0;
        last_ = std::min(group + reach + 1, tree.groups.size());
        for (std::size_t other = first_; other < last_; ++other) add_group(other);
        visit(tree.levels.size() - 1, 0);
    }
    float distance2(std::size_t lane) const { return nearest_[lane][k_ - 1]; }

  private:
    void add_group(std::size_t other) {
        const Group& own = tree_.groups[own_];
        const std::size_t lanes = std::min(kGroup, tree_.count - own_ * kGroup);
        const std::size_t others = std::min(kGroup, tree_.count - other * kGroup);
        Eight distance2;
        for (std::size_t lane = 0; lane < lanes; ++lane) {
            place_distances2(tree_.groups[other],
                             {own.at[0][lane], own.at[1][lane], own.at[2][lane]}, distance2);
            if (other == own_) distance2[lane] = kInfinity;
            auto& nearest = nearest_[lane];
            for (std::size_t n = 0; n < others; ++n) {
                if (!(distance2[n] < nearest[k_ - 1])) continue;
                std::size_t at = k_ - 1;
                for (; at > 0 && nearest[at - 1] > distance2[n]; --at)
                    nearest[at] = nearest[at - 1];
                nearest[at] = distance2[n];
            }
        }
        farthest2_ = 0;
        for (std::size_t lane = 0; lane < lanes; ++lane)
            farthest2_ = std::max(farthest2_, nearest_[lane][k_ - 1]);
    }
    void visit(std::size_t level, std::size_t entry) {
        Eight distance2;
        box_distances2(tree_.levels[level][entry], bounds_, distance2);
        for (std::size_t lane = 0; lane < kGroup; ++lane) {
            if (!(distance2[lane] < farthest2_)) continue;
            const std::size_t child = entry * kGroup + lane;
            if (level > 0)
                visit(level - 1, child);
            else if (child < first_ || child >= last_)
                add_group(child);
        }
    }

    const Tree& tree_;
    std::size_t own_, k_, first_ = 0, last_ = 0;
    Bounds bounds_;
    float farthest2_ = kInfinity;
    std::array<std::array<float, kMostNeighbours>, kGroup> nearest_;
};

}  // namespace

BigVector<float> neighbour_distances(const BigVector<Vec3f>& places, int k, int share, int shares) {
    const int others = static_cast<int>(std::min<std::size_t>(places.size() - 1, kMostNeighbours));
    BigVector<float> distances;
    resize_kept(distances, places.size());
    k = std::min(k, others);
    if (k < 1) return distances;
    const Tree tree = tree_of(places);
    constexpr std::size_t kGroupsPerTask = 64;
    const auto first_of = [&](int n) {
        return tree.groups.size() * static_cast<std::size_t>(n) / static_cast<std::size_t>(shares);
    };
    vog::parallel_for(
        tbb::blocked_range<std::size_t>(first_of(share), first_of(share + 1), kGroupsPerTask),
        [&](const auto& range) {
            for (std::size_t group = range.begin(); group < range.end(); ++group) {
                const GroupSearch search(tree, group, k);
                const std::size_t first = group * kGroup;
                for (std::size_t n = first; n < std::min(first + kGroup, places.size()); ++n)
                    distances[n] = std::sqrt(search.distance2(n - first));
            }
        });
    return distances;
}

}  // namespace vog::particles
