// view_errors.h: errors of a model from thirteen directions at three distances.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "vog/camera.h"
#include "vog/gaussians.h"
#include "vog/volume.h"

namespace vog::test {

/// A named direction towards the data: azimuth and elevation, rad, as orbit_view.
struct NamedDirection {
    const char* name;
    double azimuth, elevation;
};
/// The paper's view, then both ends of an axis, the others, face and cube diagonals and three more.
std::span<const NamedDirection> directions();

/// Relative L2 of T, [distance][direction], at 1.5, 3 and 6 bounding radii of the volume's box with
/// the paper's field of view.
/// paper_size_px  width and height of the images at 1.5 and 3 radii; twice as many at 6
std::vector<std::vector<double>> view_errors(const Volume& volume, const Gaussians& model,
                                             int paper_size_px);

/// Largest of the errors, and the paper's view among them (3 radii).
struct WorstError {
    double worst = 0, paper = 0;
    std::string view;  ///< name and distance of the worst one
};
WorstError worst_error(const Volume& volume, const Gaussians& model, int paper_size_px);

}  // namespace vog::test
