// arrangement.cpp: Whether volumes are levels of one mesh, parts side by side, or neither.
#include "data/levels/arrangement.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <unordered_set>
#include <vector>

#include "data/levels/node_occupancy.h"
#include "data/levels/voxel_lookup.h"
#include "vog/linear.h"

namespace vog {

namespace {

using Node = NodeOccupancy::Node;

constexpr double kHalf = 0.5;

/// Outline with its nodes.
struct Outlined {
    const VolumeOutline* outline;
    std::vector<Node> nodes;
    Box index_box, world_box;  ///< around all nodes, to the outer faces of their voxels
};

Box box_of(const Node& node) {
    const Vec3d lower = vec_cast<double>(node.origin) - Vec3d{kHalf, kHalf, kHalf};
    const double edge = node.edge;
    return {lower, lower + Vec3d{edge, edge, edge}};
}

Outlined outlined(const VolumeOutline& outline) {
    Outlined result{&outline, {}, {}, {}};
    (void)outline.read_where([&](Vec3i origin, std::int32_t edge) {
        result.nodes.push_back({origin, edge});
        return false;
    });
    for (const Node& node : result.nodes) {
        const Box box = box_of(node);
        result.index_box.include(box.lower);
        result.index_box.include(box.upper);
    }
    if (!result.nodes.empty())
        result.world_box = transformed(outline.world_from_index, result.index_box);
    return result;
}

/// Grid name without its digits: 'density_L0' and 'density_L1' name levels of one quantity.
std::string without_digits(std::string name) {
    std::erase_if(name, [](unsigned char c) { return std::isdigit(c) != 0; });
    return name;
}

bool apart(const Box& a, const Box& b) {
    for (int axis = 0; axis < 3; ++axis)
        if (a.upper[axis] <= b.lower[axis] || b.upper[axis] <= a.lower[axis]) return true;
    return false;
}

/// Whether a lattice divides the voxels of another into whole numbers of its own along parallel
/// axes, with faces on faces.
/// box  region of the finer lattice where faces are compared, index space
bool divides(const Affine& world_from_fine, const Box& box, const Affine& world_from_coarse) {
    // Deviation of faces that counts as rounding, fine voxels: transforms are often float32.
    constexpr double kRounding = 0.05;
    const Affine coarse_from_world = inverse(world_from_coarse);
    const Affine coarse_from_fine{coarse_from_world.linear * world_from_fine.linear,
                                  coarse_from_world(world_from_fine.translation)};
    for (int row = 0; row < 3; ++row) {
        const Vec3d edges = coarse_from_fine.linear.row[row];  // fine edges in coarse voxels
        int along = 0;
        for (int axis = 1; axis < 3; ++axis)
            if (std::abs(edges[axis]) > std::abs(edges[along])) along = axis;
        const double ratio = std::round(1 / std::abs(edges[along]));
        if (!(ratio >= 1)) return false;
        for (const Vec3d& corner : {box.lower, box.upper})
            for (int axis = 0; axis < 3; ++axis)
                if (axis != along && std::abs(edges[axis] * corner[axis] * ratio) > kRounding)
                    return false;
        for (const double face : {box.lower[along], box.upper[along]}) {
            const double at =
                ratio * (edges[along] * face + coarse_from_fine.translation[row] + kHalf);
            if (std::abs(at - std::round(at)) > kRounding) return false;
        }
    }
    return true;
}

/// Whether an active voxel of a leaf of `a` has its centre in an active voxel of `b`.
bool leaf_voxel_inside(const Volume& a, const Volume& b) {
    const VoxelLookup lookup(b);
    const Affine b_from_world = inverse(b.world_from_index);
    for (const Leaf& leaf : a.leaves)
        for (int n = 0; n < kLeafVoxels; ++n) {
            if (!leaf.active(n)) continue;
            const Vec3i index = leaf.origin + Vec3i{n >> 6, n >> 3 & 7, n & 7};
            const Vec3d at = b_from_world(a.world_from_index(vec_cast<double>(index)));
            if (lookup.active({static_cast<std::int32_t>(std::floor(at.x + kHalf)),
                               static_cast<std::int32_t>(std::floor(at.y + kHalf)),
                               static_cast<std::int32_t>(std::floor(at.z + kHalf))}))
                return true;
        }
    return false;
}

/// Whether a tile of `a` overlaps a tile of `b` by more than rounding.
bool tiles_overlap(const Volume& a, const Volume& b) {
    constexpr double kTouching = 1e-3;  // voxels
    const Affine b_from_world = inverse(b.world_from_index);
    const Affine b_from_a{b_from_world.linear * a.world_from_index.linear,
                          b_from_world(a.world_from_index.translation)};
    const Vec3d shrink{kTouching, kTouching, kTouching};
    for (const Tile& one : a.tiles) {
        const Box box = transformed(b_from_a, box_of({one.origin, one.edge}));
        const Box inner{box.lower + shrink, box.upper - shrink};
        for (const Tile& other : b.tiles)
            if (!apart(inner, box_of({other.origin, other.edge}))) return true;
    }
    return false;
}

/// Whether active voxels of two volumes overlap: the centre of one lies in another.
bool overlap(const Outlined& a, const Outlined& b) {
    if (a.nodes.empty() || b.nodes.empty() || apart(a.world_box, b.world_box)) return false;
    const NodeOccupancy there(b.outline->world_from_index, b.nodes);
    std::vector<Node> shared;
    for (const Node& node : a.nodes)
        if (there.meets(a.outline->world_from_index, node.origin, node.edge))
            shared.push_back(node);
    // Batches of 8 MiB: most volumes that overlap do so in the first.
    constexpr std::size_t kBatch = 4096;
    const auto key = [](Vec3i v) { return fmt::format("{},{},{}", v.x, v.y, v.z); };
    for (std::size_t first = 0; first < shared.size(); first += kBatch) {
        std::unordered_set<std::string> batch;
        for (std::size_t n = first; n < std::min(first + kBatch, shared.size()); ++n)
            batch.insert(key(shared[n].origin));
        const Volume here = a.outline->read_where(
            [&](Vec3i origin, std::int32_t) { return batch.contains(key(origin)); });
        const NodeOccupancy occupied(here);
        const Volume other = b.outline->read_where([&](Vec3i origin, std::int32_t edge) {
            return occupied.meets(b.outline->world_from_index, origin, edge);
        });
        if (leaf_voxel_inside(here, other) || leaf_voxel_inside(other, here) ||
            tiles_overlap(here, other))
            return true;
    }
    return false;
}

/// Whether a volume fits the lattices of coarser ones and lies within the box around them.
bool nested(const Outlined& fine, std::span<const Outlined> coarser) {
    Box around;
    for (const Outlined& one : coarser) {
        if (!divides(fine.outline->world_from_index, fine.index_box, one.outline->world_from_index))
            return false;
        around.include(one.world_box);
    }
    // Boxes are of whole leaves: one of the finer level may end up to a leaf beyond its voxels.
    const auto& linear = fine.outline->world_from_index.linear;
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3d row = linear.row[axis];
        const double leaf = kLeafEdge * (std::abs(row.x) + std::abs(row.y) + std::abs(row.z));
        if (fine.world_box.lower[axis] < around.lower[axis] - leaf ||
            fine.world_box.upper[axis] > around.upper[axis] + leaf)
            return false;
    }
    return true;
}

}  // namespace

