// level_partition.cpp: one process's part of AMR levels, with the finer leaves that overlap it, and the voxels beside it.
#include <algorithm>
#include <tuple>
#include <utility>

#include "data/levels/arrangement.h"
#include "data/levels/node_occupancy.h"
#include "vog/distributed.h"
#include "vog/volume_io.h"

namespace vog {

namespace {

/// Leaves and tiles of a level that overlap the part.
Volume read_overlap(VolumeReader& reader, const NodeOccupancy& part) {
    return reader.read_where([&](Vec3i origin, std::int32_t edge) {
        return part.meets(reader.world_from_index(), origin, edge);
    });
}

void clear_values(Volume& volume) {
    for (Leaf& leaf : volume.leaves) leaf.value.fill(0);
    for (Tile& tile : volume.tiles) tile.value = 0;
}

/// Empty volumes with the transforms of the readers.
std::vector<Volume> empty_volumes(std::span<VolumeReader> readers) {
    std::vector<Volume> empty(readers.size());
    for (std::size_t n = 0; n < readers.size(); ++n)
        empty[n].world_from_index = readers[n].world_from_index();
    return empty;
}

/// Leaves of a volume, for neighbours that share a face with one.
class LeafFaces {
  public:
    explicit LeafFaces(const Volume& volume) {
        for (const Leaf& leaf : volume.leaves) origins_.push_back(leaf.origin);
        std::ranges::sort(origins_, before);
    }
    /// Whether a node shares a face with a leaf. Of nodes of 4096 voxels, which cost a tile each at most: always.
    bool touch(Vec3i origin, std::int32_t edge) const {
        if (edge > kMostEdge) return true;
        for (int axis = 0; axis < 3; ++axis) {
            const int u = (axis + 1) % 3, v = (axis + 2) % 3;
            for (std::int32_t a = 0; a < edge; a += kLeafEdge)
                for (std::int32_t b = 0; b < edge; b += kLeafEdge) {
                    Vec3i below = origin;
                    below[u] += a, below[v] += b, below[axis] -= kLeafEdge;
                    Vec3i above = below;
                    above[axis] += edge + kLeafEdge;
                    if (holds(below) || holds(above)) return true;
                }
        }
        return false;
    }

  private:
    static constexpr std::int32_t kMostEdge = 128;
    static bool before(Vec3i a, Vec3i b) {
        return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
    }
    bool holds(Vec3i origin) const { return std::ranges::binary_search(origins_, origin, before); }

    std::vector<Vec3i> origins_;
};

}  // namespace

Volume read_beside(VolumeReader& reader, const Volume& part) {
    const LeafFaces faces(part);
    return reader.read_where(
        [&](Vec3i origin, std::int32_t edge) { return faces.touch(origin, edge); });
}

std::vector<Levels> read_level_parts(std::span<VolumeReader> volumes, std::span<VolumeReader> masks,
                                     const VolumePart& part, ValueNotes* notes,
                                     std::vector<Levels>* beside) {
    const std::vector<Volume> empty = empty_volumes(volumes);
    const std::vector<std::size_t> order = finest_first(empty);
    std::vector<Levels> parts;
    const auto with_finer = [&](std::size_t k, Volume own) {
        const NodeOccupancy occupied(own);
        Levels levels;
        for (std::size_t finer = 0; finer < k; ++finer) {
            const std::size_t n = order[finer];
            if (!masks.empty()) {
                // A mask alone hides coarser levels: values are not needed.
                levels.masks.push_back(read_overlap(masks[n], occupied));
                levels.volumes.push_back(empty[n]);
                continue;
            }
            levels.volumes.push_back(read_overlap(volumes[n], occupied));
            clear_values(levels.volumes.back());
        }
        if (!masks.empty()) levels.masks.push_back(read_overlap(masks[order[k]], occupied));
        levels.volumes.push_back(std::move(own));
        return levels;
    };
    for (std::size_t k = 0; k < order.size(); ++k) {
        Volume own = volumes[order[k]].read(part, notes);
        if (own.empty()) continue;
        if (beside) beside->push_back(with_finer(k, read_beside(volumes[order[k]], own)));
        parts.push_back(with_finer(k, std::move(own)));
    }
    return parts;
}

Arrangement arrangement_of(std::span<VolumeReader> volumes) {
    std::vector<VolumeOutline> outlines;
    for (VolumeReader& reader : volumes) {
        const Volume head = reader.read_where([](Vec3i, std::int32_t) { return false; });
        outlines.push_back(
            {head.name, volume_label(head.source, head.name), reader.world_from_index(),
             [&reader](const NodeChoice& choice) { return reader.read_where(choice); }});
    }
    return arrangement_of(outlines);
}

}  // namespace vog
