// root_cells.h: Bounding volume hierarchy over the cells of a NanoVDB root. The root is a list: a
// ray that tests every entry takes time in proportion to their number, 100,000 in a sparse grid.
#pragma once

#include <cstdint>
#include <vector>

#include "render/reference/nano_tree.h"
#include "vog/linear.h"

namespace vog::reference {

/// Child or active tile of a root, in local coordinates: index space minus `corner`.
struct RootCell {
    Vec3d lower, upper;                ///< outer faces of its active voxels
    Vec3d origin;                      ///< lower corner of the cell itself
    const NanoUpper* child = nullptr;  ///< null: a tile
    float value = 0;                   ///< of a tile
};

/// Cells in the order of a hierarchy, whose nodes are stored in preorder.
class RootCells {
  public:
    /// Box of a run of cells.
    struct Node {
        Vec3d lower, upper;
        std::uint32_t skip = 0;              ///< next node of a ray that misses the box
        std::uint32_t first = 0, count = 0;  ///< cells of a leaf; count 0: an inner node
    };

    RootCells() = default;
    /// corner  index of the local origin
    RootCells(const NanoRoot& root, Vec3d corner);
    const std::vector<Node>& nodes() const { return nodes_; }
    const RootCell& operator[](std::size_t i) const { return cells_[i]; }

  private:
    void build(std::uint32_t first, std::uint32_t end);
    std::vector<RootCell> cells_;
    std::vector<Node> nodes_;
};

}  // namespace vog::reference
