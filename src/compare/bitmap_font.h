// bitmap_font.h: figures on pictures: just the characters that a colour scale needs.
#pragma once

#include <string_view>

#include "vog/image.h"

namespace vog::comparison {

inline constexpr int kGlyphWidth = 5, kGlyphHeight = 7, kGlyphAdvance = 6;  ///< pixels

/// Draws `text`, its top left corner at (column, row); what lies outside the image is left out.
/// Characters: 0-9 + - . / | A B e and space; any other is an assertion.
void draw_text(Image& image, int column, int row, std::string_view text, Rgba color);

}  // namespace vog::comparison
