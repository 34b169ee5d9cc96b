// chunk_tree.cpp: chunks from the root down. Nodes and leaves below a run of nodes are runs of the next level.
#include "io/site/tree/chunk_tree.h"

#include <algorithm>

namespace vog::site {

namespace {

std::size_t total(const std::vector<Run>& runs) {
    std::size_t sum = 0;
    for (const Run& run : runs) sum += run.size();
    return sum;
}

/// Nodes below a run of nodes of one depth.
Run nodes_below(const Hierarchy& tree, Run nodes) {
    if (nodes.size() == 0) return {};
    const std::size_t end = nodes.last - 1;
    return {tree.first_node[nodes.first], tree.first_node[end] + tree.node_count[end]};
}
Run leaves_below(const Hierarchy& tree, Run nodes) {
    if (nodes.size() == 0) return {};
    const std::size_t end = nodes.last - 1;
    return {tree.first_leaf[nodes.first], tree.first_leaf[end] + tree.leaf_count[end]};
}

void add_run(std::vector<Run>& runs, Run run) {
    if (run.size() > 0) runs.push_back(run);
}

/// Replaces a chunk's nodes by those below as long as it has at most `most` Gaussians then.
void descend(const Hierarchy& tree, Chunk& chunk, std::size_t most) {
    while (chunk.nodes.size() > 0) {
        const Run nodes = nodes_below(tree, chunk.nodes), leaves = leaves_below(tree, chunk.nodes);
        if (nodes.size() + leaves.size() + total(chunk.leaves) > most) return;
        add_run(chunk.leaves, leaves);
        chunk.nodes = nodes;
    }
}

/// Runs of nodes of about as many children each, at most `most` where single nodes have fewer.
std::vector<Run> divided(const Hierarchy& tree, Run nodes, std::size_t most) {
    std::size_t children = nodes_below(tree, nodes).size() + leaves_below(tree, nodes).size();
    std::vector<Run> runs;
    // Nodes have at most as many children as cells have octants, or leaves: a run is that much above its share at most.
    constexpr std::size_t kMostChildren = 8;
    const std::size_t parts = (children + most - kMostChildren - 1) / (most - kMostChildren);
    std::size_t before = 0, part = 1;
    std::uint32_t first = nodes.first;
    for (std::uint32_t n = nodes.first; n < nodes.last; ++n) {
        before += std::size_t{tree.node_count[n]} + tree.leaf_count[n];
        if (before * parts < children * part && n + 1 < nodes.last) continue;
        runs.push_back({first, n + 1});
        first = n + 1;
        while (before * parts >= children * part) ++part;
    }
    return runs;
}

}  // namespace

std::size_t Chunk::leaf_count() const { return total(leaves); }

std::vector<Chunk> chunk_tree(const Hierarchy& hierarchy, std::size_t leaves,
                              std::size_t most_of_root, std::size_t most) {
    Chunk root;
    std::uint32_t below = 0, owned = 0;
    for (std::size_t n = 0; n < hierarchy.size(); ++n)
        below += hierarchy.node_count[n], owned += hierarchy.leaf_count[n];
    root.nodes = {0, static_cast<std::uint32_t>(hierarchy.size()) - below};
    add_run(root.leaves, {owned, static_cast<std::uint32_t>(leaves)});
    descend(hierarchy, root, most_of_root);
    std::vector<Chunk> chunks{root};
    for (std::size_t n = 0; n < chunks.size(); ++n) {
        const auto first = static_cast<std::uint32_t>(chunks.size());
        for (const Run run : divided(hierarchy, chunks[n].nodes, most)) {
            Chunk part;
            part.depth = chunks[n].depth + 1;
            part.nodes = nodes_below(hierarchy, run);
            add_run(part.leaves, leaves_below(hierarchy, run));
            descend(hierarchy, part, most);
            chunks.push_back(std::move(part));
        }
        chunks[n].parts = {first, static_cast<std::uint32_t>(chunks.size())};
    }
    return chunks;
}

}  // namespace vog::site
