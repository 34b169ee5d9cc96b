// tile_division.cpp: parts of tiles by recursion, merged with the leaves of a volume by origin.
#include "io/fields/tile_division.h"

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

#include "core/paging.h"
#include "core/parallel.h"

namespace vog::field_files {

namespace {

using Part = TileDivision::Part;

constexpr auto kOrder = [](const auto& node) {
    return std::tuple(node.origin.x, node.origin.y, node.origin.z);
};

class Divider {
  public:
    explicit Divider(const std::function<bool(Vec3i, std::int32_t)>& varies) : varies_(varies) {}

    /// Returns false where the limit is exceeded.
    bool divide(const Part& part) {
        check_interrupt();
        if (!varies_(part.origin, part.edge)) {
            division.tiles.push_back(part);
            return division.tiles.size() <= kMaxDividedTiles;
        }
        if (part.edge == kLeafEdge) {
            division.leaves.push_back(part);
            return division.leaves.size() <= kMaxDividedVoxels / kLeafVoxels;
        }
        // The children of OpenVDB's nodes: 32^3 tiles of 128 voxels, 16^3 of 8.
        const std::int32_t child = part.edge == 4096 ? 128 : kLeafEdge, count = part.edge / child;
        for (std::int32_t x = 0; x < count; ++x)
            for (std::int32_t y = 0; y < count; ++y)
                for (std::int32_t z = 0; z < count; ++z)
                    if (!divide({part.origin + child * Vec3i{x, y, z}, child, part.tile}))
                        return false;
        return true;
    }

    TileDivision division;

  private:
    const std::function<bool(Vec3i, std::int32_t)>& varies_;
};

/// Where a leaf of the divided volume comes from.
struct LeafOrigin {
    Vec3i origin;
    bool divided = false;   ///< part of a tile
    std::size_t index = 0;  ///< of the leaf, or of the tile
};

std::vector<LeafOrigin> merged(const Volume& volume, const TileDivision& division) {
    std::vector<LeafOrigin> old, parts, all;
    for (const Leaf& leaf : volume.leaves) old.push_back({leaf.origin, false, old.size()});
    for (const Part& part : division.leaves) parts.push_back({part.origin, true, part.tile});
    all.resize(old.size() + parts.size());
    std::ranges::merge(old, parts, all.begin(), {}, kOrder, kOrder);
    return all;
}

Leaf filled_leaf(Vec3i origin, float value) {
    Leaf leaf;
    leaf.origin = origin;
    leaf.mask.fill(~std::uint64_t{0});
    leaf.value.fill(value);
    return leaf;
}

/// Replaces `leaves` by those of `from`: an old one, or `fill` of the value of a tile.
template <class LeafT, class Fill>
void replace(BigVector<LeafT>& leaves, std::span<const LeafOrigin> from, const Fill& fill) {
    BigVector<LeafT> made;
    resize_kept(made, from.size());
    vog::parallel_for(std::size_t{0}, from.size(), [&](std::size_t n) {
        made[n] = from[n].divided ? fill(from[n]) : leaves[from[n].index];
    });
    leaves = std::move(made);
}

}  // namespace

std::optional<TileDivision> divide_tiles(std::span<const Tile> tiles,
                                         const std::function<bool(Vec3i, std::int32_t)>& varies) {
    Divider divider(varies);
    for (std::size_t n = 0; n < tiles.size(); ++n)
        if (!divider.divide({tiles[n].origin, tiles[n].edge, n})) return std::nullopt;
    std::ranges::sort(divider.division.tiles, {}, kOrder);
    std::ranges::sort(divider.division.leaves, {}, kOrder);
    return std::move(divider.division);
}

void apply_division(const TileDivision& division, Volume& volume, std::span<VoxelField> fields) {
    const bool same_tiles = std::ranges::equal(
        division.tiles, volume.tiles, {},
        [](const Part& p) { return std::pair(kOrder(p), p.edge); },
        [](const Tile& t) { return std::pair(kOrder(t), t.edge); });
    if (same_tiles && division.leaves.empty()) return;

    const std::vector<LeafOrigin> from = merged(volume, division);
    for (VoxelField& field : fields)
        for (VoxelValues& values : field.component) {
            replace(values.leaf, from, [&](const LeafOrigin& part) {
                std::array<float, kLeafVoxels> leaf;
                leaf.fill(values.tile[part.index]);
                return leaf;
            });
            std::vector<float> tile;
            for (const Part& part : division.tiles) tile.push_back(values.tile[part.tile]);
            values.tile = std::move(tile);
        }
    replace(volume.leaves, from, [&](const LeafOrigin& part) {
        return filled_leaf(part.origin, volume.tiles[part.index].value);
    });
    std::vector<Tile> tiles;
    for (const Part& part : division.tiles)
        tiles.push_back({part.origin, part.edge, volume.tiles[part.tile].value});
    volume.tiles = std::move(tiles);
}

}  // namespace vog::field_files
