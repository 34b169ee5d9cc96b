// point_tree.cpp: halves top down, generation by generation; moments and groups of splits bottom
// up; priorities top down.
#include "convert/point_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "parallel.h"

namespace vog {

namespace {

/// A half of a node: a node itself, or one particle.
struct Half {
    std::uint32_t first, last, node;
    bool is_node() const { return last - first > 1; }
};
std::array<Half, 2> halves(const PointNode& node) {
    const std::uint32_t left_is_node = node.middle - node.first > 1;
    return {Half{node.first, node.middle, node.first_child},
            Half{node.middle, node.last, node.first_child + left_is_node}};
}

/// Direction of the largest eigenvalue, by squaring: the 32nd power of the matrix has it in every
/// column. Not exact where two are close, which does not matter then.
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

/// Parts the particles of a node at their mean, across their longest axis.
void part(std::vector<Particle>& particles, PointNode& node) {
    const auto begin = particles.begin() + node.first, end = particles.begin() + node.last;
    node.middle = node.first + 1;
    if (node.last - node.first == 2) return;
    double mass = 0;
    Vec3d mean;
    for (auto particle = begin; particle != end; ++particle) {
        mass += particle->mass;
        mean = mean + double{particle->mass} * particle->place;
    }
    mean = (1 / mass) * mean;
    std::array<double, 6> c{};
    for (auto particle = begin; particle != end; ++particle) {
        const Vec3d d = particle->place - mean;
        const double m = particle->mass;
        c[0] += m * d.x * d.x, c[1] += m * d.x * d.y, c[2] += m * d.x * d.z;
        c[3] += m * d.y * d.y, c[4] += m * d.y * d.z, c[5] += m * d.z * d.z;
    }
    const Vec3d axis =
        longest_axis({{Vec3d{c[0], c[1], c[2]}, {c[1], c[3], c[4]}, {c[2], c[4], c[5]}}});
    const auto middle = std::partition(
        begin, end, [&](const Particle& p) { return dot(p.place - mean, axis) < 0; });
    // Particles in one place are parted by number.
    node.middle = middle == begin || middle == end
                      ? node.first + (node.last - node.first) / 2
                      : static_cast<std::uint32_t>(middle - particles.begin());
}

/// Nodes of all generations; returns where each begins, and the end.
std::vector<std::size_t> build_nodes(PointTree& tree) {
    std::vector<std::size_t> generations{0};
    if (tree.particles.size() < 2) return generations;
    tree.nodes.reserve(tree.particles.size() - 1);
    PointNode root;
    root.last = static_cast<std::uint32_t>(tree.particles.size());
    tree.nodes.push_back(root);
    while (generations.back() < tree.nodes.size()) {
        const std::size_t begin = generations.back(), end = tree.nodes.size();
        vog::parallel_for(begin, end, [&](std::size_t n) { part(tree.particles, tree.nodes[n]); });
        for (std::size_t n = begin; n < end; ++n) {
            tree.nodes[n].first_child = static_cast<std::uint32_t>(tree.nodes.size());
            for (const Half& half : halves(tree.nodes[n]))
                if (half.is_node()) {
                    PointNode node;
                    node.first = half.first;
                    node.last = half.last;
                    tree.nodes.push_back(node);
                }
        }
        generations.push_back(end);
    }
    return generations;
}

Moments node_moments(const PointTree& tree, const PointNode& node) {
    Moments moments;
    moments.mass = node.mass;
    moments.mean = tree.particles[node.first].place + vec_cast<double>(node.mean);
    std::ranges::copy(node.covariance, moments.covariance.begin());
    return moments;
}

Moments half_moments(const PointTree& tree, const Half& half) {
    return half.is_node() ? node_moments(tree, tree.nodes[half.node])
                          : particle_moments(tree.particles[half.first]);
}

/// The worth of splitting a node and, where those are worth more, some of its descendants with it.
struct SplitGroup {
    float gain = 0;
    std::uint32_t splits = 0;
    bool absorbed = false;  ///< into an ancestor's
    float priority() const { return gain / static_cast<float>(splits); }
};

/// Adds the nodes below `node` that are heads of groups to a heap.
void push_heads(const PointTree& tree, const std::vector<SplitGroup>& groups, const PointNode& node,
                std::vector<std::pair<float, std::uint32_t>>& heap) {
    for (const Half& half : halves(node)) {
        if (!half.is_node()) continue;
        if (groups[half.node].absorbed) {
            push_heads(tree, groups, tree.nodes[half.node], heap);
            continue;
        }
        heap.emplace_back(groups[half.node].priority(), half.node);
        std::push_heap(heap.begin(), heap.end());
    }
}

/// Sets a node's moments and its group from its halves'. A split of little worth must not hide
/// those of more below it: such are absorbed, best first, while they raise the worth of a split.
void set_moments(PointTree& tree, std::vector<SplitGroup>& groups, std::size_t n) {
    PointNode& node = tree.nodes[n];
    const auto [left, right] = halves(node);
    const std::array<Moments, 2> parts{half_moments(tree, left), half_moments(tree, right)};
    const Moments sum = joined_moments(parts);
    node.mass = static_cast<float>(sum.mass);
    node.mean = vec_cast<float>(sum.mean - tree.particles[node.first].place);
    for (std::size_t k = 0; k < 6; ++k) node.covariance[k] = static_cast<float>(sum.covariance[k]);

    // The edge of a cell: that of a cube with this variance, but for a constant.
    const double edge = 2 * std::sqrt(sum.covariance[0] + sum.covariance[3] + sum.covariance[5]);
    SplitGroup& group = groups[n];
    group = {split_gain(sum, parts, edge), 1, false};
    std::vector<std::pair<float, std::uint32_t>> heap;
    push_heads(tree, groups, node, heap);
    while (!heap.empty() && heap.front().first > group.priority()) {
        const std::uint32_t best = heap.front().second;
        std::pop_heap(heap.begin(), heap.end());
        heap.pop_back();
        group.gain += groups[best].gain;
        group.splits += groups[best].splits;
        groups[best].absorbed = true;
        push_heads(tree, groups, tree.nodes[best], heap);
    }
}

/// Walks down depth first and takes what is not split.
struct PointCutWalk {
    const PointTree& tree;
    float least;  ///< nodes of this priority or more are split
    std::vector<Moments> cut{};

