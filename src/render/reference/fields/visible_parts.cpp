// visible_parts.cpp: fields of levels at the voxels that no finer level hides.
#include "render/reference/fields/visible_parts.h"

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

/// A field of a level at the nodes of its part.
VoxelField field_of_part(const Volume& level, const VoxelField& field, const Volume& part) {
    VoxelField of_part;
    of_part.name = field.name;
    of_part.component.resize(field.component.size());
    for (VoxelValues& values : of_part.component) {
        values.leaf.resize(part.leaves.size());
        values.tile.resize(part.tiles.size());
    }
    vog::parallel_for(std::size_t{0}, part.leaves.size(), [&](std::size_t n) {
        const Vec3i origin = part.leaves[n].origin;
        const std::size_t leaf = index_of(level.leaves, origin);
        const bool whole = leaf < level.leaves.size() && level.leaves[leaf].origin == origin;
        const std::size_t tile = whole ? 0 : tile_around(level, origin);
        for (std::size_t c = 0; c < field.component.size(); ++c)
            if (whole)
                of_part.component[c].leaf[n] = field.component[c].leaf[leaf];
            else
                of_part.component[c].leaf[n].fill(field.component[c].tile[tile]);
    });
    for (std::size_t n = 0; n < part.tiles.size(); ++n) {
        const std::size_t tile = tile_around(level, part.tiles[n].origin);
        for (std::size_t c = 0; c < field.component.size(); ++c)
            of_part.component[c].tile[n] = field.component[c].tile[tile];
    }
    return of_part;
}

}  // namespace

std::optional<VisibleParts> visible_parts(const Levels& levels,
                                          std::span<const VoxelField> fields) {
    // Parts keep the source of their level: its number, meanwhile.
    Levels numbered = levels;
    for (std::size_t n = 0; n < fields.size(); ++n) numbered.volumes[n].source = std::to_string(n);
    Composite mesh = composite(numbered);
    if (mesh.partly_hidden > 0) return std::nullopt;
    VisibleParts parts{std::move(mesh.parts), {}};
    for (Volume& part : parts.volumes) {
        const std::size_t level = std::stoul(part.source);
        part.source = levels.volumes[level].source;
        parts.fields.push_back(field_of_part(levels.volumes[level], fields[level], part));
    }
    return parts;
}

}  // namespace vog::reference
