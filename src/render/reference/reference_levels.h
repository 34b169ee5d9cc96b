// reference_levels.h: one ray through all levels of an adaptive mesh.
#pragma once

#include <optional>
#include <vector>

#include "render/reference/reference_grid.h"

namespace vog {

struct LevelGrids::Data {
    struct Level {
        VoxelGrid field;
        std::optional<VoxelGrid> domain;  ///< where the level counts, if not where it is active
    };
    std::vector<Level> levels;  ///< finest first
};

}  // namespace vog

namespace vog::reference {

double depth_along(const LevelGrids::Data& grids, Vec3d origin, Vec3d direction);

}  // namespace vog::reference
