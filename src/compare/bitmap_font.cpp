// bitmap_font.cpp: Glyphs of 5x7 pixels, and their drawing.
#include "compare/bitmap_font.h"

#include <array>
#include <cassert>

namespace vog::comparison {

namespace {

/// Seven rows of five pixels from the top; the bit of value 16 is the leftmost.
struct Glyph {
    char character;
    std::array<unsigned char, kGlyphHeight> row;
};

constexpr Glyph kGlyphs[] = {
    {'0', {14, 17, 19, 21, 25, 17, 14}},
    {'1', {4, 12, 4, 4, 4, 4, 14}},
    {'2', {14, 17, 1, 2, 4, 8, 31}},
    {'3', {31, 2, 4, 2, 1, 17, 14}},
    {'4', {2, 6, 10, 18, 31, 2, 2}},
    {'5', {31, 16, 30, 1, 1, 17, 14}},
    {'6', {6, 8, 16, 30, 17, 17, 14}},
    {'7', {31, 1, 2, 4, 8, 8, 8}},
    {'8', {14, 17, 17, 14, 17, 17, 14}},
    {'9', {14, 17, 17, 15, 1, 2, 12}},
    {'+', {0, 4, 4, 31, 4, 4, 0}},
    {'-', {0, 0, 0, 31, 0, 0, 0}},
    {'.', {0, 0, 0, 0, 0, 12, 12}},
    {'/', {1, 1, 2, 4, 8, 16, 16}},
    {'|', {4, 4, 4, 4, 4, 4, 4}},
    {'A', {14, 17, 17, 31, 17, 17, 17}},
    {'B', {30, 17, 17, 30, 17, 17, 30}},
    {'e', {0, 0, 14, 17, 31, 16, 14}},
    {' ', {}},
};

const Glyph* find(char character) {
    for (const Glyph& glyph : kGlyphs)
        if (glyph.character == character) return &glyph;
    return nullptr;
}

}  // namespace

void draw_text(Image& image, int column, int row, std::string_view text, Rgba color) {
    for (const char character : text) {
        const Glyph* glyph = find(character);
        assert(glyph);
        if (!glyph) continue;
        for (int y = 0; y < kGlyphHeight; ++y)
            for (int x = 0; x < kGlyphWidth; ++x) {
                const bool inside = column + x >= 0 && column + x < image.width && row + y >= 0 &&
                                    row + y < image.height;
                const bool set = glyph->row[static_cast<std::size_t>(y)] >> (4 - x) & 1;
                if (inside && set) image.at(column + x, row + y) = color;
            }
        column += kGlyphAdvance;
    }
}

}  // namespace vog::comparison
