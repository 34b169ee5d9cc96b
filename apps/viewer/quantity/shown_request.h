// shown_request.h: The window's picture as a request of the library, for copies and files of pictures.
#pragma once

#include "quantity/look.h"
#include "quantity/quantity.h"
#include "vog/picture.h"

namespace vog::viewer {

/// Request of a shown picture.
/// scale     of quantities that have one
/// transfer  of volume
PictureRequest request_of(const Quantity& quantity, const Look& look, const Camera& camera,
                          const ColorScale& scale, const ValueTransfer* transfer, int width,
                          int height);

}  // namespace vog::viewer
