// vog/lod.h: levels of detail: hierarchies of coarser Gaussians, cuts through them, coarser models.
// A node is a Gaussian with the mass, mean and covariance of a group of Gaussians, its leaves: the
// cells of an octree over their means. A view draws a cut through the hierarchy: a node where its
// parts are smaller than a pixel, else the parts. Cost then follows the size of the picture and not
// that of the model (docs/scaling.md, "Cost that follows the screen").
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

/// Forest of M nodes whose leaves are the N Gaussians of a model. Nodes are stored level by level,
/// roots first, the children of a node side by side, and so are the leaves.
struct Hierarchy {
    /// [M] with the mass, mean and covariance of all leaves below, relative to the model's origin, and the
    /// model's fields, of the joint moments of position and value of all leaves below.
    Gaussians nodes;
    /// [M] Children of node n: the nodes first_node[n] ... first_node[n] + node_count[n] - 1, all
    /// behind n, and the leaves first_leaf[n] ... first_leaf[n] + leaf_count[n] - 1 of the model.
    std::vector<std::uint32_t> first_node, first_leaf;
    std::vector<std::uint8_t> node_count, leaf_count;  ///< [M] numbers of children, sum >= 2
    /// [M] radius of a ball around the node's mean that holds the supports of the node and of all
    /// below, world units, >= 0.
    std::vector<float> radius;
    /// [M] Geometric error, world units, >= 0: half the edge of the node's octree cell, or of its
    /// widest child's box if larger. Never less than a child's. A node is drawn where the
    /// projection of its error is below CutOptions::pixel_error.
    std::vector<float> error;

    std::size_t size() const { return node_count.size(); }  ///< M
    bool empty() const { return node_count.empty(); }
};

/// Options of build_hierarchy.
struct HierarchyOptions {
    /// Map from world units to voxel indices of the volume that the model came from; voxel i is
    /// [i - 1/2, i + 1/2]. Nodes are then blocks of 2^3, 4^3, ... of its cells. None: the octree
    /// divides the box of the means.
    std::optional<Affine> index_from_world;
};

/// Builds the hierarchy of a model, and sorts the model's Gaussians into its order. The same bytes
/// for any number of threads.
/// model   finite values, at most 2^32 - 2 Gaussians; a model of fewer than 2 has no nodes
/// throws  vog::Error for an invalid or too large model
/// cost    O(N log N) time; 20 bytes a Gaussian and 80 a node (160 with a scalar field, 352 with a vector
///         field) of memory meanwhile. M is N / 7 where Gaussians fill their cells, up to N / 3
///         where they are scattered
[[nodiscard]] Hierarchy build_hierarchy(Gaussians& model, const HierarchyOptions& options = {});

/// Checks the arrays of a hierarchy against its model and the ranges above.
/// model   with the same origin and cutoff
/// where   name in the error message
/// throws  vog::Error naming `where` and the first offence
void validate(const Hierarchy& hierarchy, const Gaussians& model, const std::string& where);

/// Appends the hierarchy of another model, when vog::append has joined or will join the models.
/// Each keeps its own levels; write_ply refuses the result. Where origins differ, nodes may get
/// another origin than the joined model: set_origin(hierarchy.nodes, model.origin) follows.
/// leaves  N of the first model, before it is joined
/// throws  vog::Error if the cutoffs differ
void append(Hierarchy& hierarchy, const Hierarchy& other, std::size_t leaves);

/// Options of a cut.
struct CutOptions {
    /// Largest projected error of a node that is drawn, pixels, >= 0. 1: nodes whose parts are
    /// smaller than a pixel. 0: no nodes, only leaves.
    double pixel_error = 1;
    bool skip_unseen = true;  ///< leave out nodes whose ball is off the picture or behind the eye
};

/// Counts of a cut.
struct CutReport {
    std::size_t visited = 0;                              ///< nodes tested
    std::size_t nodes = 0;                                ///< nodes drawn
    std::size_t leaves = 0;                               ///< Gaussians of the model drawn
    std::size_t drawn() const { return nodes + leaves; }  ///< Gaussians drawn in all
};

/// Cuts through one hierarchy for a sequence of views. In each, a leaf is drawn, or one node above
/// it, or neither where it is out of view. Buffers, 32 bytes a node, are kept from view to view.
class ViewCut {
  public:
    /// model, hierarchy  must outlive it, unchanged
    /// cutoff            of the drawn kernels, standard deviations; 0: the model's
    /// throws            vog::Error for a hierarchy that validate() refuses for this model
    ViewCut(const Gaussians& model, const Hierarchy& hierarchy, double cutoff = 0);
    ~ViewCut();
    ViewCut(ViewCut&&) noexcept;
    ViewCut& operator=(ViewCut&&) noexcept;

    /// Chooses the Gaussians that a view draws.
    /// frame    camera and image size
    /// returns  nodes level by level, then leaves in the model's order; the model itself if all its
    ///          leaves are drawn; valid until the next call. The same bytes for any number of
    ///          threads
    /// throws   vog::Error for a pixel_error that is negative or NaN
    /// cost     O(nodes visited + Gaussians drawn) time, parallel; 44 bytes a Gaussian drawn, and its fields
    const Gaussians& choose(const CameraFrame& frame, const CutOptions& options = {});
    /// Counts of the last cut.
    const CutReport& report() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Coarser models of the same mass, mean and covariance, and joint moments with the fields, by a tree that halves the model across its
/// longest axis; parts are split in the order of their gain.
/// budgets  largest number of Gaussians of each result, > 0
/// returns  one model a budget, with rotations and the model's cutoff and box; the model itself for
///          a budget of N or more. The same bytes for any number of threads
/// throws   vog::Error for a budget of 0 or an invalid model
/// cost     O(N log N) time, once for all budgets; 200 bytes a Gaussian
[[nodiscard]] std::vector<Gaussians> coarsen(const Gaussians& model,
                                             std::span<const std::size_t> budgets);
/// Coarser model for one budget.
[[nodiscard]] Gaussians coarsen(const Gaussians& model, std::size_t budget);

/// Budgets for the levels of detail below a model: a quarter of the Gaussians each time, down to
/// about 1000.
/// size     N of the model
/// most     largest number of levels, the model included
/// returns  largest first; empty for fewer than 2000 Gaussians
[[nodiscard]] std::vector<std::size_t> detail_budgets(std::size_t size, std::size_t most = 8);
/// Levels of detail of a model, finest first: the model, then coarsen for detail_budgets.
/// most  largest number of levels
[[nodiscard]] std::vector<Gaussians> detail_levels(Gaussians model, std::size_t most = 8);

}  // namespace vog
