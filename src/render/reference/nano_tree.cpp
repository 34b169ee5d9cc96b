// nano_tree.cpp: Converts leaves and tiles of a volume to nodes of a NanoVDB grid, bottom up.
// Direct writing takes half the memory of a conversion from an OpenVDB grid and is a few times
// faster.
#include "render/reference/nano_tree.h"

#include <fmt/core.h>

#include <algorithm>
#include <tuple>

#include "core/parallel.h"
#include "vog/error.h"

namespace vog::reference {

namespace {

using NanoGrid = nanovdb::NanoGrid<float>;
using nanovdb::Coord;
using nanovdb::CoordBBox;

constexpr int kLimit = 1 << 30;  // |index|: differences of two indices fit 32 bits
constexpr int kLowerEdge = 128, kUpperEdge = 4096;

/// One cell of a node's table: a child of the level below, or a tile.
struct Cell {
    Vec3i origin;
    std::int64_t child = -1;  ///< index of the child within its level; -1: a tile
    float value = 0;          ///< of the tile
};

/// Node with a run of consecutive cells.
struct Group {
    Vec3i origin;
    std::size_t first = 0, last = 0;
};

Vec3i aligned(Vec3i v, int edge) { return {v.x & -edge, v.y & -edge, v.z & -edge}; }
Coord coord(Vec3i v) { return {v.x, v.y, v.z}; }

/// Order of the cells of one level: by upper node, then lower node, then x, y, z, so that the cells
/// of any node are consecutive in memory.
bool node_order(Vec3i a, Vec3i b) {
    for (const int edge : {kUpperEdge, kLowerEdge, 1}) {
        const Vec3i u = aligned(a, edge), v = aligned(b, edge);
        if (!(u == v)) return std::tie(u.x, u.y, u.z) < std::tie(v.x, v.y, v.z);
    }
    return false;
}

/// Sorts cells by node_order. throws vog::Error for two cells of the same origin
void sort_cells(std::vector<Cell>& cells, const Volume& volume) {
    std::sort(cells.begin(), cells.end(),
              [](const Cell& a, const Cell& b) { return node_order(a.origin, b.origin); });
    const auto twice =
        std::adjacent_find(cells.begin(), cells.end(),
                           [](const Cell& a, const Cell& b) { return a.origin == b.origin; });
    if (twice != cells.end())
        throw Error(fmt::format("{}: two nodes or tiles overlap at voxel [{}, {}, {}]",
                                volume.source.empty() ? "volume" : volume.source, twice->origin.x,
                                twice->origin.y, twice->origin.z));
}

/// Groups sorted cells by nodes of this edge.
std::vector<Group> group_cells(const std::vector<Cell>& cells, int edge) {
    std::vector<Group> groups;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const Vec3i origin = aligned(cells[i].origin, edge);
        if (groups.empty() || !(groups.back().origin == origin)) groups.push_back({origin, i, i});
        groups.back().last = i + 1;
    }
    return groups;
}

/// Nodes and cells of all levels, before any byte is written.
struct Layout {
    std::vector<const Leaf*> leaves;
    std::vector<Cell> lower_cells, upper_cells, root_cells;
    std::vector<Group> lowers, uppers;
};

/// Empty cells of 8^3 voxels with an occupied block among the seven above them in x, y and z.
std::vector<Cell> border_cells(const Volume& volume, const std::vector<Cell>& cells) {
    std::vector<Vec3i> candidates;
    const auto add_below = [&](Vec3i origin, int edge) {
        // The shell of blocks just below the lower faces of a cube.
        for (int x = -kLeafEdge; x < edge; x += kLeafEdge)
            for (int y = -kLeafEdge; y < edge; y += kLeafEdge)
                for (int z = -kLeafEdge; z < edge; z += kLeafEdge) {
                    if (x >= 0 && y >= 0 && z >= 0) break;
                    candidates.push_back(origin + Vec3i{x, y, z});
                }
    };
    for (const Cell& cell : cells) add_below(cell.origin, kLeafEdge);
    for (const Tile& tile : volume.tiles)
        if (tile.edge > kLeafEdge) add_below(tile.origin, tile.edge);
    std::sort(candidates.begin(), candidates.end(), node_order);
    candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());