Arrangement arrangement_of(std::span<const VolumeOutline> outlines) {
    using enum Arrangement::Kind;
    for (const VolumeOutline& one : outlines)
        if (without_digits(one.name) != without_digits(outlines.front().name))
            return {quantities, fmt::format("{} and {} are different quantities",
                                            outlines.front().label, one.label)};
    std::vector<Volume> lattices(outlines.size());
    for (std::size_t n = 0; n < outlines.size(); ++n)
        lattices[n].world_from_index = outlines[n].world_from_index;
    std::vector<Outlined> volumes;  // finest first
    std::vector<double> sizes;
    for (const std::size_t n : finest_first(lattices)) {
        volumes.push_back(outlined(outlines[n]));
        sizes.push_back(voxel_volume(lattices[n]));
    }
    const auto end_of_level = [&](std::size_t first) {
        std::size_t last = first + 1;
        while (last < sizes.size() && same_voxel_volume(sizes[first], sizes[last])) ++last;
        return last;
    };
    std::size_t level_count = 0, on_others = 0;
    for (std::size_t first = 0, last = 0; first < volumes.size(); first = last, ++level_count) {
        last = end_of_level(first);
        const std::span<const Outlined> coarser(volumes.begin() + static_cast<std::ptrdiff_t>(last),
                                                volumes.end());
        for (std::size_t n = first; n < last; ++n) {
            for (std::size_t other = n + 1; other < last; ++other)
                if (overlap(volumes[n], volumes[other]))
                    return {overlapping,
                            fmt::format("{} and {} have voxels of the same size at the same place: "
                                        "they are not levels of one mesh",
                                        volumes[n].outline->label, volumes[other].outline->label)};
            if (coarser.empty()) continue;
            if (nested(volumes[n], coarser)) {
                ++on_others;
                continue;
            }
            for (const Outlined& other : coarser)
                if (overlap(volumes[n], other))
                    return {overlapping,
                            fmt::format("{} and {} overlap, but the finer voxels are not nested in "
                                        "the coarser ones: they are not levels of one mesh",
                                        volumes[n].outline->label, other.outline->label)};
        }
    }
    if (on_others == 0)
        return {parts, fmt::format("{} volumes are parts side by side: they do not overlap",
                                   volumes.size())};
    return {
        Arrangement::Kind::levels,
        fmt::format("{} volumes are {} levels of one mesh: the finest counts where they overlap",
                    volumes.size(), level_count)};
}

Arrangement arrangement_of(const Levels& levels) {
    validate(levels);
    std::vector<VolumeOutline> outlines;
    for (const Volume& volume : levels.volumes)
        outlines.push_back(
            {volume.name, volume_label(volume.source, volume.name), volume.world_from_index,
             [&volume](const NodeChoice& choice) { return nodes_where(volume, choice); }});
    return arrangement_of(outlines);
}

std::string volume_label(const std::string& source, const std::string& name) {
    return source.empty() ? fmt::format("'{}'", name) : fmt::format("{} '{}'", source, name);
}

}  // namespace vog
