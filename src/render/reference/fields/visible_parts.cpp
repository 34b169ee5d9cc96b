// visible_parts.cpp: fields of levels at the voxels that no finer level hides.
#include "render/reference/fields/visible_parts.h"

#include <array>
#include <cmath>
#include <string>

#include "core/parallel.h"

namespace vog::reference {

namespace {

/// Place of the tile that holds a node.
std::size_t tile_around(const Volume& level, Vec3i origin) {
    for (const int edge : {8, 128, 4096}) {
        const Vec3i corner{origin.x & ~(edge - 1), origin.y & ~(edge - 1), origin.z & ~(edge - 1)};
        const std::size_t n = index_of(level.tiles, corner);
        if (n < level.tiles.size() && level.tiles[n].origin == corner &&
            level.tiles[n].edge == edge)
            return n;
    }
    return 0;  // not for nodes of the level
}

/// A component of a field at a voxel of a level.
float value_at(const Volume& level, const VoxelValues& values, Vec3i voxel) {
    const Vec3i origin{voxel.x & -kLeafEdge, voxel.y & -kLeafEdge, voxel.z & -kLeafEdge};
    const std::size_t leaf = index_of(level.leaves, origin);
    if (leaf == level.leaves.size() || !(level.leaves[leaf].origin == origin))
        return values.tile[tile_around(level, voxel)];
    const int offset = leaf_offset(voxel.x & 7, voxel.y & 7, voxel.z & 7);
    return values.leaf[leaf][static_cast<std::size_t>(offset)];
}

/// Fills the leaf of a part whose voxels are pieces of those of its level: `pieces` along each edge.
void fill_pieces(const Volume& level, const VoxelValues& values, int pieces, const Leaf& leaf,
                 std::array<float, kLeafVoxels>& to) {
    const auto whole = [&](std::int32_t piece) {
        return static_cast<std::int32_t>(std::floor(static_cast<double>(piece) / pieces));
    };
    to.fill(0);
    for (int n = 0; n < kLeafVoxels; ++n)
        if (leaf.active(n)) {
            const Vec3i piece = leaf.origin + Vec3i{n >> 6, n >> 3 & 7, n & 7};
            to[static_cast<std::size_t>(n)] =
                value_at(level, values, {whole(piece.x), whole(piece.y), whole(piece.z)});
        }
}

/// A field of a level at the nodes of its part.
VoxelField field_of_part(const Volume& level, const VoxelField& field, const Volume& part) {
    VoxelField of_part;
    of_part.name = field.name;
    of_part.component.resize(field.component.size());
    for (VoxelValues& values : of_part.component) {
        values.leaf.resize(part.leaves.size());
        values.tile.resize(part.tiles.size());
    }
    // Cut voxels are divided into pieces, which are leaves alone.
    const auto pieces =
        static_cast<int>(std::lround(std::cbrt(voxel_volume(level) / voxel_volume(part))));
    vog::parallel_for(std::size_t{0}, part.leaves.size(), [&](std::size_t n) {
        const Vec3i origin = part.leaves[n].origin;
        const std::size_t leaf = index_of(level.leaves, origin);
        const bool whole = leaf < level.leaves.size() && level.leaves[leaf].origin == origin;
        const std::size_t tile = whole || pieces > 1 ? 0 : tile_around(level, origin);
        for (std::size_t c = 0; c < field.component.size(); ++c) {
            const VoxelValues& from = field.component[c];
            if (pieces > 1)
                fill_pieces(level, from, pieces, part.leaves[n], of_part.component[c].leaf[n]);
            else if (whole)
                of_part.component[c].leaf[n] = from.leaf[leaf];
            else
                of_part.component[c].leaf[n].fill(from.tile[tile]);
        }
    });
    for (std::size_t n = 0; n < part.tiles.size(); ++n) {
        const std::size_t tile = tile_around(level, part.tiles[n].origin);
        for (std::size_t c = 0; c < field.component.size(); ++c)
            of_part.component[c].tile[n] = field.component[c].tile[tile];
    }
    return of_part;
}

Composite numbered_composite(const Levels& levels) {
    // Parts keep the source of their level: its number, meanwhile.
    Levels numbered = levels;
    for (std::size_t n = 0; n < numbered.volumes.size(); ++n)
        numbered.volumes[n].source = std::to_string(n);
    return composite(numbered);
}

VisibleParts with_fields(Composite mesh, const Levels& levels, std::span<const VoxelField> fields) {
    VisibleParts parts{std::move(mesh.parts), {}};
    for (Volume& part : parts.volumes) {
        const std::size_t level = std::stoul(part.source);
        part.source = levels.volumes[level].source;
        parts.fields.push_back(field_of_part(levels.volumes[level], fields[level], part));
    }
    return parts;
}

}  // namespace

std::optional<VisibleParts> visible_parts(const Levels& levels,
                                          std::span<const VoxelField> fields) {
    Composite mesh = numbered_composite(levels);
    if (mesh.partly_hidden > 0) return std::nullopt;
    return with_fields(std::move(mesh), levels, fields);
}

VisibleParts weighted_parts(const Levels& levels, std::span<const VoxelField> fields) {
    return with_fields(numbered_composite(levels), levels, fields);
}

}  // namespace vog::reference
