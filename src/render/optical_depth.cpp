// optical_depth.cpp: Optical depth of one Gaussian along one ray in closed form, double precision
// (docs/method.md, "One Gaussian along a ray"). Every renderer is tested against it.
#include <numbers>

#include "render/ray_gaussian.h"
#include "render/splat/splat.h"

namespace vog {

double optical_depth(const Gaussians& gaussians, std::size_t i, Vec3d origin, Vec3d direction) {
    const Mat3 w = whitening(gaussians, i);
    const Vec3d e = w * (vec_cast<double>(gaussians.mean[i]) - (origin - gaussians.origin));
    const Vec3d d = w * normalized(direction);
    return gaussians.density[i] * segment_integral(e, d, double{gaussians.cutoff});
}

}  // namespace vog
