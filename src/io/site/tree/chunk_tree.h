// chunk_tree.h: division of a model's hierarchy into chunks of some thousand Gaussians, which files hold and views load.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "vog/lod.h"

namespace vog::site {

/// Nodes or Gaussians first ... last - 1.
struct Run {
    std::uint32_t first = 0, last = 0;
    std::size_t size() const { return last - first; }
};

/// Gaussians of one region at one depth of the hierarchy: nodes, and Gaussians of the model that have no node between the chunk
/// above and these nodes.
struct Chunk {
    Run nodes;                ///< of the hierarchy
    std::vector<Run> leaves;  ///< of the model, a run a depth
    std::uint32_t depth = 0;  ///< in the tree of chunks; 0 the root
    Run parts;  ///< chunks whose nodes and leaves are below `nodes`; none where there are no nodes
    std::size_t leaf_count() const;
    std::size_t size() const { return nodes.size() + leaf_count(); }
};

/// Limits on the Gaussians of a chunk. The root is the first to arrive: half as large, at most 70 kB without fields.
inline constexpr std::size_t kMostOfRoot = 8192, kMostOfChunk = 16384;

/// Chunks breadth first, the root first; the parts of a chunk side by side. Every Gaussian is a leaf of one chunk, and every
/// node below the root chunk at most of one. A chunk's nodes are as deep as its limit lets them be.
/// hierarchy  as build_hierarchy makes it, or empty
/// leaves     number of Gaussians of the model, > 0
std::vector<Chunk> chunk_tree(const Hierarchy& hierarchy, std::size_t leaves,
                              std::size_t most_of_root = kMostOfRoot,
                              std::size_t most = kMostOfChunk);

}  // namespace vog::site
