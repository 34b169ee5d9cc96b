// drawing_options.cpp: help of inputs, and the choice of a renderer.
#include "pictures/drawing_options.h"

#include <fmt/format.h>

#include "vog/error.h"

namespace vog::cli {

void add_drawing_options(CLI::App& command, DrawingArguments& arguments) {
    command
        .add_option("inputs", arguments.inputs,
                    "PLY models, OpenVDB or NanoVDB volumes, or particles (.xyz, .csv, .tsv, "
                    ".vdb); several become one picture")
        ->required();
    add_volume_options(command, arguments.volume);
    add_point_options(command, arguments.points);
}

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
