// finish.cpp: colours, scales and marks of drawn numbers.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "io/file_extension.h"
#include "render/picture/request/request_effects.h"
#include "render/picture/slice_plane.h"
#include "shade/annotation/bitmap_font.h"
#include "shade/annotation/ticks.h"
#include "shade/values/label_table.h"
#include "vog/error.h"
#include "vog/exposure.h"
#include "vog/picture.h"

namespace vog {

namespace {

/// throws  vog::Error where a number is beyond the range of floats
void require_finite(const Sums& sums, Show show, const Scene& scene) {
    const std::string name = scene.name.empty() ? "" : scene.name + ": ";
    const auto beyond = [](float value) { return std::isinf(value); };
    if (is_field_map(show) || show == Show::slice) {
        for (const auto* plane : {&sums.column, &sums.mean, &sums.deviation, &sums.slice})
            if (std::ranges::any_of(*plane, beyond))
                throw Error(name +
                            "a column or a value of the field beyond the range of 32-bit floats: "
                            "other units of values or of length");
        return;
    }
    const auto found = std::ranges::find_if(sums.column, [](float t) { return !std::isfinite(t); });
    if (found == sums.column.end()) return;
    const auto pixel = found - sums.column.begin();
    throw Error(fmt::format(
        "{}optical depth {} at pixel ({}, {}), expected at most {:.2g}, the largest 32-bit float: "
        "other units of values or of length",
        name, *found, pixel % sums.width, pixel / sums.width, std::numeric_limits<float>::max()));
}

void multiply(std::vector<float>& plane, double factor) {
    if (factor == 1) return;
    for (float& value : plane) value = static_cast<float>(factor * double{value});
}

/// Completes the request of a picture by what its numbers gave: it then draws the same picture again.
void complete(Picture& picture) {
    PictureRequest& request = picture.made.request;
    if (request.show == Show::depth) {
        request.extinction = picture.extinction;
    } else if (request.show != Show::volume && !stated_scale(request)) {
        request.transfer.range.emplace(picture.scale.low, picture.scale.high);
        request.fit =
            picture.scale.kind == ColorScale::Kind::log ? ScaleFit::log : ScaleFit::linear;
    }
}

/// Colours over the range of a volume, as a colour bar takes them; none where nothing is opaque.
/// is_plane  whether a plane shows them, as opaque as they are
TransferFunction bar_of(const ChosenTransfer& chosen, bool is_plane = false) {
    constexpr std::size_t kSteps = 1024;  // pixels of a bar, about
    std::vector<Rgba> colors;
    const auto& [kind, low, high] = chosen.scale;
    for (std::size_t n = 0; n <= kSteps; ++n) {
        const double share = static_cast<double>(n) / kSteps;
        const double value = kind == ColorScale::Kind::log ? low * std::pow(high / low, share)
                                                           : std::lerp(low, high, share);
        const ValueLight light = light_of(chosen.transfer, value);
        const double opacity = is_plane
                                   ? -std::expm1(-light.extinction * chosen.transfer.unit_distance)
                                   : double(light.extinction > 0);
        colors.push_back({static_cast<float>(light.r), static_cast<float>(light.g),
                          static_cast<float>(light.b), static_cast<float>(opacity)});
    }
    return sampled_transfer_function(chosen.transfer.name, colors);
}

/// A plane of drawn numbers as an image that gives it back.
class AsDepth {
  public:
    AsDepth(std::vector<float>& plane, int width, int height) : plane_(plane) {
        image.width = width, image.height = height;
        image.depth = std::move(plane);
    }
    ~AsDepth() { plane_ = std::move(image.depth); }
    AsDepth(const AsDepth&) = delete;
    AsDepth& operator=(const AsDepth&) = delete;
    DepthImage image;

