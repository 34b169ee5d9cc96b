// view_errors.h: errors of a model from thirteen directions at three distances.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "vog/camera.h"
#include "vog/gaussians.h"
#include "vog/image.h"
#include "vog/volume.h"

namespace vog::test {

/// Camera, and T of the exact integral through voxels of constant value.
struct ExactView {
    std::string name;  ///< direction and distance
    Camera camera;
    DepthImage exact;
    /// Relative L2 of the field interpolated linearly between the centres of voxels.
    double faces = 0;
};
struct ExactViewOptions {
    /// Width and height of the images; twice as many at 6 radii, as an image that samples every second voxel measures
    /// its own aliasing.
    int size_px = 96;
    int samples = 1;            ///< ReferenceOptions::samples: means over pixels
    bool faces = true;          ///< whether ExactView::faces is measured
    bool orthographic = false;  ///< parallel rays, of all the data, in place of the three distances
};
/// The paper's view first, then both ends of an axis, the others, diagonals of faces and cubes and
/// three more, each at 3, 1.5 and 6 bounding radii of the volume's box with the paper's field of
/// view.
std::vector<ExactView> exact_views(const Volume& volume, const ExactViewOptions& options = {});

/// Relative L2 of a model's T in each view.
std::vector<double> view_errors(std::span<const ExactView> views, const Gaussians& model);

}  // namespace vog::test
