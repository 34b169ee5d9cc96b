// level_partition.cpp: one process's part of AMR levels, with the finer leaves that overlap it.
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

}  // namespace

std::vector<Levels> read_level_parts(std::span<VolumeReader> volumes, std::span<VolumeReader> masks,
                                     const VolumePart& part, ValueNotes* notes) {
    const std::vector<Volume> empty = empty_volumes(volumes);
    const std::vector<std::size_t> order = finest_first(empty);
    std::vector<Levels> parts;
    for (std::size_t k = 0; k < order.size(); ++k) {
        Volume own = volumes[order[k]].read(part, notes);
        if (own.empty()) continue;
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
        parts.push_back(std::move(levels));
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