  private:
    std::vector<float>& plane_;
};

/// T or a column: sets its extinction and colours it.
void color_depth(Picture& picture) {
    const PictureRequest& request = picture.made.request;
    AsDepth depth(picture.sums.column, picture.sums.width, picture.sums.height);
    const TransferFunction& colors = picture.made.colors;
    if (request.show == Show::depth) {
        set_extinction(depth.image,
                       request.extinction ? *request.extinction : picture_extinction(depth.image));
        picture.extinction = depth.image.extinction;
        picture.image = shade(depth.image, colors, request.shading);
        return;
    }
    const auto stated = stated_scale(request);
    picture.scale = stated ? *stated : automatic_scale({&depth.image, 1}, request.fit);
    picture.image = shade_values(depth.image, colors, picture.scale, request.shading);
}

void color_map(Picture& picture) {
    const PictureRequest& request = picture.made.request;
    Sums& sums = picture.sums;
    const auto stated = stated_scale(request);
    ColoredMap colored;
    if (request.show == Show::maximum || request.show == Show::slice) {
        const std::span<const float> shown = picture.values();
        colored = {{sums.width, sums.height, {shown.begin(), shown.end()}},
                   stated ? *stated : fitted_scale(shown, request.fit)};
    } else {
        FieldMaps maps{sums.width, sums.height, std::move(sums.column), std::move(sums.mean),
                       std::move(sums.deviation)};
        colored = colored_map(maps, request.show, request.fit, stated, request.least_column);
        sums.column = std::move(maps.column);
        sums.mean = std::move(maps.mean), sums.deviation = std::move(maps.deviation);
    }
    picture.scale = colored.scale;
    picture.image = shade_map(colored.shown, picture.made.colors, colored.scale, request.shading);
}

/// Coordinates beside a picture with a colour bar. Axes have them already.
std::optional<SideTicks> sides_of(const Picture& picture, const Scene& scene) {
    const Marks& marks = picture.made.request.marks;
    if (!marks.color_bar || marks.axes) return {};
    return side_ticks(picture.made.camera(), picture.image.width, picture.image.height,
                      scene.subject.content.units.length);
}

/// The picture with its marks around it.
/// of  picture or layer whose colours the bar has
Image beside_bar(const Picture& picture, const TransferFunction& colors, const ColorScale& scale,
                 const Annotation& around, const ResolvedPicture& of) {
    const auto draw =
        shading::is_label_table(of.request.transfer.points) ? shading::annotated_labels : annotated;
    return draw(picture.image, colors, scale, around, picture.made.request.shading.background);
}

/// Adds the title, and a colour bar for each visible layer, with its file where fields have one name.
void mark_layers(Picture& picture, const Scene& scene) {
    const ResolvedPicture& made = picture.made;
    const Marks& marks = made.request.marks;
    Annotation around{marks.title, {}, marks.color_bar, sides_of(picture, scene)};
    for (std::size_t n = 0; n < made.layers.size(); ++n) {
        const ResolvedPicture& layer = made.layers[n];
        if (layer.field.field.empty()) continue;  // hidden, or a surface
        const auto name_of = [&](std::size_t m) {
            return m < scene.layers.size() ? scene.layers[m].name : std::string();
        };
        bool is_shared = false;  // with data of another name
        for (std::size_t m = 0; m < made.layers.size(); ++m)
            is_shared |=
                made.layers[m].field.field == layer.field.field && name_of(m) != name_of(n);
        around.label = quantity_label(Show::volume, layer.field.field, layer.unit);
        if (is_shared && !name_of(n).empty()) around.label += " of " + plain_stem(name_of(n));
        picture.image =
            beside_bar(picture, bar_of(layer.chosen, made.request.layers[n].plane.has_value()),
                       layer.chosen.scale, around, layer);
        if (!marks.color_bar) return;
        around.title.clear(), around.sides.reset();
    }
}

/// Draws the marks over and around the picture.
void mark(Picture& picture, const TransferFunction& colors, const Scene& scene) {
    const ResolvedPicture& made = picture.made;
    const Marks& marks = made.request.marks;
    const Rgba background = made.request.shading.background;
    const std::string& length_unit = scene.subject.content.units.length;
    if (marks.axes || marks.scale_bar)
        draw_frame(
            picture.image,
            {made.camera(), outline_of(scene.subject), length_unit, marks.axes, marks.scale_bar},
            background);
    if (!marks.color_bar && marks.title.empty()) return;
    const Show show = made.request.show;
    if (!made.layers.empty()) return mark_layers(picture, scene);
    const std::string label = show == Show::depth ? quantity_label(show, {}, made.unit)
                              : show == Show::volume
                                  ? quantity_label(show, made.field.field, made.unit)
                                  : with_unit(made.name, made.unit);
    const Annotation around{marks.title, label, marks.color_bar, sides_of(picture, scene)};
    picture.image = beside_bar(picture, colors, picture.scale, around, made);
}

/// Letters of a patient's directions at the middles of the sides of a slice.
void letter(Picture& picture, const Scene& scene) {
    using namespace shading;
    const auto sides = slice_sides(picture.made.camera(), scene.subject.content.standing);
    if (!sides) return;
    Image& image = picture.image;
    const int scale = text_scale(image.height), gap = 2 * scale;
    const int x = (image.width - kGlyphWidth * scale) / 2,
              y = (image.height - kGlyphHeight * scale) / 2;
    const int right = image.width - gap - kGlyphWidth * scale,
              below = image.height - gap - kGlyphHeight * scale;
    const auto draw = [&](int column, int row, const std::string& text) {
        // White with a dark edge, over any colours.
        for (const int dx : {-1, 0, 1})
            for (const int dy : {-1, 0, 1})
                draw_text(image, column + dx, row + dy, text, {0, 0, 0, 1}, {scale});
        draw_text(image, column, row, text, {1, 1, 1, 1}, {scale});
    };
    draw(gap, y, sides->left), draw(right, y, sides->right);
    draw(x, gap, sides->above), draw(x, below, sides->below);
}

}  // namespace

std::span<const float> Picture::values() const {
    switch (made.request.show) {
        case Show::mean:
            return sums.mean;
        case Show::deviation:
            return sums.deviation;
        case Show::maximum:
            return sums.maximum;
        case Show::slice:
            return sums.slice;
        case Show::volume:
            return opacity;
        default:
            return sums.column;
    }
}

DepthImage Picture::depth() const {
    DepthImage depth_image(sums.width, sums.height);
    depth_image.depth = sums.column;
    depth_image.extinction = extinction;
    return depth_image;
}

Picture finish(Sums sums, const ResolvedPicture& picture, const Scene& scene) {
    const Show show = picture.request.show;
    require_finite(sums, show, scene);
    Picture finished{{}, std::move(sums), {}, 1, picture, {}};
    Sums& own = finished.sums;
    if (show == Show::column) multiply(own.column, picture.factor);
    for (std::vector<float>* plane : {&own.mean, &own.deviation, &own.maximum, &own.slice})
        multiply(*plane, picture.factor);
    TransferFunction colors = picture.colors;
    if (show == Show::volume) {
        finished.image = over(own.light, own.width, own.height, picture.request.shading.background);
        finished.opacity.reserve(own.light.size());
        for (const Rgba& pixel : own.light) finished.opacity.push_back(pixel.a);
        finished.scale = picture.chosen.scale;
        if (picture.request.marks.color_bar) colors = bar_of(picture.chosen);
    } else if (is_depth(show)) {
        color_depth(finished);
    } else {
        color_map(finished);
    }
    if (show == Show::slice) letter(finished, scene);
    if (picture.request.marks.any()) mark(finished, colors, scene);
    complete(finished);
    return finished;
}

void write_numbers(const std::filesystem::path& file, const Picture& picture,
                   const std::string& record) {
    const Sums& sums = picture.sums;
    const Show show = picture.made.request.show;
    const bool exr = file.extension() == ".exr";
    if (is_depth(show)) {
        write_values(file, picture.depth(), record);
    } else if (exr && !is_field_map(show)) {
        const NamedValues channels[] = {
            {show == Show::volume ? "opacity" : word_of(show), picture.values()}};
        write_channels(file, sums.width, sums.height, channels, record);
    } else if (exr) {
        const NamedValues channels[] = {
            {"column", sums.column}, {"mean", sums.mean}, {"deviation", sums.deviation}};
        write_channels(file, sums.width, sums.height, channels, record);
    } else {
        const std::span<const float> values = picture.values();
        write_map(file, {sums.width, sums.height, {values.begin(), values.end()}});
    }
}

}  // namespace vog
