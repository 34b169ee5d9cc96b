// web_decoder.h: Decoder of the page's encoding, as page/picture/gaussians.js decodes it.
#pragma once

#include "vog/gaussians.h"
#include "web/web_codec.h"

namespace vog::test {

/// Decodes a level to a model in world units.
/// throws  std::runtime_error for a stream that is not the level's
Gaussians decoded(const web::WebLevel& level, const web::WebFrame& frame, float cutoff);

}  // namespace vog::test
