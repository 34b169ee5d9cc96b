// tile_division.h: tiles of a volume divided into smaller ones and leaves, where a field varies.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "vog/volume.h"
#include "vog/voxel_field.h"

namespace vog::field_files {

/// Nodes that replace the tiles of a volume.
struct TileDivision {
    /// Leaf or tile inside a tile.
    struct Part {
        Vec3i origin;
        std::int32_t edge = 8;  ///< voxels
        std::size_t tile = 0;   ///< index of the divided tile
    };
    std::vector<Part> tiles, leaves;  ///< both sorted by origin
};

/// Most tiles after a division: half a gigabyte.
inline constexpr std::size_t kMaxDividedTiles = std::size_t{1} << 24;

/// Divides tiles until no part varies or it is a leaf of 8^3 voxels.
/// varies   whether a cube of voxels needs parts: least index, edge
/// returns  none if more than kMaxDividedVoxels would lie in leaves, or kMaxDividedTiles be left
std::optional<TileDivision> divide_tiles(
    std::span<const Tile> tiles,
    const std::function<bool(Vec3i origin, std::int32_t edge)>& varies);

/// Replaces the tiles of a volume, and the values of its fields there, by the parts.
void apply_division(const TileDivision& division, Volume& volume, std::span<VoxelField> fields);

}  // namespace vog::field_files
