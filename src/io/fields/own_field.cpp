// own_field.cpp: a volume's own values as a field.
#include "vog/voxel_field.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/paging.h"
#include "core/parallel.h"

namespace vog {

VoxelField own_field(const Volume& volume, const std::string& name) {
    VoxelField field;
    field.name = name.empty() ? volume.name : name;
    VoxelValues& values = field.component.emplace_back();
    float lower = std::numeric_limits<float>::infinity(), upper = -lower;
    const auto include = [&](float value) {
        lower = std::min(lower, value);
        upper = std::max(upper, value);
    };
    resize_kept(values.leaf, volume.leaves.size());
    for (std::size_t n = 0; n < volume.leaves.size(); ++n) {
        check_interrupt();
        const Leaf& leaf = volume.leaves[n];
        for (int offset = 0; offset < kLeafVoxels; ++offset) {
            if (!leaf.active(offset)) continue;
            const auto at = static_cast<std::size_t>(offset);
            include(values.leaf[n][at] = leaf.value[at]);
        }
    }
    for (const Tile& tile : volume.tiles) include(values.tile.emplace_back(tile.value));
    if (lower <= upper) field.lower = double{lower}, field.upper = double{upper};
    return field;
}

}  // namespace vog
