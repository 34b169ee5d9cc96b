// unit_range.cpp: clipping of a transfer function's points to V in [0, 1].
#include "shade/values/unit_range.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace vog::shading {

namespace {

template <std::size_t N>
struct Node {
    double v;
    std::array<double, N> y;
};
template <std::size_t N>
using Nodes = std::vector<Node<N>>;

/// The part in [0, 1] of a function that is linear between nodes and constant beyond them.
template <std::size_t N>
Nodes<N> clipped(const Nodes<N>& nodes) {
    Nodes<N> inside;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        for (const double end : {0.0, 1.0}) {
            if (i == 0 || !(nodes[i - 1].v < end && end < nodes[i].v)) continue;
            const Node<N>&a = nodes[i - 1], &b = nodes[i];
            Node<N> cut{end, a.y};
            for (std::size_t c = 0; c < N; ++c)
                cut.y[c] += (b.y[c] - a.y[c]) * ((end - a.v) / (b.v - a.v));
            inside.push_back(cut);
        }
        if (nodes[i].v >= 0 && nodes[i].v <= 1) inside.push_back(nodes[i]);
    }
    if (inside.empty() && !nodes.empty())  // all on one side: constant
        inside.push_back({0, nodes.front().v > 1 ? nodes.front().y : nodes.back().y});
    return inside;
}

}  // namespace

TransferFunction over_unit_range(const TransferPoints& read) {
    constexpr double kFar = 1e30;  // keeps differences finite
    const auto v_of = [&](double value) {
        if (!read.at_values) return value;
        return std::clamp((value - read.lower) / (read.upper - read.lower), -kFar, kFar);
    };
    Nodes<3> color;
    Nodes<1> opacity;
    for (const ValueColor& p : read.points.color)
        color.push_back({v_of(p.value), {double{p.r}, double{p.g}, double{p.b}}});
    for (const ValueOpacity& p : read.points.opacity)
        opacity.push_back({v_of(p.value), {p.opacity}});
    if (read.at_values) color = clipped(color), opacity = clipped(opacity);
    const auto number = [](double x) { return static_cast<float>(x); };
    TransferFunction tf;
    tf.name = read.points.name;
    for (const Node<3>& node : color)
        tf.color.push_back(
            {number(node.v), number(node.y[0]), number(node.y[1]), number(node.y[2])});
    for (const Node<1>& node : opacity) tf.opacity.push_back({number(node.v), number(node.y[0])});
    return tf;
}

}  // namespace vog::shading
