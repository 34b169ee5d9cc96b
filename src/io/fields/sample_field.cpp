// sample_field.cpp: fields in memory as OpenVDB grids, sampled like those of files.
#include <fmt/core.h>
#include <openvdb/tools/ChangeBackground.h>

#include <algorithm>
#include <cstdlib>
#include <type_traits>

#include "core/parallel.h"
#include "io/fields/field_sampler.h"
#include "vog/error.h"
#include "vog/openvdb.h"
#include "vog/text.h"

namespace vog {

using namespace field_files;

namespace {

/// Largest index, as of volumes.
constexpr std::int64_t kMostIndex = std::int64_t{1} << 30;

/// throws vog::Error for a box without voxels or beyond the indices of volumes
void check(const FieldBlock& block, const std::string& where) {
    for (int axis = 0; axis < 3; ++axis) {
        const std::int64_t first = block.first[axis], last = first + block.size[axis] - 1;
        if (block.size[axis] < 1 || first < -kMostIndex || last > kMostIndex)
            throw Error(fmt::format(
                "{}: voxels {} to {} along axis {}, expected at least one, within +-2^30", where,
                first, last, axis));
    }
}

/// Value of the grid's type at voxel `at` of a block.
template <class Value>
Value value_at(const FieldBlock& block, Vec3i at) {
    const float* voxel =
        block.value + at.x * block.stride[0] + at.y * block.stride[1] + at.z * block.stride[2];
    if constexpr (std::is_same_v<Value, float>)
        return *voxel;
    else
        return {voxel[0], voxel[block.stride[3]], voxel[2 * block.stride[3]]};
}

template <class GridT>
void copy_block(const FieldBlock& block, GridT& grid) {
    const Vec3i first = block.first, last = first + block.size - Vec3i{1, 1, 1};
    const auto leaf_of = [](std::int32_t i) { return i & ~(kLeafEdge - 1); };
    for (int x = leaf_of(first.x); x <= last.x; x += kLeafEdge)
        for (int y = leaf_of(first.y); y <= last.y; y += kLeafEdge)
            for (int z = leaf_of(first.z); z <= last.z; z += kLeafEdge) {
                check_interrupt();
                auto* leaf = grid.tree().touchLeaf(openvdb::Coord(x, y, z));
                for (openvdb::Index n = 0; n < kLeafVoxels; ++n) {
                    const auto i = static_cast<int>(n);
                    const Vec3i at = Vec3i{x + (i >> 6), y + (i >> 3 & 7), z + (i & 7)} - first;
                    bool inside = true;
                    for (int axis = 0; axis < 3; ++axis)
                        inside = inside && at[axis] >= 0 && at[axis] < block.size[axis];
                    if (inside) leaf->setValueOn(n, value_at<typename GridT::ValueType>(block, at));
                }
            }
}

template <class GridT>
openvdb::GridBase::Ptr grid_of(const FieldValues& field) {
    const auto grid = GridT::create();
    for (const FieldBlock& block : field.blocks) copy_block(block, *grid);
    return grid;
}

/// throws vog::Error for a volume without voxels
void require_voxels(const Volume& volume, const std::string& where) {
    if (volume.empty()) throw Error(where + ": of a volume without active voxels");
}

std::string place(const std::string& name) { return fmt::format("field '{}'", printable(name)); }

}  // namespace

VoxelField sample_field(const FieldValues& field, Volume& volume, std::span<VoxelField> others,
                        std::vector<std::string>* notes) {
    FieldGrid grid;
    grid.where = place(field.name);
    require_voxels(volume, grid.where);
    if (field.components != 1 && field.components != 3)
        throw Error(
            fmt::format("{}: {} components, expected 1 or 3", grid.where, field.components));
    for (const FieldBlock& block : field.blocks) check(block, grid.where);
    openvdb::initialize();
    grid.grid = field.components == 1 ? grid_of<openvdb::FloatGrid>(field)
                                      : grid_of<openvdb::Vec3SGrid>(field);
    grid.world_from_index = field.world_from_index;
    grid.name = field.name;
    grid.unit = field.unit;
    return sampled_field(grid, volume, others, notes);
}

VoxelField sample_field(const Volume& field, const std::string& name, Volume& volume,
                        std::span<VoxelField> others, std::vector<std::string>* notes) {
    FieldGrid grid;
    grid.where = place(name);
    require_voxels(volume, grid.where);
    openvdb::initialize();
    const openvdb::FloatGrid::Ptr values = grid_from_volume(field);
    if (const auto background = static_cast<float>(field.background); background != 0) {
        for (auto value = values->beginValueOn(); value; ++value)
            value.setValue(*value + background);
        openvdb::tools::changeBackground(values->tree(), background);
    }
    grid.grid = values;
    grid.world_from_index = field.world_from_index;
    grid.length_unit = field.units.length;
    grid.name = name;
    return sampled_field(grid, volume, others, notes);
}

}  // namespace vog
