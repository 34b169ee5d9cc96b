// annotated.cpp: Colour bar and title around a picture.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "data/image_checks.h"
#include "shade/annotation/bitmap_font.h"
#include "shade/annotation/ticks.h"
#include "vog/error.h"
#include "vog/quantity.h"

namespace vog {

using namespace shading;

namespace {

/// Sizes of the margins, pixels. Lengths are multiples of the text's scale: a font pixel.
struct Layout {
    int scale = 1, gap = 4, bar_width = 10, tick_length = 3;
    int bar_left = 0, text_left = 0, label_left = 0, right = 0;  ///< columns
    int top = 0, bottom = 0;                                     ///< rows of the bar: [top, bottom)
    int picture_left = 0, picture_top = 0;
    int height = 0;  ///< of the whole image
};

/// The largest scale up to `most` at which a text fits.
int fitting_scale(const std::string& what, const std::string& text, int most, int length) {
    for (int scale = most; scale >= 1; --scale)
        if (text_width(text, scale) <= length) return scale;
    throw Error(fmt::format("{} '{}': {} pixels wide at least, expected {} at most", what, text,
                            text_width(text, 1), length));
}

void fill(Image& image, int left, int top, int right, int bottom, const Rgba& color) {
    for (int y = std::max(top, 0); y < std::min(bottom, image.height); ++y)
        for (int x = std::max(left, 0); x < std::min(right, image.width); ++x)
            image.at(x, y) = color;
}

/// Least distance between ticks, as positions: one and a half lines of text.
double tick_gap(const Layout& at, int length) {
    return std::min(0.5, 1.5 * at.scale * kGlyphHeight / std::max(1, length));
}
double bar_gap(const Layout& at) { return tick_gap(at, at.bottom - at.top); }

/// Ticks along a side of a picture, with their places from its first pixel's outer edge.
struct SideTick {
    int place;
    std::string text;
};
std::vector<SideTick> ticks_along(const SideTicks::Side& side, int pixels, double gap) {
    std::vector<SideTick> ticks;
    const auto [low, high] = std::minmax(side.first, side.last);
    if (!(low < high)) return ticks;
    for (const auto& [value, text] : ticks_of({ColorScale::Kind::linear, low, high}, gap))
        ticks.push_back({static_cast<int>(
                             std::lround((value - side.first) / (side.last - side.first) * pixels)),
                         text});
    return ticks;
}
std::vector<SideTick> ticks_up(const Layout& at, const SideTicks& sides, int height) {
    return ticks_along(sides.up, height, tick_gap(at, height));
}

Layout layout_of(const Image& picture, const ColorScale& scale, const Annotation& annotation,
                 bool whole) {
    Layout at;
    at.scale = text_scale(picture.height);
    at.gap *= at.scale, at.bar_width *= at.scale, at.tick_length *= at.scale;
    if (!annotation.title.empty()) at.picture_top = at.scale * kGlyphHeight + 2 * at.gap;
    int below = 0;
    if (annotation.sides) {
        int widest = 0;
        for (const SideTick& tick : ticks_up(at, *annotation.sides, picture.height))
            widest = std::max(widest, text_width(tick.text, at.scale));
        const int label = at.scale * kGlyphHeight + 2 * at.gap;
        at.picture_left = label + widest + at.gap / 2 + at.tick_length;
        below = at.tick_length + at.gap / 2 + at.scale * kGlyphHeight + label;
    }
    at.right = at.picture_left + picture.width;
    at.height = at.picture_top + picture.height + below;
    if (!annotation.color_bar) return at;
    // A picture smaller than its label gets a bar as long as the label.
    at.height =
        std::max(at.height, at.picture_top + text_width(annotation.label, 1) + 2 * at.gap + below);
    at.top = at.picture_top + at.gap;
    at.bottom = at.height - below - at.gap;
    at.bar_left = at.right + 2 * at.gap;
    at.text_left = at.bar_left + at.bar_width + at.tick_length + at.gap / 2;
    int widest = 0;
    for (const Tick& tick : ticks_of(scale, bar_gap(at), whole))
        widest = std::max(widest, text_width(tick.text, at.scale));
    at.label_left = at.text_left + widest + at.gap;
    at.right = at.label_left + (annotation.label.empty() ? 0 : at.scale * kGlyphHeight + at.gap);
    return at;
}

void draw_bar(const Layout& at, const TransferFunction& tf, const ColorScale& scale,
              const std::string& label, const Rgba& background, const Rgba& ink, Image& image,
              bool whole) {
    const int rows = at.bottom - at.top;
    // A frame of one font pixel parts colours from a background of the same colour.
    fill(image, at.bar_left - at.scale, at.top - at.scale, at.bar_left + at.bar_width + at.scale,
         at.bottom + at.scale, ink);
    for (int y = 0; y < rows; ++y) {
        const double up = (rows - 0.5 - y) / rows;
        Rgba color = color_at(tf, static_cast<float>(up));
        for (float Rgba::*channel : {&Rgba::r, &Rgba::g, &Rgba::b})
            color.*channel = std::lerp(background.*channel, color.*channel, color.a);
        color.a = 1;
        fill(image, at.bar_left, at.top + y, at.bar_left + at.bar_width, at.top + y + 1, color);
    }
    for (const auto& [value, text] : ticks_of(scale, bar_gap(at), whole)) {
        const int y =
            at.bottom - static_cast<int>(std::lround(scale_position(scale, value) * rows));
        const int line = y - at.scale / 2;
        fill(image, at.bar_left + at.bar_width, line, at.text_left - at.gap / 2, line + at.scale,
             ink);
        const int row =
            std::clamp(y - at.scale * kGlyphHeight / 2, 0, image.height - at.scale * kGlyphHeight);
        draw_text(image, at.text_left, row, text, ink, {at.scale});
    }
    if (label.empty()) return;
    const int label_scale = fitting_scale("label", label, at.scale, rows);
    const int below = (rows - text_width(label, label_scale)) / 2;
    draw_text(image, at.label_left, at.bottom - below, label, ink, {label_scale, true});
}

/// Ticks, coordinates and names left of the picture and below it.
void draw_sides(const Layout& at, const SideTicks& sides, int width, int height, const Rgba& ink,
                Image& image) {
    const int left = at.picture_left, bottom = at.picture_top + height,
              text = at.scale * kGlyphHeight;
    for (const SideTick& tick : ticks_up(at, sides, height)) {
        const int y = bottom - tick.place;
        fill(image, left - at.tick_length, y - at.scale / 2, left, y - at.scale / 2 + at.scale,
             ink);
        draw_text(image, left - at.tick_length - at.gap / 2 - text_width(tick.text, at.scale),
                  std::clamp(y - text / 2, 0, image.height - text), tick.text, ink, {at.scale});
    }
    std::vector<SideTick> across;
    for (int glyphs = 6; glyphs < 17; ++glyphs) {
        const double widest = double(glyphs) * kGlyphAdvance * at.scale;
        across = ticks_along(sides.across, width, std::min(0.5, widest / width));
        if (std::ranges::all_of(across, [&](const SideTick& tick) {
                return tick.text.size() <= static_cast<std::size_t>(glyphs);
            }))
            break;
    }
    for (const SideTick& tick : across) {
        const int x = left + tick.place, wide = text_width(tick.text, at.scale);
        fill(image, x - at.scale / 2, bottom, x - at.scale / 2 + at.scale, bottom + at.tick_length,
             ink);
        draw_text(image, std::clamp(x - wide / 2, 0, image.width - wide),
                  bottom + at.tick_length + at.gap / 2, tick.text, ink, {at.scale});
    }
    const auto size_of = [&](const std::string& name, int room) {
        return fitting_scale("unit of length", name, at.scale, room);
    };
    const int level = size_of(sides.across.name, width), up = size_of(sides.up.name, height);
    draw_text(image, left + (width - text_width(sides.across.name, level)) / 2,
              bottom + at.tick_length + at.gap / 2 + text + at.gap, sides.across.name, ink,
              {level});
    draw_text(image, at.gap, bottom - (height - text_width(sides.up.name, up)) / 2, sides.up.name,
              ink, {up, true});
}

/// whole  ticks of the bar at whole numbers alone
Image annotate(const Image& picture, const TransferFunction& tf, const ColorScale& scale,
               const Annotation& annotation, Rgba background, bool whole) {
    require_valid("annotated", picture);
    require_glyphs("title", annotation.title);
    require_glyphs("label", annotation.label);
    const Layout at = layout_of(picture, scale, annotation, whole);
    Image image(at.right, at.height);
    std::ranges::fill(image.pixel, background);
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x)
            image.at(at.picture_left + x, at.picture_top + y) = picture.at(x, y);
    const Rgba ink = ink_on(background);
    if (!annotation.title.empty()) {
        const int size =
            fitting_scale("title", annotation.title, at.scale, image.width - 2 * at.gap);
        draw_text(image, (image.width - text_width(annotation.title, size)) / 2, at.gap,
                  annotation.title, ink, {size});
    }
    if (annotation.sides)
        draw_sides(at, *annotation.sides, picture.width, picture.height, ink, image);
    if (annotation.color_bar)
        draw_bar(at, tf, scale, annotation.label, background, ink, image, whole);
    return image;
}

}  // namespace

Image annotated(const Image& picture, const TransferFunction& tf, const ColorScale& scale,
                const Annotation& annotation, Rgba background) {
    return annotate(picture, tf, scale, annotation, background, false);
}

Image shading::annotated_labels(const Image& picture, const TransferFunction& tf,
                                const ColorScale& scale, const Annotation& annotation,
                                Rgba background) {
    return annotate(picture, tf, scale, annotation, background, true);
}

}  // namespace vog
