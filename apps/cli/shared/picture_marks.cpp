// picture_marks.cpp: Marks drawn over a picture and around it, and the units that the data state.
#include <fmt/core.h>

#include "shared/render_run.h"
#include "vog/quantity.h"
#include "vog/scan_io.h"
#include "vog/units.h"

namespace vog::cli {

Box outline_of(const Subject& subject) {
    return subject.content.voxels.empty() ? subject.box : subject.content.voxels;
}

Image annotated_picture(const RenderArguments& arguments, const Drawing& drawing,
                        const Camera& camera, Image image, const TransferFunction& tf,
                        const ColorScale& scale, const std::string& label) {
    const QuantityArguments& given = arguments.quantity;
    const Rgba background = shading_of(arguments.color).background;
    if (!given.axes && !given.scale_bar && !given.color_bar && given.title.empty()) return image;
    const std::string length = head_of(arguments).length_unit;
    if (given.axes || given.scale_bar)
        draw_frame(image,
                   {camera, outline_of(arguments.subject.value_or(drawing.subject)), length,
                    given.axes, given.scale_bar},
                   background);
    if (!given.color_bar && given.title.empty()) return image;
    Annotation around{given.title, label, given.color_bar};
    if (given.color_bar) around.sides = side_ticks(camera, image.width, image.height, length);
    return annotated(image, tf, scale, around, background);
}

VolumeHead head_of(const RenderArguments& arguments) {
    const std::string &input = arguments.drawing.inputs.front(),
                      &grid = arguments.drawing.volume.grid;
    return kind_of(input, grid) == FileKind::volume ? volume_head(input, grid) : VolumeHead{};
}

std::string column_unit(const VolumeHead& head) {
    if (head.value_unit.empty() || head.length_unit.empty()) return {};
    return head.value_unit + " " + head.length_unit;
}

double units_factor(const std::string& stated, const std::string& requested) {
    if (stated.empty() || requested.empty()) return 1;
    if (const std::optional<double> factor = unit_factor(stated, requested)) return *factor;
    throw CLI::ValidationError(fmt::format(
        "--units {}: the data are in {}, expected a unit that it converts to, or no --units",
        requested, stated));
}

}  // namespace vog::cli