    // Origins of tiles that may cover a candidate, by size: a tile of 128 voxels may have the origin
    // of a node of 4096.
    const auto origins_of = [&](int edge) {
        std::vector<Vec3i> origins;
        for (const Tile& tile : volume.tiles)
            if (tile.edge == edge) origins.push_back(tile.origin);
        std::sort(origins.begin(), origins.end(), node_order);
        return origins;
    };
    const std::vector<Vec3i> lower = origins_of(kLowerEdge), upper = origins_of(kUpperEdge);
    const auto covers = [](const std::vector<Vec3i>& tiles, Vec3i origin) {
        return std::binary_search(tiles.begin(), tiles.end(), origin, node_order);
    };
    std::vector<Cell> border;
    for (const Vec3i block : candidates) {
        const auto found = std::lower_bound(
            cells.begin(), cells.end(), block,
            [](const Cell& cell, Vec3i origin) { return node_order(cell.origin, origin); });
        const bool occupied = (found != cells.end() && found->origin == block) ||
                              covers(lower, aligned(block, kLowerEdge)) ||
                              covers(upper, aligned(block, kUpperEdge));
        if (!occupied) border.push_back({block});
    }
    return border;
}

Layout lay_out(const Volume& volume, bool with_border) {
    Layout layout;
    const auto require_in_range = [&](Vec3i origin) {
        for (int axis = 0; axis < 3; ++axis)
            if (origin[axis] < -kLimit || origin[axis] >= kLimit)
                throw Error(fmt::format("{}: voxel index {}, expected within 2^30 of 0",
                                        volume.source.empty() ? "volume" : volume.source,
                                        origin[axis]));
    };
    for (const Leaf& leaf : volume.leaves) {
        check_interrupt();
        require_in_range(leaf.origin);
        if (leaf.active_count() > 0) layout.lower_cells.push_back({leaf.origin, 0});
    }
    for (const Tile& tile : volume.tiles) {
        require_in_range(tile.origin);
        auto& cells = tile.edge == kLeafEdge    ? layout.lower_cells
                      : tile.edge == kLowerEdge ? layout.upper_cells
                                                : layout.root_cells;
        cells.push_back({tile.origin, -1, tile.value});
    }
    sort_cells(layout.lower_cells, volume);
    if (with_border) {
        const std::vector<Cell> border = border_cells(volume, layout.lower_cells);
        layout.lower_cells.insert(layout.lower_cells.end(), border.begin(), border.end());
        sort_cells(layout.lower_cells, volume);
    }

    // Leaves are numbered in node order; the volume has them sorted by x, y, z.
    const auto find_leaf = [&](Vec3i origin) {
        return std::lower_bound(volume.leaves.begin(), volume.leaves.end(), origin,
                                [](const Leaf& leaf, Vec3i o) {
                                    return std::tie(leaf.origin.x, leaf.origin.y, leaf.origin.z) <
                                           std::tie(o.x, o.y, o.z);
                                });
    };
    for (Cell& cell : layout.lower_cells) {
        if (cell.child < 0) continue;
        check_interrupt();
        cell.child = static_cast<std::int64_t>(layout.leaves.size());
        layout.leaves.push_back(&*find_leaf(cell.origin));
    }
    layout.lowers = group_cells(layout.lower_cells, kLowerEdge);
    for (std::size_t i = 0; i < layout.lowers.size(); ++i)
        layout.upper_cells.push_back({layout.lowers[i].origin, static_cast<std::int64_t>(i)});
    sort_cells(layout.upper_cells, volume);
    layout.uppers = group_cells(layout.upper_cells, kUpperEdge);
    for (std::size_t i = 0; i < layout.uppers.size(); ++i)
        layout.root_cells.push_back({layout.uppers[i].origin, static_cast<std::int64_t>(i)});
    sort_cells(layout.root_cells, volume);
    return layout;
}

