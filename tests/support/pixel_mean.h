// pixel_mean.h: a Gaussian as renderers draw it, by docs/method.md, "Gaussians smaller than a
// pixel", with 3x3 matrices in double precision: no renderer computes it this way.
#pragma once

#include "vog/camera.h"
#include "vog/gaussians.h"

namespace vog::test {

struct PixelMean {
    Mat3 w;              ///< whitening, of the widened Gaussian where it is thin
    double density = 0;  ///< peak, at the mass of the Gaussian
    bool widened = false;
};
PixelMean pixel_mean(const Gaussians& model, std::size_t i, const CameraFrame& frame);

}  // namespace vog::test
