// vdb_leaves.h: a grid of a file as density, leaf by leaf, for the files named vdb_*.cpp only.
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

/// throws vog::Error: what a tree of this type is, and what was expected
[[noreturn]] void throw_not_density(const std::string& where, const std::string& tree_type);

/// The topology of a grid, and where its leaves lie in the file.
class VdbLeaves {
  public:
    /// file   must outlive this
    /// mask   as VdbOptions::mask
    /// throws vog::Error if the grid's bytes are not whole and sound, its transform is not affine,
    ///        its values are no density
    VdbLeaves(VdbFile& file, const VdbEntry& entry, bool mask);

    openvdb::GridClass grid_class() const;
    bool empty() const { return spots_.empty() && tiles_.tiles.empty(); }
    std::size_t count() const { return spots_.size(); }  ///< leaves with active voxels
    std::uint64_t active_voxels() const;
    Box world_box() const;
    const Affine& world_from_index() const { return tiles_.world_from_index; }
    /// The volume has neither name nor source.
    Volume read(const VolumePart& part, VdbNotes& notes);
    Volume read_where(const NodeChoice& wanted, VdbNotes& notes);

  private:
    using Spot = WalkedTree::LeafSpot;
    void walk();
    void read_topology(std::uint64_t tree_begin, std::uint64_t end);
    /// Leaves, then tiles, by their numbers. tiles_noted: whether their notes are to be told
    Volume read_nodes(std::vector<std::uint32_t> numbers, bool tiles_noted, VdbNotes& notes);
    template <class GridT>
    void read_leaves(const GridT& grid, std::span<const std::uint32_t> numbers, Volume& volume,
                     Census& census);

    VdbFile& file_;
    std::string where_, tree_type_;
    const VdbEntry& owner_;
    bool mask_ = false;
    VdbHead head_;
    TreeStorage storage_;
    openvdb::GridBase::Ptr empty_grid_;  ///< of the tree's type and background
    std::vector<Spot> spots_;            ///< with active voxels; by origin: x, then y, then z
    Volume tiles_;                       ///< the tiles alone
    Census tile_census_;
};

}  // namespace vog::vdb
