// reference_levels.h: Optical depth of one ray through all levels of an adaptive mesh.
#pragma once

#include <optional>
#include <vector>

#include "render/reference/reference.h"
#include "render/reference/reference_grid.h"

namespace vog {

struct LevelGrids::Data {
    struct Level {
        VoxelGrid field;
        std::optional<VoxelGrid> domain;  ///< domain of the level; nothing: its active voxels
    };
    std::vector<Level> levels;  ///< finest first
};

}  // namespace vog

namespace vog::reference {

/// Optical depth along origin + t direction, t >= 0, within a segment, at extinction 1.
double depth_along(const LevelGrids::Data& grids, Vec3d origin, Vec3d direction,
                   Segment within = {});

}  // namespace vog::reference
