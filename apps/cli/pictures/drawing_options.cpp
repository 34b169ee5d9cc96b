// drawing_options.cpp: help of inputs, and the choice of a renderer.
#include "pictures/drawing_options.h"

#include <fmt/format.h>

#include "vog/error.h"

namespace vog::cli {

Renderer renderer_of(const PictureRequest& request, const DrawingArguments& arguments,
                     FileKind kind) {
    const std::string& input = arguments.inputs.front();
    const bool volumes = kind == FileKind::volume;
    const Renderer renderer =
        request.renderer.value_or(volumes ? Renderer::reference : Renderer::splat);
    if (volumes && !draws(renderer, RenderInput::volumes))
        throw Error(fmt::format("{}: is a volume; convert it first: vog convert {} -o model.ply",
                                input, input));
    if (!volumes && !draws(renderer, RenderInput::gaussians))
        throw Error(fmt::format("{}: holds {}; the {} renders volumes", input,
                                kind == FileKind::model ? "a model" : "particles",
                                info_of(renderer).name));
    return renderer;
}

}  // namespace vog::cli
