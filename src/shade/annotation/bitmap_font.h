// bitmap_font.h: Draws text into images with a 5x7 pixel font of ASCII and the signs of units.
#pragma once

#include <string>
#include <string_view>

#include "vog/image.h"

namespace vog::shading {

inline constexpr int kGlyphWidth = 5, kGlyphHeight = 7, kGlyphAdvance = 6;  ///< font pixels

/// Scale at which text is 1/36 of a picture's height, at least 1: 2 at 512 pixels.
int text_scale(int height);
/// Black or white, whichever differs more from a background; one that is clear counts as white.
Rgba ink_on(const Rgba& background);

/// throws vog::Error for a character without a glyph
/// what  start of the message
void require_glyphs(const std::string& what, std::string_view text);
/// Width of a text, pixels, without the gap behind the last glyph.
/// scale  pixels of the image for each pixel of the font
int text_width(std::string_view text, int scale);

struct TextStyle {
    int scale = 1;         ///< pixels of the image for each pixel of the font, along an edge
    bool upwards = false;  ///< a quarter turn to the left: lines run from below to above
};
/// Draws text in UTF-8, clipped to the image; characters without a glyph stay blank.
/// column, row  top left corner of the text; bottom left corner where it runs upwards
void draw_text(Image& image, int column, int row, std::string_view text, Rgba color,
               const TextStyle& style = {});

}  // namespace vog::shading
