// vdb_info.cpp: summary of the grids of a .vdb file: counts, value ranges, boxes.
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <limits>

#include "io/vdb/vdb_density.h"
#include "io/vdb/vdb_volume.h"
#include "vog/volume_io.h"

namespace vog {

using namespace vdb;

namespace {

/// Smallest and largest active value, by length for vectors; NaN is ignored.
struct Range {
    double min = std::numeric_limits<double>::infinity();
    double max = -std::numeric_limits<double>::infinity();

    template <class Value>
    void include(const Value& value) {
        double number = 0;
        if constexpr (openvdb::VecTraits<Value>::IsVec)
            number = openvdb::Vec3d(value).length();
        else
            number = static_cast<double>(value);
        min = std::fmin(min, number);
        max = std::fmax(max, number);
    }
    static Range join(const Range& a, const Range& b) {
        return {std::fmin(a.min, b.min), std::fmax(a.max, b.max)};
    }
};

template <class GridT>
void count_nodes(const GridT& grid, GridInfo& info) {
    using LeafT = typename GridT::TreeType::LeafNodeType;
    std::vector<const LeafT*> leaves;
    grid.tree().getNodes(leaves);
    info.leaves = leaves.size();
    for (const LeafT* leaf : leaves) info.dense_leaves += leaf->onVoxelCount() == LeafT::SIZE;
    for_each_tile(grid.tree(), [&](Vec3i, std::int32_t edge, const auto&) {
        ++info.active_tiles[edge == 8 ? 0 : edge == 128 ? 1 : 2];
    });
}

template <class GridT>
void find_range(const GridT& grid, GridInfo& info) {
    std::vector<const typename GridT::TreeType::LeafNodeType*> leaves;
    grid.tree().getNodes(leaves);
    Range range = tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, leaves.size()), Range{},
        [&](const auto& part, Range found) {
            for (std::size_t i = part.begin(); i < part.end(); ++i)
                for (auto voxel = leaves[i]->cbeginValueOn(); voxel; ++voxel) found.include(*voxel);
            return found;
        },
        Range::join);
    for_each_tile(grid.tree(),
                  [&](Vec3i, std::int32_t, const auto& value) { range.include(value); });
    if (range.min > range.max) return;  // no active value, or only NaN
    info.min = range.min;
    info.max = range.max;
}

}  // namespace

void vdb::describe_grid(const openvdb::GridBase& grid, GridInfo& info) {
    info.active_voxels = grid.activeVoxelCount();
    info.memory_bytes += grid.memUsage();
    grid.apply<KnownGrids>([&](const auto& typed) {
        count_nodes(typed, info);
        if (info.type != "points") find_range(typed, info);
    });
    if (info.active_voxels == 0) return;

    const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
    info.lower = {box.min().x(), box.min().y(), box.min().z()};
    info.upper = {box.max().x(), box.max().y(), box.max().z()};
    const Vec3d half{0.5, 0.5, 0.5};
    if (info.affine)
        info.world = transformed(info.world_from_index, {vec_cast<double>(info.lower) - half,
                                                         vec_cast<double>(info.upper) + half});
}

std::vector<GridInfo> inspect_vdb(const std::filesystem::path& path) {
    openvdb::initialize();
    VdbFile file(path);
    std::vector<GridInfo> infos;
    for (const VdbEntry& entry : file.entries()) {
        const LoadedGrid loaded = load_grid(file, entry);
        GridInfo info;
        info.name = entry.name;
        info.type = short_type(entry.tree_type);
        info.grid_class = loaded.head.grid_class;
        info.half_stored = entry.half_stored;
        info.points = loaded.points;
        info.affine = loaded.head.world_from_index.has_value();
        if (info.affine) info.world_from_index = *loaded.head.world_from_index;
        info.memory_bytes = loaded.point_bytes;
        if (loaded.grid)
            with_vdb_errors(file.where(entry), [&] { describe_grid(*loaded.grid, info); });
        infos.push_back(info);
    }
    return infos;
}

}  // namespace vog
