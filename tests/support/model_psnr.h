// model_psnr.h: differences of pictures of models.
#pragma once

#include <cmath>

#include "render/by_value/volume_image.h"
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

/// PSNR of premultiplied colours, dB.
inline double psnr(const VolumeImage& a, const VolumeImage& b) {
    double sum = 0;
    for (std::size_t n = 0; n < a.pixel.size(); ++n)
        for (const float d : {a.pixel[n].r - b.pixel[n].r, a.pixel[n].g - b.pixel[n].g,
                              a.pixel[n].b - b.pixel[n].b})
            sum += double{d} * double{d};
    return -10 * std::log10(sum / (3.0 * double(a.pixel.size())));
}

}  // namespace vog::test