    void take(const PointNode& node) {
        if (node.priority < least) {
            cut.push_back(node_moments(tree, node));
            return;
        }
        for (const Half& half : halves(node))
            if (half.is_node())
                take(tree.nodes[half.node]);
            else
                cut.push_back(half_moments(tree, half));
    }
};

}  // namespace

Moments particle_moments(const Particle& particle) {
    Moments moments{particle.mass, particle.place, {}};
    std::ranges::copy(particle.covariance, moments.covariance.begin());
    return moments;
}

Moments joined_moments(std::span<const Moments> parts) {
    Moments sum;
    for (const Moments& part : parts) {
        sum.mass += part.mass;
        sum.mean = sum.mean + part.mass * part.mean;
    }
    sum.mean = (1 / sum.mass) * sum.mean;
    // About the mean from the start: no squares of places to cancel.
    for (const Moments& part : parts) {
        const Vec3d d = part.mean - sum.mean;
        const std::array<double, 6> squares{d.x * d.x, d.x * d.y, d.x * d.z,
                                            d.y * d.y, d.y * d.z, d.z * d.z};
        for (std::size_t n = 0; n < 6; ++n)
            sum.covariance[n] += part.mass / sum.mass * (part.covariance[n] + squares[n]);
    }
    return sum;
}

PointTree point_tree(std::vector<Particle> particles) {
    PointTree tree;
    tree.particles = std::move(particles);
    const std::vector<std::size_t> generations = build_nodes(tree);
    std::vector<SplitGroup> groups(tree.nodes.size());
    for (std::size_t g = generations.size() - 1; g-- > 0;)
        vog::parallel_for(generations[g], generations[g + 1],
                          [&](std::size_t n) { set_moments(tree, groups, n); });

    if (!tree.nodes.empty()) tree.nodes.front().priority = std::numeric_limits<float>::infinity();
    tree.splits.resize(tree.nodes.size());
    for (std::size_t n = 0; n < tree.nodes.size(); ++n) {
        PointNode& node = tree.nodes[n];  // which has its parent's priority
        if (!groups[n].absorbed) node.priority = std::min(node.priority, groups[n].priority());
        for (const Half& half : halves(node))
            if (half.is_node()) tree.nodes[half.node].priority = node.priority;
        tree.splits[n] = {node.priority, 1};
    }
    sort_splits(tree.splits);
    return tree;
}

std::vector<Moments> best_cut(const PointTree& tree, std::size_t budget) {
    if (tree.nodes.empty()) return {particle_moments(tree.particles.front())};
    PointCutWalk walk{tree, least_priority(tree.splits, budget)};
    walk.take(tree.nodes.front());
    return std::move(walk.cut);
}

}  // namespace vog
