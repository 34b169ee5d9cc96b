// view_errors.h: errors of a model from thirteen directions at three distances.
#pragma once

#include <string>
#include <vector>

#include "vog/gaussians.h"
#include "vog/volume.h"

namespace vog::test {

/// Errors of one view against the exact integral through voxels of constant value, relative L2 of T.
struct ViewError {
    std::string name;  ///< direction and distance
    double error = 0;  ///< of the model
    double faces = 0;  ///< of the field interpolated linearly between the centres of voxels
};

/// The paper's view first, then both ends of an axis, the others, diagonals of faces and cubes and
/// three more, each at 3, 1.5 and 6 bounding radii of the volume's box with the paper's field of
/// view.
/// size_px  width and height of the images at 1.5 and 3 radii; twice as many at 6, as an image that
///          samples every second voxel measures its own aliasing
std::vector<ViewError> view_errors(const Volume& volume, const Gaussians& model, int size_px);

}  // namespace vog::test
