// vog/exposure.h: Extinction of a picture of T that is neither dark nor burnt out.
#pragma once

#include <string>

#include "vog/image.h"

namespace vog {

/// auto_extinction, or the nearest extinction from a quarter of it to four times with which the picture has a mean luminance of 0.40 to 0.55
/// where it shows anything, under kDefaultMap on black (docs/transfer_functions.md, "Extinction").
/// source   file or model that the image shows, for errors; empty: unknown
/// returns  factor on density, > 0; 1 for an image without any T > 0
/// throws   vog::Error as auto_extinction does, beginning with the source
double picture_extinction(const DepthImage& image, const std::string& source = {});

}  // namespace vog