void write_leaf(const Leaf& from, bool with_border, NanoLeaf& to) {
    auto& data = *to.data();
    CoordBBox box;
    for (int n = 0; n < kLeafVoxels; ++n) {
        if (!from.active(n)) continue;
        data.mValueMask.setOn(static_cast<std::uint32_t>(n));
        data.mValues[n] = from.value[static_cast<std::size_t>(n)];
        box.expand({n >> 6, (n >> 3) & 7, n & 7});
    }
    if (with_border)  // cells just below a voxel interpolate its value too
        for (int axis = 0; axis < 3; ++axis) box.min()[axis] = std::max(box.min()[axis] - 1, 0);
    // NanoVDB's own updateBBox reads a 64-bit word through other types: undefined behaviour.
    data.mBBoxMin = coord(from.origin) + box.min();
    for (int axis = 0; axis < 3; ++axis)
        data.mBBoxDif[axis] = static_cast<std::uint8_t>(box.max()[axis] - box.min()[axis]);
    data.mFlags = 2;  // NanoVDB's flag of a leaf with a bounding box
}

void expand(CoordBBox& box, const CoordBBox& other) {
    box.expand(other.min());
    box.expand(other.max());
}
CoordBBox tile_box(Vec3i origin, int edge) { return CoordBBox::createCube(coord(origin), edge); }

/// Fills an internal node's table, masks and box from its cells.
template <class Node>
void write_node(const Group& group, const std::vector<Cell>& cells,
                const typename Node::ChildNodeType* children, Node& to) {
    using Child = typename Node::ChildNodeType;
    auto& data = *to.data();
    data.mFlags = 2;  // NanoVDB's flag of a node with active values
    data.mBBox = CoordBBox();
    for (std::size_t i = group.first; i < group.last; ++i) {
        const Cell& cell = cells[i];
        const std::uint32_t n = Node::CoordToOffset(coord(cell.origin));
        if (cell.child >= 0) {
            const Child& child = children[cell.child];
            data.mChildMask.setOn(n);
            data.setChild(n, &child);
            expand(data.mBBox, child.bbox());
        } else {
            data.mValueMask.setOn(n);
            data.setValue(n, cell.value);
            expand(data.mBBox, tile_box(cell.origin, static_cast<int>(Child::DIM)));
        }
    }
}

void write_root(const std::vector<Cell>& cells, const NanoUpper* uppers, NanoRoot& root) {
    auto& data = *root.data();
    data.mTableSize = static_cast<std::uint32_t>(cells.size());
    data.mBBox = CoordBBox();
    for (std::uint32_t i = 0; i < cells.size(); ++i) {
        auto* tile = data.tile(i);
        const Coord origin = coord(cells[i].origin);
        if (cells[i].child >= 0) {
            tile->setChild(origin, uppers + cells[i].child, &data);
            expand(data.mBBox, uppers[cells[i].child].bbox());
        } else {
            tile->setValue(origin, true, cells[i].value);
            expand(data.mBBox, tile_box(cells[i].origin, kUpperEdge));
        }
    }
}

std::uint64_t count_voxels(const Layout& layout) {
    std::uint64_t voxels = 0;
    for (const Leaf* leaf : layout.leaves) {
        check_interrupt();
        voxels += static_cast<std::uint64_t>(leaf->active_count());
    }
    const auto add_tiles = [&](const std::vector<Cell>& cells, std::uint64_t edge) {
        for (const Cell& cell : cells) voxels += cell.child < 0 ? edge * edge * edge : 0;
    };
    add_tiles(layout.lower_cells, kLeafEdge);
    add_tiles(layout.upper_cells, kLowerEdge);
    add_tiles(layout.root_cells, kUpperEdge);
    return voxels;
}

std::uint32_t count_tiles(const std::vector<Cell>& cells) {
    return static_cast<std::uint32_t>(
        std::count_if(cells.begin(), cells.end(), [](const Cell& cell) { return cell.child < 0; }));
}

