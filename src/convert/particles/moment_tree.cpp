// moment_tree.cpp: nodes top down, one generation at a time; moments, gains and the optimal pruning
// bottom up.
#include "convert/particles/moment_tree.h"

#include <algorithm>
#include <cmath>

#include "convert/moments/cut/lagrange_search.h"
#include "convert/moments/cut/split_gain.h"
#include "core/paging.h"
#include "core/parallel.h"

namespace vog::particles {

using namespace moments;

namespace {

/// One side of a node's split: a node, or a single particle.
struct Side {
    std::uint32_t first, last, node;
    bool is_node() const { return last - first > 1; }
};
std::array<Side, 2> sides(const PointNode& node) {
    const std::uint32_t left_is_node = node.middle - node.first > 1;
    return {Side{node.first, node.middle, node.first_child},
            Side{node.middle, node.last, node.first_child + left_is_node}};
}

/// Eigenvector of the largest eigenvalue, not normalised: a column of the 32nd power of the matrix.
/// Not exact if two eigenvalues are close, but then either axis serves.
Vec3d longest_axis(Mat3 matrix) {
    constexpr int kSquarings = 5;
    for (int n = 0; n < kSquarings; ++n) {
        const double trace = matrix(0, 0) + matrix(1, 1) + matrix(2, 2);
        if (!(trace > 0)) return {1, 0, 0};
        for (Vec3d& row : matrix.row) row = (1 / trace) * row;
        matrix = matrix * matrix;
    }
    int axis = 0;
    for (const int other : {1, 2})
        if (matrix(other, other) > matrix(axis, axis)) axis = other;
    return matrix.column(axis);
}

/// Sorts the particles of a node by the side of their mean, across the axis of largest variance.
void split_at_mean(BigVector<Particle>& particles, PointNode& node) {
    const auto begin = particles.begin() + node.first, end = particles.begin() + node.last;
    node.middle = node.first + 1;
    if (node.last - node.first == 2) return;
    double mass = 0;
    Vec3d mean;
    std::size_t visited = 0;
    for (auto particle = begin; particle != end; ++particle) {
        mass += particle->mass;
        mean = mean + double{particle->mass} * particle->place;
        keep_memory_at(++visited);
    }
    mean = (1 / mass) * mean;
    std::array<double, 6> c{};
    for (auto particle = begin; particle != end; ++particle) {
        const Vec3d d = particle->place - mean;
        const double m = particle->mass;
        c[0] += m * d.x * d.x, c[1] += m * d.x * d.y, c[2] += m * d.x * d.z;
        c[3] += m * d.y * d.y, c[4] += m * d.y * d.z, c[5] += m * d.z * d.z;
        keep_memory_at(++visited);
    }
    const Vec3d axis =
        longest_axis({{Vec3d{c[0], c[1], c[2]}, {c[1], c[3], c[4]}, {c[2], c[4], c[5]}}});
    const auto middle = std::partition(begin, end, [&](const Particle& p) {
        keep_memory_at(++visited);
        return dot(p.place - mean, axis) < 0;
    });
    // Coincident particles: two halves by count.
    node.middle = middle == begin || middle == end
                      ? node.first + (node.last - node.first) / 2
                      : static_cast<std::uint32_t>(middle - particles.begin());
}

int longest_edge(const PointBox& box) {
    const Vec3f edge = box.upper - box.lower;
    return edge.x >= edge.y && edge.x >= edge.z ? 0 : edge.y >= edge.z ? 1 : 2;
}
/// Halves of a box, across its longest edge.
std::array<PointBox, 2> halves(const PointBox& box) {
    const int axis = longest_edge(box);
    std::array<PointBox, 2> both{box, box};
    both[0].upper[axis] = both[1].lower[axis] = 0.5f * (box.lower[axis] + box.upper[axis]);
    return both;
}

/// Sorts the particles of a node by the half of its box, which is halved until both sides have some.
/// box  out: the one whose halves are the children's
void split_at_middle(BigVector<Particle>& particles, PointNode& node, PointBox& box) {
    const auto begin = particles.begin() + node.first, end = particles.begin() + node.last;
    constexpr int kMostHalvings = 90;  // 2^-30 of each edge, beyond the digits of floats
    for (int n = 0; n < kMostHalvings; ++n) {
        const int axis = longest_edge(box);
        const std::array<PointBox, 2> half = halves(box);
        const double at = half[0].upper[axis];
        const auto middle = std::partition(
            begin, end, [&](const Particle& particle) { return particle.place[axis] < at; });
        keep_memory();
        node.middle = static_cast<std::uint32_t>(middle - particles.begin());
        if (middle != begin && middle != end) return;
        box = half[middle == begin ? 1 : 0];
    }
    node.middle = node.first + (node.last - node.first) / 2;
}

/// Box of all particles, with the extent of each.
PointBox box_of(const BigVector<Particle>& particles) {
    PointBox box{vec_cast<float>(particles.front().place),
                 vec_cast<float>(particles.front().place)};
    for (const Particle& particle : particles)
        for (const int axis : {0, 1, 2}) {
            const auto at = static_cast<float>(particle.place[axis]);
            const float half =
                std::sqrt(3 * particle.covariance[std::array{0u, 3u, 5u}[std::size_t(axis)]]);
            box.lower[axis] = std::min(box.lower[axis], at - half);
            box.upper[axis] = std::max(box.upper[axis], at + half);
        }
    return box;
}

/// Builds the nodes, generation by generation.
void build_nodes(PointTree& tree, Division division) {
    std::vector<std::size_t>& generations = tree.generations;
    if (tree.particles.size() < 2) return;
    tree.nodes.reserve(tree.particles.size() - 1);
    PointNode root;
    root.last = static_cast<std::uint32_t>(tree.particles.size());
    tree.nodes.push_back(root);
    const bool at_middle = division == Division::at_middle;
    if (at_middle) tree.boxes.push_back(box_of(tree.particles));
    while (generations.back() < tree.nodes.size()) {
        const std::size_t begin = generations.back(), end = tree.nodes.size();
        BigVector<PointBox> split(tree.boxes.begin() + (at_middle ? std::ptrdiff_t(begin) : 0),
                                  tree.boxes.end());
        vog::parallel_for(begin, end, [&](std::size_t n) {
            if (at_middle)
                split_at_middle(tree.particles, tree.nodes[n], split[n - begin]);
            else
                split_at_mean(tree.particles, tree.nodes[n]);
        });
        for (std::size_t n = begin; n < end; ++n) {
            keep_memory_at(n);
            tree.nodes[n].first_child = static_cast<std::uint32_t>(tree.nodes.size());
            const std::array<Side, 2> both = sides(tree.nodes[n]);
            for (const std::size_t k : {0, 1}) {
                if (!both[k].is_node()) continue;
                PointNode node;
                node.first = both[k].first;
                node.last = both[k].last;
                tree.nodes.push_back(node);
                if (at_middle) tree.boxes.push_back(halves(split[n - begin])[k]);
            }
        }
        generations.push_back(end);
    }
}

Moments node_moments(const PointTree& tree, const PointNode& node) {
    Moments moments;
    moments.mass = node.mass;
    moments.mean = tree.particles[node.first].place + vec_cast<double>(node.mean);
    std::ranges::copy(node.covariance, moments.covariance.begin());
    return moments;
}

Moments side_moments(const PointTree& tree, const Side& side) {
    return side.is_node() ? node_moments(tree, tree.nodes[side.node])
                          : particle_moments(tree.particles[side.first]);
}

/// Moments of a cell of a cut: of a node with a box those of a window over it, with the standard deviation of overlapping cells of voxels
/// (moments/cells/overlapping_cells.h).
Moments cell_moments(const PointTree& tree, const Side& side) {
    Moments moments = side_moments(tree, side);
    if (tree.boxes.empty()) return moments;
    if (!side.is_node()) {
        // Variances at which particles overlap as windows do: T of tetrahedra, one Gaussian each, is 0.0045 off after a step; 0.021 with 2,
        // and 0.067 without.
        constexpr double kWider = 3;
        for (double& c : moments.covariance) c *= kWider;
        return moments;
    }
    constexpr double kDeviation = 0.453;  // edges
    const PointBox& box = tree.boxes[side.node];
    const Vec3d lower = vec_cast<double>(box.lower), edge = vec_cast<double>(box.upper) - lower;
    const auto variance = [&](double of) { return kDeviation * kDeviation * of * of; };
    moments.mean = lower + 0.5 * edge;
    moments.covariance = {variance(edge.x), 0, 0, variance(edge.y), 0, variance(edge.z)};
    return moments;
}

/// Sets a node's moments and split gain from its sides'.
void set_moments(PointTree& tree, PointNode& node) {
    const auto [left, right] = sides(node);
    const std::array<Moments, 2> parts{side_moments(tree, left), side_moments(tree, right)};
    const Moments sum = joined_moments(parts);
    node.mass = static_cast<float>(sum.mass);
    node.mean = vec_cast<float>(sum.mean - tree.particles[node.first].place);
    for (std::size_t k = 0; k < 6; ++k) node.covariance[k] = static_cast<float>(sum.covariance[k]);
    node.gain = static_cast<float>(split_gain(sum, parts[0], parts[1], DepthPower::three_quarters));
}

/// Optimal pruning under the multiplier lambda (lagrange_search.h): net gain of each node, 0 if
/// unsplit.
class PrunedPoints {
  public:
    PrunedPoints(const PointTree& tree, double lambda) : tree_(tree) {
        resize_kept(best_, tree.nodes.size());
        for (std::size_t g = tree.generations.size() - 1; g-- > 0;)
            vog::parallel_for(tree.generations[g], tree.generations[g + 1], [&](std::size_t n) {
                Best best{double{tree.nodes[n].gain} - lambda, 0};
                for (const Side& side : sides(tree.nodes[n])) {
                    best.net_gain += side.is_node() ? best_[side.node].net_gain : 0;
                    best.count += side.is_node() ? best_[side.node].count : 1;
                }
                best_[n] = best.net_gain > 0 ? best : Best{0, 1};
            });
    }
    std::size_t count() const { return best_.front().count; }
    BigVector<Moments> cells(BigVector<std::uint32_t>* ends) const {
        BigVector<Moments> cut;
        cut.reserve(count());
        add_cells({tree_.nodes[0].first, tree_.nodes[0].last, 0}, cut, ends);
        return cut;
    }

