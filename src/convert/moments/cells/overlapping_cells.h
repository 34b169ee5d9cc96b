// overlapping_cells.h: uniform cells whose windows overlap by half a cell, in one pass.
// A hard cell of edge b has a Gaussian with the deviation of a box, 0.342 b after widening for the
// cutoff: a constant field then varies by 27 % (root mean square) along the axes, a grid of dots. A
// window has the weights 1/8, 7/8, 7/8, 1/8 on half cells along each axis, which add up to one:
// deviation 0.453 b, 2.2 % along the axes, 1.8 % along diagonals of faces, 2.0 % of cubes.
// A cell of one voxel has that voxel alone. Along each axis it is as wide as its box, of variance 1/12, and wider by
// the mass that it has in common with its two neighbours: between voxels alike 1/6, the variance of the tent that linear
// interpolation makes of a voxel. No ripples, and no blur between unlike ones.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "convert/moments/cells/lattice_field.h"
#include "convert/moments/cells/morton_nodes.h"
#include "convert/moments/cells/packed_cells.h"
#include "vog/voxel_field.h"

namespace vog::moments {

/// Share of the half cell next to a cell that belongs to its window, along one axis. The next
/// dyadic fractions: 1/16 leaves 11 % along the axes; 1/4 1.6 %, but smoke at 2 voxels has L2 0.030
/// in the paper view against 0.026 with 1/8.
inline constexpr double kOuterWeight = 0.125;

/// Buffers of one thread, reused from node to node.
struct OverlapScratch {
    std::vector<float> values;     ///< voxels of the node's cells and of one ring of cells around
    std::vector<double> occupied;  ///< 1 for those cells with a voxel above 0, else 0
    /// Which cells around each of them have windows on its voxels: bit neighbour_bit(step).
    std::vector<std::uint32_t> joined;
    bool apart = false;  ///< some have none: empty space lies between
    std::vector<double> window_sums, halves, along_x, along_y;
    std::vector<MomentSums> half_sums;
    std::vector<MomentSums> cells;  ///< the node's cells in Morton order, about their centres
    int side = 1;                   ///< edge of these cells, voxels
    bool shared = false;            ///< window_sums are set: not all cells have the whole window
};
/// step  from a cell to one around, {-1, 0, 1}^3
constexpr int neighbour_bit(Vec3i step) { return 9 * step.x + 3 * step.y + step.z + 13; }

/// Windows over the leaves and tiles of one volume. Occupied cells alone have windows: the share of
/// an empty neighbour goes to the others, so that there are as many Gaussians as with hard cells. Nor has a cell a
/// window on voxels of a neighbour beyond half an edge of empty space: wider than its standard deviation.
/// Cells of a tile above 8 voxels overlap each other only. Mass, mean and covariance of the whole
/// are those of the voxels.
class OverlappingCells {
  public:
    /// nodes   of the volume, sorted; both must outlive the object
    /// edge    of a cell, voxels: 1, 2, 4 or 8
    /// period  as LeafNeighbours has it: windows go across the faces
    OverlappingCells(const Volume& volume, std::span<const MortonNode> nodes, int edge,
                     std::optional<IndexBox> period = {});
    /// Sets scratch.cells and scratch.side; empty cells have mass 0.
    /// masses_only  leaves the other moments unset, in a third of the time for fine cells
    void take(const MortonNode& node, OverlapScratch& scratch, bool masses_only = false) const;
    /// Copies a field at the voxels of the node's cells and of one ring of cells around, as
    /// scratch.values are laid out; 0 where the volume has no leaf or small tile.
    /// node  of kLeafEdge voxels
    void gather(const MortonNode& node, const VoxelValues& field, std::vector<float>& values) const;

  private:
    template <int edge>
    void take_leaf(const MortonNode& node, OverlapScratch& scratch, bool masses_only) const;
    /// Copies one value a voxel of the node and around.
    /// leaf_of, tile_of  called with an index: the 512 values of a leaf, the one of a tile
    template <int edge, class LeafOf, class TileOf>
    void gather_around(const MortonNode& node, const LeafOf& leaf_of, const TileOf& tile_of,
                       std::vector<float>& values) const;
    /// Sets scratch.occupied and scratch.joined.
    template <int edge>
    void find_joined(OverlapScratch& scratch) const;
    /// Sets scratch.window_sums, the sum of the windows at each half cell; false where all cells are occupied
    /// and joined: sums of 1.
    template <int edge>
    bool find_shares(OverlapScratch& scratch) const;
    /// Cells of one voxel.
    void take_voxels(OverlapScratch& scratch) const;
    /// Cells of 2 voxels: half cells have a mass alone, the windows are separable.
    void take_fine(OverlapScratch& scratch, bool shared, bool masses_only) const;
    /// Cells of 4 and 8 voxels, and those apart: half cells have moments of their own.
    template <int edge>
    void take_coarse(OverlapScratch& scratch, bool shared) const;
    void take_tile(const Tile& tile, OverlapScratch& scratch) const;

    const Volume& volume_;
    LeafNeighbours neighbours_;
    int edge_;
};

/// Calls take(sums, center) for each occupied cell of a node, as for_each_cell.
template <class Take>
void for_each_overlapping_cell(const OverlappingCells& windows, const MortonNode& node,
                               OverlapScratch& scratch, bool masses_only, const Take& take) {
    windows.take(node, scratch, masses_only);
    for (std::size_t n = 0; n < scratch.cells.size(); ++n)
        if (scratch.cells[n].mass > 0)
            take(scratch.cells[n],
                 cube_center(node.origin + scratch.side * morton_place(static_cast<int>(n)),
                             scratch.side));
}

/// Cells of a field, overlapping, in Morton order of each volume; the start of soft steps.
/// edge    voxels of each volume by itself: windows end at the seams of levels
/// period  MomentOptions::periodic
PackedCells overlapping_cells(const LatticeField& field, int edge,
                              const std::optional<Box>& period = {});

}  // namespace vog::moments