/// Fills NanoVDB's grid header: magic number, version, name, transform, class.
void write_header(const Volume& volume, std::uint64_t bytes, const CoordBBox& box,
                  nanovdb::GridData& data) {
    data.mMagic = NANOVDB_MAGIC_NUMBER;
    data.mChecksum = ~std::uint64_t{0};  // none
    data.mVersion = nanovdb::Version();
    data.setBBoxOn();
    data.setBreadthFirstOn();
    data.mGridCount = 1;
    data.mGridSize = bytes;
    volume.name.copy(data.mGridName, nanovdb::GridData::MaxNameSize - 1);
    const Mat3& linear = volume.world_from_index.linear;
    const Mat3 back = inverse(linear);
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) {
            data.mMap.mMatD[3 * r + c] = linear(r, c);
            data.mMap.mInvMatD[3 * r + c] = back(r, c);
            data.mMap.mMatF[3 * r + c] = static_cast<float>(linear(r, c));
            data.mMap.mInvMatF[3 * r + c] = static_cast<float>(back(r, c));
        }
        data.mMap.mVecD[r] = volume.world_from_index.translation[r];
        data.mMap.mVecF[r] = static_cast<float>(volume.world_from_index.translation[r]);
        data.mVoxelSize[r] = length(linear.column(r));
    }
    data.mMap.mTaperF = 1;
    data.mMap.mTaperD = 1;
    const auto corner = [](const Coord& c, double shift) {
        return Vec3d{c[0] + shift, c[1] + shift, c[2] + shift};
    };
    if (!box.empty()) {
        const Box world =
            transformed(volume.world_from_index, {corner(box.min(), -0.5), corner(box.max(), 0.5)});
        for (int axis = 0; axis < 3; ++axis) {
            data.mWorldBBox[0][axis] = world.lower[axis];
            data.mWorldBBox[1][axis] = world.upper[axis];
        }
    }
    data.mGridClass = nanovdb::GridClass::FogVolume;
    data.mGridType = nanovdb::GridType::Float;
}

}  // namespace

NanoTree nano_tree(const Volume& volume, bool with_border) {
    const Layout layout = lay_out(volume, with_border);

    // NanoVDB's order: grid | tree | root and its table | upper nodes | lower nodes | leaves.
    const std::size_t tree_at = sizeof(nanovdb::GridData);
    const std::size_t root_at = tree_at + sizeof(nanovdb::TreeData<3>);
    const std::size_t uppers_at =
        root_at + NanoRoot::memUsage(static_cast<std::uint32_t>(layout.root_cells.size()));
    const std::size_t lowers_at = uppers_at + layout.uppers.size() * sizeof(NanoUpper);
    const std::size_t leaves_at = lowers_at + layout.lowers.size() * sizeof(NanoLower);
    NanoTree nano{NanoBuffer(leaves_at + layout.leaves.size() * sizeof(NanoLeaf))};
    std::byte* bytes = nano.buffer.data();
    auto& tree = *reinterpret_cast<nanovdb::TreeData<3>*>(bytes + tree_at);
    auto& root = *reinterpret_cast<NanoRoot*>(bytes + root_at);
    auto* uppers = reinterpret_cast<NanoUpper*>(bytes + uppers_at);
    auto* lowers = reinterpret_cast<NanoLower*>(bytes + lowers_at);
    auto* leaves = reinterpret_cast<NanoLeaf*>(bytes + leaves_at);

    // Bottom up, since a node's box is the union of its children's boxes.
    vog::parallel_for(std::size_t{0}, layout.leaves.size(), [&](std::size_t i) {
        write_leaf(*layout.leaves[i], with_border, leaves[i]);
    });
    vog::parallel_for(std::size_t{0}, layout.lowers.size(), [&](std::size_t i) {
        write_node(layout.lowers[i], layout.lower_cells, leaves, lowers[i]);
    });
    vog::parallel_for(std::size_t{0}, layout.uppers.size(), [&](std::size_t i) {
        write_node(layout.uppers[i], layout.upper_cells, lowers, uppers[i]);
    });
    write_root(layout.root_cells, uppers, root);

    const std::size_t first_at[4] = {leaves_at, lowers_at, uppers_at, root_at};
    for (int level = 0; level < 4; ++level) tree.mNodeOffset[level] = first_at[level] - tree_at;
    tree.mNodeCount[0] = static_cast<std::uint32_t>(layout.leaves.size());
    tree.mNodeCount[1] = static_cast<std::uint32_t>(layout.lowers.size());
    tree.mNodeCount[2] = static_cast<std::uint32_t>(layout.uppers.size());
    tree.mTileCount[0] = count_tiles(layout.lower_cells);
    tree.mTileCount[1] = count_tiles(layout.upper_cells);
    tree.mTileCount[2] = count_tiles(layout.root_cells);
    tree.mVoxelCount = count_voxels(layout);
    write_header(volume, nano.buffer.size(), root.bbox(),
                 *reinterpret_cast<nanovdb::GridData*>(bytes));
    return nano;
}

}  // namespace vog::reference
