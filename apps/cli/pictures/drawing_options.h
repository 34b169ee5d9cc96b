// drawing_options.h: inputs of vog render, and the renderer that draws them.
#pragma once

#include <string>
#include <vector>

#include "files/inputs.h"
#include "vog/picture.h"

namespace vog::cli {

struct DrawingArguments {
    std::vector<std::string> inputs;
    std::vector<std::string> layer_inputs{};  ///< by Layer::input, `inputs` first; empty: no layers
    VolumeInputOptions volume;
    PointInputOptions points;
};

/// Renderer of a request, or the default one of the inputs' kind.
/// throws  vog::Error for a renderer that does not draw such inputs
Renderer renderer_of(const PictureRequest& request, const DrawingArguments& arguments,
                     FileKind kind);

}  // namespace vog::cli
