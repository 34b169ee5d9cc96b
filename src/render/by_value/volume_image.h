// volume_image.h: Pictures of emission and absorption, as renderers draw them.
#pragma once

#include <vector>

#include "vog/image.h"
#include "vog/volume_picture.h"

namespace vog {

/// Premultiplied colour of a pixel, no background: [0, 1].
struct VolumeImage {
    int width = 0, height = 0;  ///< pixels
    std::vector<Rgba>
        pixel;  ///< [height * width] colour times alpha, and alpha = 1 - transmittance
};
/// The picture over a background, as over(light, width, height, background).
inline Image over(const VolumeImage& picture, const Rgba& background) {
    return over(picture.pixel, picture.width, picture.height, background);
}

/// Means count where the Gaussians' density is at least this share of the largest on the ray: less has the error of the
/// splats' polynomials.
inline constexpr double kLeastDensityShare = 1e-3;

}  // namespace vog
