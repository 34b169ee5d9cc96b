// bitmap_font.h: Draws text into images with a 5x7 pixel font of the characters of a colour scale.
#pragma once

#include <string_view>

#include "vog/image.h"

namespace vog::comparison {

inline constexpr int kGlyphWidth = 5, kGlyphHeight = 7, kGlyphAdvance = 6;  ///< pixels

/// Draws text with its top left corner at (column, row), clipped to the image.
/// text  of 0-9 + - . / | A B e and space; any other character fails an assertion
void draw_text(Image& image, int column, int row, std::string_view text, Rgba color);

}  // namespace vog::comparison
