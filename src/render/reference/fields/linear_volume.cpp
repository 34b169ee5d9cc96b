// linear_volume.cpp: Grids of a field's shares and of its weights.
#include "render/reference/fields/linear_volume.h"

#include "core/parallel.h"
#include "render/reference/fields/field_grid.h"
#include "render/reference/reference.h"
#include "vog/error.h"

namespace vog::reference {

namespace {

VoxelGridOptions checked(VoxelGridOptions voxels) {
    if (voxels.step_voxels == 0)
        throw Error(
            "reference: a step of 0 voxels for a picture by value, whose samples have a spacing: "
            "expected one above 0");
    voxels.interpolation = Interpolation::linear;
    return voxels;
}

/// The volume with other values at its active voxels.
/// leaf_value(leaf, offset), tile_value(tile)
template <class LeafValue, class TileValue>
Volume with_voxel_values(const Volume& volume, const LeafValue& leaf_value,
                         const TileValue& tile_value) {
    Volume made = volume;
    vog::parallel_for(std::size_t{0}, made.leaves.size(), [&](std::size_t l) {
        for (int n = 0; n < kLeafVoxels; ++n)
            if (made.leaves[l].active(n))
                made.leaves[l].value[static_cast<std::size_t>(n)] = leaf_value(l, std::size_t(n));
    });
    for (std::size_t t = 0; t < made.tiles.size(); ++t) made.tiles[t].value = tile_value(t);
    return made;
}

}  // namespace

LinearVolume::LinearVolume(const Volume& volume, const VoxelField& field,
                           const VoxelGridOptions& voxels)
    : density_(voxel_grid(volume, checked(voxels))), background_(field.background) {
    if (is_own(field)) return;
    const VoxelValues& values = field.component[0];
    const double lower = field.lower, range = field.upper > lower ? field.upper - lower : 1;
    const auto share = [&](float value) {
        return static_cast<float>(std::max((double{value} - lower) / range, 0.0));
    };
    const auto grid = [&](const auto& leaf_value, const auto& tile_value) {
        return voxel_grid(with_voxel_values(volume, leaf_value, tile_value), checked(voxels));
    };
    parts_ = Parts{
        lower, range,
        grid([&](std::size_t l, std::size_t n) { return share(values.leaf[l][n]); },
             [&](std::size_t t) { return share(values.tile[t]); }),
        grid([](std::size_t, std::size_t) { return 1.0F; }, [](std::size_t) { return 1.0F; })};
}

}  // namespace vog::reference
