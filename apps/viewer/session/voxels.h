// voxels.h: the data themselves, ready to be drawn as ground truth.
#pragma once

#include <functional>

#include "vog/camera.h"
#include "vog/image.h"
#include "vog/progress.h"

namespace vog::viewer {

/// T of the voxels at extinction 1: one grid, several that add up, or levels of a mesh.
struct Voxels {
    std::function<DepthImage(const Camera& camera, int width, int height, const Progress& progress)>
        draw;
};

}  // namespace vog::viewer
