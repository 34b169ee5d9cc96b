// request_effects.h: members of a request that a renderer has no use for.
#pragma once

#include <optional>

#include "vog/picture.h"

namespace vog {

/// throws  RequestError for a member that changes nothing of what this renderer draws of this data
void require_renderer_effects(const PictureRequest& request, Renderer renderer,
                              std::optional<RenderInput> input);

}  // namespace vog
