// model_psnr.h: difference of two models' pictures.
#pragma once

#include "render/splat/splat.h"
#include "vog/camera.h"
#include "vog/compare.h"
#include "vog/gaussians.h"
#include "vog/shade.h"

namespace vog::test {

/// PSNR of V, dB, of two models in a view.
inline double psnr(const Gaussians& a, const Gaussians& b, const Camera& camera, int size) {
    DepthImage one = render_splat(a, camera, size, size),
               other = render_splat(b, camera, size, size);
    const double extinction = auto_extinction(one);
    set_extinction(one, extinction), set_extinction(other, extinction);
    return compare(one, other).grey.psnr_db;
}

}  // namespace vog::test
