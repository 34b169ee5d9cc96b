// vdb_leaves.h: partial reading of a grid as density, leaf by leaf.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "data/volume_partition.h"
#include "io/vdb/bytes/vdb_file.h"
#include "io/vdb/bytes/vdb_tree_check.h"
#include "io/vdb/vdb_density.h"
#include "io/vdb/vdb_grid.h"
#include "vog/distributed.h"
#include "vog/volume_io.h"

namespace vog::vdb {

/// Topology of a grid, with the positions of its leaves in the file.
class VdbLeaves {
  public:
    /// file     must outlive this
    /// options  what counts as density; the grid's name has no effect
    /// throws vog::Error for a truncated or corrupt grid, a transform that is not affine, values
    ///        that are no density
    VdbLeaves(VdbFile& file, const VdbEntry& entry, const VdbOptions& options);

    openvdb::GridClass grid_class() const;
    const VdbMetadata& metadata() const { return head_.metadata; }
    bool empty() const { return leaves_.empty() && tiles_.tiles.empty(); }
    std::size_t count() const { return leaves_.size(); }  ///< leaves with active voxels
    std::uint64_t active_voxels() const;
    Box world_box() const;
    const Affine& world_from_index() const { return tiles_.world_from_index; }
    /// Reads a part of the grid. The volume has no name or source.
    Volume read(const VolumePart& part, ValueNotes& notes);
    Volume read_where(const NodeChoice& selected, ValueNotes& notes);

  private:
    using LeafRange = CheckedTree::LeafRange;
    void read_layout();
    /// Sets the background of `grid`, and the tiles. From the bytes of the nodes that have some:
    /// OpenVDB's own topology takes 0.3 MB for each node of 4096 voxels.
    template <class GridT>
    void read_tiles(GridT& grid, std::uint64_t tree_begin,
                    std::span<const CheckedTree::TileRange> ranges);
    /// Reads nodes by number: leaves first, then tiles.
    /// numbers      ascending
    /// count_tiles  whether invalid tiles are counted in `notes`
    Volume read_nodes(std::vector<std::uint32_t> numbers, bool count_tiles, ValueNotes& notes);
    template <class GridT>
    void read_leaves(const GridT& grid, std::span<const std::uint32_t> numbers, Volume& volume,
                     Census& census);

    VdbFile& file_;
    std::string where_, tree_type_;
    const VdbEntry& owner_;
    VdbOptions options_;
    VdbHead head_;
    TreeStorage storage_;
    openvdb::GridBase::Ptr empty_grid_;  ///< has the tree's type and background
    std::vector<LeafRange> leaves_;      ///< those with active voxels; by origin: x, then y, then z
    Volume tiles_;                       ///< tiles, without leaves
    Census tile_census_;
};

}  // namespace vog::vdb
