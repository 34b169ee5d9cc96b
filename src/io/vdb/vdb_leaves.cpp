// vdb_leaves.cpp: leaves from the file straight into a volume, some megabytes at a time.
#include "io/vdb/vdb_leaves.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <bit>
#include <optional>
#include <tuple>

#include "core/parallel.h"
#include "io/vdb/vdb_density.h"

namespace vog::vdb {

namespace {

int active_count(const WalkedTree::LeafSpot& spot) {
    int count = 0;
    for (const std::uint64_t word : spot.mask) count += std::popcount(word);
    return count;
}

/// A leaf of the file, and the leaf of the volume that it becomes.
struct Wanted {
    const WalkedTree::LeafSpot* spot;
    std::size_t leaf;
};

/// One past the last of `wanted` that is read in one go with `first`: neighbours in the file.
std::size_t batch_end(std::span<const Wanted> wanted, std::size_t first) {
    constexpr std::uint64_t kMostBytes = 4 << 20, kWidestGap = 64 << 10;
    const std::uint64_t begin = wanted[first].spot->buffer;
    std::size_t last = first + 1;
    for (; last < wanted.size(); ++last) {
        const auto& before = *wanted[last - 1].spot;
        const auto& next = *wanted[last].spot;
        if (next.buffer - (before.buffer + before.bytes) > kWidestGap ||
            next.buffer + next.bytes - begin > kMostBytes)
            break;
    }
    return last;
}

}  // namespace

void throw_not_density(const std::string& where, const std::string& tree_type) {
    throw Error(fmt::format("{}: holds {}, expected float, double, int32, int64 or vec3", where,
                            short_type(tree_type)));
}

VdbLeaves::VdbLeaves(VdbFile& file, const VdbEntry& entry, bool mask)
    : file_(file),
      where_(file.where(entry)),
      tree_type_(entry.tree_type),
      owner_(tree_owner(file, entry)),
      mask_(mask) {
    with_vdb_errors(where_, [&] {
        walk();
        if (&owner_ != &entry) {
            FileRange in = file_.range(entry);
            head_ = read_vdb_head(in);
        }
        check_transform(head_.world_from_index, where_);
        tiles_.world_from_index = *head_.world_from_index;
    });
}

void VdbLeaves::walk() {
    const std::optional<TreeLayout> layout = tree_layout(tree_type_);
    const bool is_mask = layout && layout->leaf != LeafData::values;
    if (!layout || (is_mask && !mask_)) throw_not_density(where_, tree_type_);
    FileRange in = file_.range(owner_);
    head_ = read_vdb_head(in);
    storage_ = {*layout, head_.compression, owner_.half_stored};
    const std::uint64_t tree_begin = in.position();
    WalkedTree tree = walk_tree(in, storage_);
    read_topology(tree_begin, tree.topology_end);

    spots_ = std::move(tree.leaves);
    std::erase_if(spots_, [](const Spot& spot) { return active_count(spot) == 0; });
    std::ranges::sort(spots_, {}, [](const Spot& spot) {
        return std::tuple(spot.origin.x, spot.origin.y, spot.origin.z);
    });
}

/// Tiles come from OpenVDB's own tree, whose leaves stay empty.
void VdbLeaves::read_topology(std::uint64_t tree_begin, std::uint64_t end) {
    const BigVector<char> bytes = file_.bytes(tree_begin, end);
    const openvdb::GridBase::Ptr grid =
        read_vdb_topology(bytes, tree_type_, file_.version(), storage_);
    tile_census_ = tiles_from_grid(*grid, tiles_);
    empty_grid_ = grid->copyGridWithNewTree();
}

openvdb::GridClass VdbLeaves::grid_class() const {
    return openvdb::GridBase::stringToGridClass(head_.grid_class);
}

std::uint64_t VdbLeaves::active_voxels() const {
    std::uint64_t count = vog::active_voxels(tiles_);
    for (const Spot& spot : spots_) count += static_cast<std::uint64_t>(active_count(spot));
    return count;
}

Box VdbLeaves::world_box() const {
    Box box = tiles_.tiles.empty() ? Box{} : index_box(tiles_);
    constexpr double kHalf = 0.5;
    for (const Spot& spot : spots_) {
        const Vec3d lower = vec_cast<double>(spot.origin) - Vec3d{kHalf, kHalf, kHalf};
        box.include(lower);
        box.include(lower + Vec3d{kLeafEdge, kLeafEdge, kLeafEdge});
    }
    return transformed(tiles_.world_from_index, box);
}

template <class GridT>
void VdbLeaves::read_leaves(const GridT& grid, std::span<const std::uint32_t> numbers,
                            Volume& volume, Census& census) {
    using LeafT = typename GridT::TreeType::LeafNodeType;
    std::vector<Wanted> wanted;
    for (const std::uint32_t n : numbers) wanted.push_back({&spots_[n], wanted.size()});
    std::ranges::sort(wanted, {}, [](const Wanted& w) { return w.spot->buffer; });
    volume.leaves.reserve(wanted.size());
    for (std::size_t n = 0; n < wanted.size(); n = volume.leaves.size()) {
        check_interrupt();
        volume.leaves.resize(std::min(n + 4096, wanted.size()));
    }

    for (std::size_t first = 0, last = 0; first < wanted.size(); first = last) {
        last = batch_end(wanted, first);
        check_interrupt();
        const std::uint64_t begin = wanted[first].spot->buffer;
        const Spot& back = *wanted[last - 1].spot;
        const BigVector<char> bytes = file_.bytes(begin, back.buffer + back.bytes);
        census = Census::sum(
            census,
            tbb::parallel_reduce(
                tbb::blocked_range<std::size_t>(first, last, 64), Census{},
                [&](const auto& range, Census part) {
                    MemoryStream stream(bytes);
                    tag_vdb_stream(stream, file_.version(), storage_.compression);
                    openvdb::io::setGridBackgroundValuePtr(stream, &grid.tree().background());
                    check_interrupt();
                    for (std::size_t i = range.begin(); i < range.end(); ++i) {
                        const Spot& spot = *wanted[i].spot;
                        LeafT leaf(to_coord(spot.origin));
                        stream.seekg(static_cast<std::streamoff>(spot.buffer - begin));
                        leaf.readBuffers(stream, storage_.half_stored);
                        take_leaf(leaf, wanted[i].leaf, volume.leaves[wanted[i].leaf], part);
                    }
                    return part;
                },
                Census::sum));
    }
}

Volume VdbLeaves::read(const VolumePart& part, VdbNotes& notes) {
    std::vector<PartNode> nodes;
    for (const Spot& spot : spots_)
        nodes.push_back({spot.origin, static_cast<std::uint32_t>(active_count(spot))});
    for (const Tile& tile : tiles_.tiles) nodes.push_back({tile.origin, kLeafVoxels});
    return read_nodes(nodes_of(nodes, part), part.index == 0, notes);
}

Volume VdbLeaves::read_where(const NodeChoice& wanted, VdbNotes& notes) {
    std::vector<std::uint32_t> numbers;
    for (std::size_t n = 0; n < spots_.size(); ++n)
        if (wanted(spots_[n].origin, kLeafEdge)) numbers.push_back(static_cast<std::uint32_t>(n));
    for (std::size_t n = 0; n < tiles_.tiles.size(); ++n)
        if (wanted(tiles_.tiles[n].origin, tiles_.tiles[n].edge))
            numbers.push_back(static_cast<std::uint32_t>(spots_.size() + n));
    return read_nodes(std::move(numbers), true, notes);
}

Volume VdbLeaves::read_nodes(std::vector<std::uint32_t> numbers, bool tiles_noted,
                             VdbNotes& notes) {
    const auto tiles = std::ranges::lower_bound(numbers, spots_.size());

    Volume volume;
    volume.world_from_index = tiles_.world_from_index;
    for (auto n = tiles; n != numbers.end(); ++n)
        volume.tiles.push_back(tiles_.tiles[*n - spots_.size()]);
    numbers.erase(tiles, numbers.end());
    Census census;
    empty_grid_->apply<KnownGrids>(
        [&](const auto& grid) { read_leaves(grid, numbers, volume, census); });
    Census tiles_census = tile_census_;
    if (!tiles_noted) tiles_census.negative = 0;
    check_census(census, tiles_census, volume.leaves, tiles_.tiles, where_, notes);
    if (mask_) {
        keep_positive(volume);
        notes = {};
    }
    return volume;
}

}  // namespace vog::vdb
