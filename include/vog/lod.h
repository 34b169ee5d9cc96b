// vog/lod.h: levels of detail: coarser Gaussians for every neighbourhood of a model, so that the cost of a
// picture follows the screen and not the model.
// Mass, first and second moments add up whatever Gaussians they are of, so any group of them has
// one that stands for it. Groups are the cells of an octree over the means; a view draws a cut
// through it (docs/scaling.md, "Cost that follows the screen").
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vog/camera.h"
#include "vog/gaussians.h"
#include "vog/linear.h"

namespace vog {

/// A forest over a model's Gaussians, its leaves. Nodes lie level by level, and so do leaves, those
/// of one size side by side: what a view draws is read in long runs.
struct Hierarchy {
    Gaussians nodes;  ///< [M] mass, mean and covariance of the leaves below
    /// [M] children of node n: the nodes first_node[n] ... first_node[n] + node_count[n] - 1, all
    /// behind n, and the leaves first_leaf[n] ... first_leaf[n] + leaf_count[n] - 1.
    std::vector<std::uint32_t> first_node, first_leaf;
    std::vector<std::uint8_t> node_count, leaf_count;  ///< [M] together at least 2
    /// [M] of the ball around the mean that holds the supports of the node and of all below.
    std::vector<float> radius;
    /// [M] how far from its place mass is drawn: half the edge of the node's cell in the octree, or
    /// of a box as wide as its widest child where that is larger. World units; none below a node
    /// has a larger one. What a view compares with its pixels.
    std::vector<float> error;

    std::size_t size() const { return node_count.size(); }
    bool empty() const { return node_count.empty(); }
};

struct HierarchyOptions {
    /// Lattice of the cells that the Gaussians came from, if they did: nodes are then blocks of
    /// 2^3, 4^3, ... of them, as they should be. A voxel i is [i - 1/2, i + 1/2].
    std::optional<Affine> index_from_world;
};

/// Builds it, and puts the model's Gaussians into its order. The same bytes for any number of
/// threads.
/// throws  vog::Error for an invalid model, or one of 2^32 Gaussians
/// cost    O(N log N) time; 20 bytes a Gaussian and 80 a node while it is built. Nodes are a
///         seventh as many as Gaussians that fill their cells, up to a third where they are
///         scattered
[[nodiscard]] Hierarchy build_hierarchy(Gaussians& model, const HierarchyOptions& options = {});

/// Checks lengths, order and values of a hierarchy over `leaves` Gaussians with this cutoff.
/// throws  vog::Error naming `where` and what is wrong
void validate(const Hierarchy& hierarchy, std::size_t leaves, double cutoff,
              const std::string& where);

/// Joins those of two models, as vog::append joins these: level by level each for itself.
/// leaves  of the model before
void append(Hierarchy& hierarchy, const Hierarchy& other, std::size_t leaves);

struct CutOptions {
    /// A node is drawn where its error is below this many pixels: 1 merges parts that are smaller
    /// than a pixel. 0: no node ever is. >= 0
    double pixel_error = 1;
    bool skip_unseen = true;  ///< leave out what is wholly off the picture or behind the eye
};

struct CutReport {
    std::size_t visited = 0;  ///< nodes that were looked at
    std::size_t nodes = 0;    ///< nodes that are drawn,
    std::size_t leaves = 0;   ///< and Gaussians of the model
    std::size_t drawn() const { return nodes + leaves; }
};

/// Cuts through one hierarchy, view after view: every leaf is drawn, or one node above it is, or it
/// is not in view. Its buffers last, so that a view like the one before allocates nothing.
class ViewCut {
  public:
    /// model, hierarchy  must outlive it and stay as they are
    ViewCut(const Gaussians& model, const Hierarchy& hierarchy);
    ~ViewCut();
    ViewCut(ViewCut&&) noexcept;
    ViewCut& operator=(ViewCut&&) noexcept;

    /// returns  the Gaussians to draw, nodes level by level, then leaves in the model's order; the
    ///          model itself where that is all of it. The same bytes for any number of threads.
    ///          Good until the next call
    /// throws   vog::Error for an error that is negative or no number
    /// cost     O(nodes visited + Gaussians drawn) time, parallel; 32 bytes a node for good, 44 a
    ///          Gaussian drawn
    const Gaussians& choose(const CameraFrame& frame, const CutOptions& options = {});
    /// Of the last call.
    const CutReport& report() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Coarser models of the same mass, mean and covariance. Neighbours are joined by a tree that
/// halves the model across its longest axis, and split again where that gains most.
/// budgets  the most Gaussians each result may have, > 0
/// returns  one model a budget, with the model's cutoff and box. A budget that the model meets gives
///          the model itself; with rotations otherwise. The same bytes for any number of threads
/// throws   vog::Error for a budget of 0 or an invalid model
/// cost     O(N log N) time, once for all budgets; 200 bytes a Gaussian
[[nodiscard]] std::vector<Gaussians> coarsen(const Gaussians& model,
                                             std::span<const std::size_t> budgets);
[[nodiscard]] Gaussians coarsen(const Gaussians& model, std::size_t budget);

/// What levels of detail below a model of this size may have: a quarter as many Gaussians each
/// time, down to about a thousand.
/// most  levels, the model included
[[nodiscard]] std::vector<std::size_t> detail_budgets(std::size_t size, std::size_t most = 8);
/// The model and, coarsened, those below it.
[[nodiscard]] std::vector<Gaussians> detail_levels(Gaussians model, std::size_t most = 8);

}  // namespace vog
