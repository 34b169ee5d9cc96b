// field_grid.cpp: Nodes and neighbours of a volume with a field.
#include "render/reference/fields/field_grid.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "vog/error.h"

namespace vog::reference {

namespace {

bool before(Vec3i a, Vec3i b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }
/// Index of the node with this origin among nodes sorted by origin; their number where there is none.
template <class Nodes>
std::size_t place_of(const Nodes& nodes, Vec3i origin) {
    const auto found =
        std::lower_bound(nodes.begin(), nodes.end(), origin,
                         [](const auto& node, Vec3i at) { return before(node.origin, at); });
    const bool same = found != nodes.end() && found->origin == origin;
    return same ? static_cast<std::size_t>(found - nodes.begin()) : nodes.size();
}

Vec3i aligned(Vec3i index, std::int32_t edge) {
    return {index.x & ~(edge - 1), index.y & ~(edge - 1), index.z & ~(edge - 1)};
}

/// throws vog::Error for a field that is not of this volume, or lacks the part
void check(const Volume& volume, const VoxelField& field, FieldPart part, const char* renderer) {
    if (field.is_vector() != (part != FieldPart::value) || field.component.empty())
        throw Error(fmt::format("{}: field '{}' has {} components, expected {}", renderer,
                                field.name, field.component.size(),
                                part == FieldPart::value ? 1 : 3));
    if (is_own(field)) return;
    for (const VoxelValues& values : field.component)
        if (values.leaf.size() != volume.leaves.size() || values.tile.size() != volume.tiles.size())
            throw Error(fmt::format(
                "{}: field '{}' has {} leaves and {} tiles, expected the volume's {} and {}",
                renderer, field.name, values.leaf.size(), values.tile.size(), volume.leaves.size(),
                volume.tiles.size()));
}

}  // namespace

bool is_own(const VoxelField& field) {
    return field.component.size() == 1 && field.component[0].leaf.empty() &&
           field.component[0].tile.empty();
}

void check_fields(std::span<const Volume> volumes, std::span<const VoxelField> fields,
                  FieldPart part, const char* renderer) {
    if (volumes.size() != fields.size())
        throw Error(fmt::format("{}: {} volumes and {} fields, expected one for each", renderer,
                                volumes.size(), fields.size()));
    for (std::size_t n = 0; n < volumes.size(); ++n) check(volumes[n], fields[n], part, renderer);
}

FieldGrid::FieldGrid(const Volume& volume, const VoxelField& field, FieldPart part)
    : volume_(volume),
      field_(field),
      part_(part),
      own_(is_own(field)),
      grid_(voxel_grid_of_part(volume)) {
    // NanoVDB has the leaves in an order of its own.
    const auto& tree = grid_.data().tree.grid().tree();
    const std::uint32_t count = tree.nodeCount(0);
    if (count > 0) leaves_ = tree.getFirstNode<0>();
    for (std::uint32_t n = 0; n < count; ++n) {
        const auto origin = leaves_[n].origin();
        leaf_index_.push_back(place_of(volume.leaves, Vec3i{origin[0], origin[1], origin[2]}));
    }
}

Vec3i FieldGrid::tile_origin(Vec3d lower) const {
    const Vec3d corner = lower + grid_.data().corner;
    return {static_cast<std::int32_t>(std::llround(corner.x)),
            static_cast<std::int32_t>(std::llround(corner.y)),
            static_cast<std::int32_t>(std::llround(corner.z))};
}

double FieldGrid::tile_value(Vec3d towards, Vec3i origin, double density) const {
    if (own_) return density + field_.background;
    const std::size_t index = place_of(volume_.tiles, origin);
    return shown(towards, [&](std::size_t c) { return field_.component[c].tile[index]; });
}

double FieldGrid::neighbour(Vec3i index, double otherwise) const {
    const nanovdb::Coord coord(index.x, index.y, index.z);
    const auto& tree = grid_.data().tree.grid().tree();
    if (beside_ && !tree.isActive(coord)) return beside_->neighbour(index, otherwise);
    if (own_) return double{tree.getValue(coord)} + field_.background;
    if (!tree.isActive(coord)) return otherwise;
    const std::size_t leaf = place_of(volume_.leaves, aligned(index, kLeafEdge));
    if (leaf < volume_.leaves.size()) {
        const int offset = leaf_offset(index.x & 7, index.y & 7, index.z & 7);
        return double{field_.component[0].leaf[leaf][static_cast<std::size_t>(offset)]};
    }
    for (const std::int32_t edge : {8, 128, 4096})
        if (const std::size_t tile = place_of(volume_.tiles, aligned(index, edge));
            tile < volume_.tiles.size() && volume_.tiles[tile].edge == edge)
            return double{field_.component[0].tile[tile]};
    return otherwise;
}

Vec3d FieldGrid::gradient(const FieldCell& cell) const {
    if (cell.tile) return {};
    Vec3d per_voxel;
    for (int axis = 0; axis < 3; ++axis) {
        Vec3i ahead = cell.index, behind = cell.index;
        ++ahead[axis], --behind[axis];
        per_voxel[axis] = (neighbour(ahead, cell.value) - neighbour(behind, cell.value)) / 2;
    }
    return transpose(grid_.data().local_from_world) * per_voxel;
}

std::vector<FieldGrid> field_grids(std::span<const Volume> volumes,
                                   std::span<const VoxelField> fields, FieldPart part) {
    check_fields(volumes, fields, part);
    std::vector<FieldGrid> grids;
    grids.reserve(volumes.size());
    for (std::size_t n = 0; n < volumes.size(); ++n)
        grids.emplace_back(volumes[n], fields[n], part);
    return grids;
}

}  // namespace vog::reference
