// vdb_leaves.cpp: reading of leaves from the file directly into a volume, in batches of 4 MiB.
#include "io/vdb/vdb_leaves.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>

#include "core/parallel.h"
#include "io/vdb/vdb_density.h"
#include "io/vdb/vdb_volume.h"

namespace vog::vdb {

namespace {

int active_count(const CheckedTree::LeafRange& leaf) {
    int count = 0;
    for (const std::uint64_t word : leaf.mask) count += std::popcount(word);
    return count;
}

/// Leaf to read: its bytes in the file, and its index in the volume.
struct Selected {
    const CheckedTree::LeafRange* range;
    std::size_t index;
};

/// End of the batch that starts at `first`: leaves that are close to each other in the file.
std::size_t batch_end(std::span<const Selected> selected, std::size_t first) {
    constexpr std::uint64_t kMaxBytes = 4 << 20, kMaxGap = 64 << 10;
    const std::uint64_t begin = selected[first].range->buffer;
    std::size_t last = first + 1;
    for (; last < selected.size(); ++last) {
        const auto& before = *selected[last - 1].range;
        const auto& next = *selected[last].range;
        if (next.buffer - (before.buffer + before.bytes) > kMaxGap ||
            next.buffer + next.bytes - begin > kMaxBytes)
            break;
    }
    return last;
}

/// Reads the active tiles of one internal node, as its readTopology does.
template <class Node>
void read_node_tiles(std::istream& stream, const CheckedTree::TileRange& range, bool half_stored,
                     std::vector<Tile>& tiles) {
    typename Node::NodeMaskType child_mask, value_mask;
    child_mask.load(stream);
    value_mask.load(stream);
    const auto values = std::make_unique<typename Node::ValueType[]>(Node::NUM_VALUES);
    openvdb::io::readCompressedValues(stream, values.get(), Node::NUM_VALUES, value_mask,
                                      half_stored);
    for (auto on = value_mask.beginOn(); on; ++on) {
        openvdb::Coord local;
        Node::offsetToLocalCoord(on.pos(), local);
        tiles.push_back({range.origin + range.tile_edge * from_coord(local), range.tile_edge,
                         density(values[on.pos()])});
    }
}

}  // namespace

VdbLeaves::VdbLeaves(VdbFile& file, const VdbEntry& entry, const VdbOptions& options)
    : file_(file),
      where_(file.where(entry)),
      tree_type_(entry.tree_type),
      owner_(tree_owner(file, entry)),
      options_(options) {
    options_.values = value_rules(options);
    with_vdb_errors(where_, [&] {
        read_layout();
        if (&owner_ != &entry) {
            FileRange in = file_.range(entry);
            head_ = read_vdb_head(in);
        }
        check_transform(head_.world_from_index, where_);
        tiles_.world_from_index = *head_.world_from_index;
    });
}

void VdbLeaves::read_layout() {
    const std::optional<TreeLayout> layout = tree_layout(tree_type_);
    if (!layout) throw_not_density(where_, tree_type_);
    FileRange in = file_.range(owner_);
    head_ = read_vdb_head(in);
    storage_ = {*layout, head_.compression, owner_.half_stored};
    const std::uint64_t tree_begin = in.position();
    CheckedTree tree = check_tree(in, storage_);
    empty_grid_ = openvdb::GridBase::createGrid(tree_type_);
    empty_grid_->apply<KnownGrids>([&](auto& grid) { read_tiles(grid, tree_begin, tree.tiles); });

    leaves_ = std::move(tree.leaves);
    std::erase_if(leaves_, [](const LeafRange& leaf) { return active_count(leaf) == 0; });
    std::ranges::sort(leaves_, {}, [](const LeafRange& leaf) {
        return std::tuple(leaf.origin.x, leaf.origin.y, leaf.origin.z);
    });
}

template <class GridT>
void VdbLeaves::read_tiles(GridT& grid, std::uint64_t tree_begin,
                           std::span<const CheckedTree::TileRange> ranges) {
    using Tree = typename GridT::TreeType;
    using Upper = typename Tree::RootNodeType::ChildNodeType;
    typename Tree::ValueType background;
    constexpr std::uint64_t kBufferCountBytes = 4;
    const std::uint64_t at = tree_begin + kBufferCountBytes;
    std::memcpy(&background, file_.bytes(at, at + sizeof background).data(), sizeof background);
    grid.tree().root().setBackground(background, false);

    for (const CheckedTree::TileRange& range : ranges) {
        check_interrupt();
        const BigVector<char> bytes = file_.bytes(range.begin, range.end);
        if (range.tile_edge == static_cast<std::int32_t>(Upper::DIM)) {
            typename Tree::ValueType value;
            std::memcpy(&value, bytes.data(), sizeof value);
            tiles_.tiles.push_back({range.origin, range.tile_edge, density(value)});
            continue;
        }
        MemoryStream stream(bytes);
        tag_vdb_stream(stream, file_.version(), storage_.compression);
        openvdb::io::setGridBackgroundValuePtr(stream, &grid.tree().background());
        if (range.tile_edge == static_cast<std::int32_t>(Upper::ChildNodeType::DIM))
            read_node_tiles<Upper>(stream, range, storage_.half_stored, tiles_.tiles);
        else
            read_node_tiles<typename Upper::ChildNodeType>(stream, range, storage_.half_stored,
                                                           tiles_.tiles);
    }
    tile_census_ = admit_tiles(tiles_.tiles);
}

openvdb::GridClass VdbLeaves::grid_class() const {
    return openvdb::GridBase::stringToGridClass(head_.grid_class);
}

std::uint64_t VdbLeaves::active_voxels() const {
    std::uint64_t count = vog::active_voxels(tiles_);
    for (const LeafRange& leaf : leaves_) count += static_cast<std::uint64_t>(active_count(leaf));
    return count;
}

Box VdbLeaves::world_box() const {
    Box box = tiles_.tiles.empty() ? Box{} : index_box(tiles_);
    constexpr double kHalf = 0.5;
    for (const LeafRange& leaf : leaves_) {
        const Vec3d lower = vec_cast<double>(leaf.origin) - Vec3d{kHalf, kHalf, kHalf};
        box.include(lower);
        box.include(lower + Vec3d{kLeafEdge, kLeafEdge, kLeafEdge});
    }
    return transformed(tiles_.world_from_index, box);
}

template <class GridT>
void VdbLeaves::read_leaves(const GridT& grid, std::span<const std::uint32_t> numbers,
                            Volume& volume, Census& census) {
    using LeafT = typename GridT::TreeType::LeafNodeType;
    std::vector<Selected> selected;
    for (const std::uint32_t n : numbers) selected.push_back({&leaves_[n], selected.size()});
    std::ranges::sort(selected, {}, [](const Selected& s) { return s.range->buffer; });
    volume.leaves.reserve(selected.size());
    for (std::size_t n = 0; n < selected.size(); n = volume.leaves.size()) {
        check_interrupt();
        volume.leaves.resize(std::min(n + 4096, selected.size()));
    }

    for (std::size_t first = 0, last = 0; first < selected.size(); first = last) {
        last = batch_end(selected, first);
        check_interrupt();
        const std::uint64_t begin = selected[first].range->buffer;
        const LeafRange& back = *selected[last - 1].range;
        const BigVector<char> bytes = file_.bytes(begin, back.buffer + back.bytes);
        census = Census::sum(
            census, tbb::parallel_reduce(
                        tbb::blocked_range<std::size_t>(first, last, 64), Census{},
                        [&](const auto& range, Census part) {
                            MemoryStream stream(bytes);
                            tag_vdb_stream(stream, file_.version(), storage_.compression);
                            openvdb::io::setGridBackgroundValuePtr(stream,
                                                                   &grid.tree().background());
                            check_interrupt();
                            for (std::size_t i = range.begin(); i < range.end(); ++i) {
                                const auto& [stored, index] = selected[i];
                                LeafT leaf(to_coord(stored->origin));
                                stream.seekg(static_cast<std::streamoff>(stored->buffer - begin));
                                leaf.readBuffers(stream, storage_.half_stored);
                                convert_leaf(leaf, index, volume.leaves[index], part);
                            }
                            return part;
                        },
                        Census::sum));
    }
}

Volume VdbLeaves::read(const VolumePart& part, ValueNotes& notes) {
    std::vector<PartNode> nodes;
    for (const LeafRange& leaf : leaves_)
        nodes.push_back({leaf.origin, static_cast<std::uint32_t>(active_count(leaf))});
    for (const Tile& tile : tiles_.tiles) nodes.push_back({tile.origin, kLeafVoxels});
    return read_nodes(nodes_of(nodes, part), part.index == 0, notes);
}

Volume VdbLeaves::read_where(const NodeChoice& selected, ValueNotes& notes) {
    std::vector<std::uint32_t> numbers;
    for (std::size_t n = 0; n < leaves_.size(); ++n)
        if (selected(leaves_[n].origin, kLeafEdge))
            numbers.push_back(static_cast<std::uint32_t>(n));
    for (std::size_t n = 0; n < tiles_.tiles.size(); ++n)
        if (selected(tiles_.tiles[n].origin, tiles_.tiles[n].edge))
            numbers.push_back(static_cast<std::uint32_t>(leaves_.size() + n));
    return read_nodes(std::move(numbers), true, notes);
}

Volume VdbLeaves::read_nodes(std::vector<std::uint32_t> numbers, bool count_tiles,
                             ValueNotes& notes) {
    const auto tiles = std::ranges::lower_bound(numbers, leaves_.size());

    Volume volume;
    volume.world_from_index = tiles_.world_from_index;
    for (auto n = tiles; n != numbers.end(); ++n)
        volume.tiles.push_back(tiles_.tiles[*n - leaves_.size()]);
    numbers.erase(tiles, numbers.end());
    Census census;
    empty_grid_->apply<KnownGrids>(
        [&](const auto& grid) { read_leaves(grid, numbers, volume, census); });
    // Tiles are checked in every part, but counted in one alone.
    check_census(leaves_then_tiles(census, tile_census_), options_.values, where_, notes);
    if (!count_tiles) check_census(census, options_.values, where_, notes);
    drop_empty_leaves(volume);
    if (options_.ones) set_ones(volume, notes);
    if (options_.mask) {
        keep_positive(volume);
        notes = {};
    }
    return volume;
}

}  // namespace vog::vdb
