// annotated.cpp: Colour bar and title around a picture.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "data/image_checks.h"
#include "shade/bitmap_font.h"
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
    int picture_top = 0, height = 0;                             ///< height of the whole image
};

/// Scale at which text is 1/36 of the picture's height, at least 1: 2 at 512 pixels.
int text_scale(int height) {
    constexpr double kShare = 36;
    return std::max(1, static_cast<int>(std::lround(height / (kShare * kGlyphHeight))));
}

/// The largest scale up to `most` at which a text fits.
int fitting_scale(const std::string& what, const std::string& text, int most, int length) {
    for (int scale = most; scale >= 1; --scale)
        if (text_width(text, scale) <= length) return scale;
    throw Error(fmt::format("{} '{}': {} pixels wide at least, expected {} at most", what, text,
                            text_width(text, 1), length));
}

Rgba ink_on(const Rgba& background) {
    // Rec. 709 luma of the background, white where it is clear.
    const float luma =
        background.a * (0.2126f * background.r + 0.7152f * background.g + 0.0722f * background.b) +
        (1 - background.a);
    return luma < 0.5f ? Rgba{1, 1, 1, 1} : Rgba{0, 0, 0, 1};
}

void fill(Image& image, int left, int top, int right, int bottom, const Rgba& color) {
    for (int y = std::max(top, 0); y < std::min(bottom, image.height); ++y)
        for (int x = std::max(left, 0); x < std::min(right, image.width); ++x)
            image.at(x, y) = color;
}

/// Least distance between ticks, as positions: one and a half lines of text.
double tick_gap(const Layout& at) {
    return std::min(0.5, 1.5 * at.scale * kGlyphHeight / std::max(1, at.bottom - at.top));
}

Layout layout_of(const Image& picture, const ColorScale& scale, const Annotation& annotation) {
    Layout at;
    at.scale = text_scale(picture.height);
    at.gap *= at.scale, at.bar_width *= at.scale, at.tick_length *= at.scale;
    if (!annotation.title.empty()) at.picture_top = at.scale * kGlyphHeight + 2 * at.gap;
    at.right = picture.width;
    at.height = at.picture_top + picture.height;
    if (!annotation.color_bar) return at;
    // A picture smaller than its label gets a bar as long as the label.
    at.height = std::max(at.height, at.picture_top + text_width(annotation.label, 1) + 2 * at.gap);
    at.top = at.picture_top + at.gap;
    at.bottom = at.height - at.gap;
    at.bar_left = picture.width + 2 * at.gap;
    at.text_left = at.bar_left + at.bar_width + at.tick_length + at.gap / 2;
    int widest = 0;
    for (const double tick : scale_ticks(scale, tick_gap(at)))
        widest = std::max(widest, text_width(tick_text(tick), at.scale));
    at.label_left = at.text_left + widest + at.gap;
    at.right = at.label_left + (annotation.label.empty() ? 0 : at.scale * kGlyphHeight + at.gap);
    return at;
}

void draw_bar(const Layout& at, const TransferFunction& tf, const ColorScale& scale,
              const std::string& label, const Rgba& background, const Rgba& ink, Image& image) {
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
    for (const double tick : scale_ticks(scale, tick_gap(at))) {
        const int y = at.bottom - static_cast<int>(std::lround(scale_position(scale, tick) * rows));
        const int line = y - at.scale / 2;
        fill(image, at.bar_left + at.bar_width, line, at.text_left - at.gap / 2, line + at.scale,
             ink);
        const int row =
            std::clamp(y - at.scale * kGlyphHeight / 2, 0, image.height - at.scale * kGlyphHeight);
        draw_text(image, at.text_left, row, tick_text(tick), ink, {at.scale});
    }
    if (label.empty()) return;
    const int label_scale = fitting_scale("label", label, at.scale, rows);
    const int below = (rows - text_width(label, label_scale)) / 2;
    draw_text(image, at.label_left, at.bottom - below, label, ink, {label_scale, true});
}

}  // namespace

Image annotated(const Image& picture, const TransferFunction& tf, const ColorScale& scale,
                const Annotation& annotation, Rgba background) {
    require_valid("annotated", picture);
    require_glyphs("title", annotation.title);
    require_glyphs("label", annotation.label);
    const Layout at = layout_of(picture, scale, annotation);
    Image image(at.right, at.height);
    std::ranges::fill(image.pixel, background);
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) image.at(x, at.picture_top + y) = picture.at(x, y);
    const Rgba ink = ink_on(background);
    if (!annotation.title.empty()) {
        const int size =
            fitting_scale("title", annotation.title, at.scale, image.width - 2 * at.gap);
        draw_text(image, (image.width - text_width(annotation.title, size)) / 2, at.gap,
                  annotation.title, ink, {size});
    }
    if (annotation.color_bar) draw_bar(at, tf, scale, annotation.label, background, ink, image);
    return image;
}

}  // namespace vog