  private:
    struct Best {
        double net_gain = 0;
        std::uint32_t count = 0;
    };
    void add_cells(const Side& whole, BigVector<Moments>& cut,
                   BigVector<std::uint32_t>* ends) const {
        keep_memory();
        if (whole.is_node() && best_[whole.node].net_gain > 0) {
            for (const Side& side : sides(tree_.nodes[whole.node])) add_cells(side, cut, ends);
            return;
        }
        cut.push_back(cell_moments(tree_, whole));
        if (ends) ends->push_back(whole.last);
    }

    const PointTree& tree_;
    BigVector<Best> best_;
};

}  // namespace

Moments particle_moments(const Particle& particle) {
    Moments moments{particle.mass, particle.place, {}};
    std::ranges::copy(particle.covariance, moments.covariance.begin());
    return moments;
}

PointTree point_tree(BigVector<Particle> particles, Division division) {
    PointTree tree;
    tree.particles = std::move(particles);
    build_nodes(tree, division);
    for (std::size_t g = tree.generations.size() - 1; g-- > 0;)
        vog::parallel_for(tree.generations[g], tree.generations[g + 1],
                          [&](std::size_t n) { set_moments(tree, tree.nodes[n]); });
    return tree;
}

BigVector<Moments> best_cut(const PointTree& tree, std::size_t budget,
                            BigVector<std::uint32_t>* ends) {
    if (ends) ends->clear();
    if (tree.nodes.empty()) {
        if (ends) ends->push_back(1);
        return {particle_moments(tree.particles.front())};
    }
    float most = 0;
    for (std::size_t n = 0; n < tree.nodes.size(); ++n) {
        most = std::max(most, tree.nodes[n].gain);
        keep_memory_at(n);
    }
    const double lambda = lambda_of_budget(
        budget, double{most}, [&](double tried) { return PrunedPoints(tree, tried).count(); });
    return PrunedPoints(tree, lambda).cells(ends);
}

}  // namespace vog::particles
