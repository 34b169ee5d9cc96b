// error_shares.h: errors of a picture's pixels, divided among the Gaussians on their rays.
#pragma once

#include <functional>
#include <span>

#include "vog/camera.h"
#include "vog/gaussians.h"
#include "vog/image.h"

namespace vog::comparison {

/// Adds to each Gaussian its part of a picture's squared errors: every pixel's is divided among the Gaussians by their
/// share of T. Footprints are approximated by circles with the mean variance.
/// errors  [N]
/// depth   T of the model from the camera
/// error2  squared error of the pixel in a column and row, called by several threads
void add_error_shares(std::span<float> errors, const Gaussians& model, const Camera& camera,
                      const DepthImage& depth, const std::function<double(int, int)>& error2);

}  // namespace vog::comparison
