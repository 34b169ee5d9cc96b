// bitmap_font.cpp: Glyphs of 5x7 pixels, and their drawing.
#include "shade/annotation/bitmap_font.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "vog/error.h"

namespace vog::shading {

namespace {

/// Rows of a glyph: those above the baseline, then two for descenders.
constexpr int kGlyphRows = kGlyphHeight + 2;

/// Rows of five pixels from the top; the bit of value 16 is the leftmost.
struct Glyph {
    char32_t character;
    std::array<unsigned char, kGlyphRows> row;
};

constexpr Glyph kGlyphs[] = {
    {U' ', {}},
    {U'!', {4, 4, 4, 4, 4, 0, 4}},
    {U'"', {10, 10, 10, 0, 0, 0, 0}},
    {U'#', {10, 10, 31, 10, 31, 10, 10}},
    {U'$', {4, 15, 20, 14, 5, 30, 4}},
    {U'%', {24, 25, 2, 4, 8, 19, 3}},
    {U'&', {12, 18, 20, 8, 21, 18, 13}},
    {U'\'', {12, 4, 8, 0, 0, 0, 0}},
    {U'(', {2, 4, 8, 8, 8, 4, 2}},
    {U')', {8, 4, 2, 2, 2, 4, 8}},
    {U'*', {0, 10, 4, 31, 4, 10, 0}},
    {U'+', {0, 4, 4, 31, 4, 4, 0}},
    {U',', {0, 0, 0, 0, 12, 4, 8}},
    {U'-', {0, 0, 0, 31, 0, 0, 0}},
    {U'.', {0, 0, 0, 0, 0, 12, 12}},
    {U'/', {0, 1, 2, 4, 8, 16, 0}},
    {U'0', {14, 17, 19, 21, 25, 17, 14}},
    {U'1', {4, 12, 4, 4, 4, 4, 14}},
    {U'2', {14, 17, 1, 2, 4, 8, 31}},
    {U'3', {31, 2, 4, 2, 1, 17, 14}},
    {U'4', {2, 6, 10, 18, 31, 2, 2}},
    {U'5', {31, 16, 30, 1, 1, 17, 14}},
    {U'6', {6, 8, 16, 30, 17, 17, 14}},
    {U'7', {31, 1, 2, 4, 8, 8, 8}},
    {U'8', {14, 17, 17, 14, 17, 17, 14}},
    {U'9', {14, 17, 17, 15, 1, 2, 12}},
    {U':', {0, 12, 12, 0, 12, 12, 0}},
    {U';', {0, 12, 12, 0, 12, 4, 8}},
    {U'<', {2, 4, 8, 16, 8, 4, 2}},
    {U'=', {0, 0, 31, 0, 31, 0, 0}},
    {U'>', {8, 4, 2, 1, 2, 4, 8}},
    {U'?', {14, 17, 1, 2, 4, 0, 4}},
    {U'@', {14, 17, 1, 13, 21, 21, 14}},
    {U'A', {14, 17, 17, 17, 31, 17, 17}},
    {U'B', {30, 17, 17, 30, 17, 17, 30}},
    {U'C', {14, 17, 16, 16, 16, 17, 14}},
    {U'D', {28, 18, 17, 17, 17, 18, 28}},
    {U'E', {31, 16, 16, 30, 16, 16, 31}},
    {U'F', {31, 16, 16, 30, 16, 16, 16}},
    {U'G', {14, 17, 16, 23, 17, 17, 15}},
    {U'H', {17, 17, 17, 31, 17, 17, 17}},
    {U'I', {14, 4, 4, 4, 4, 4, 14}},
    {U'J', {7, 2, 2, 2, 2, 18, 12}},
    {U'K', {17, 18, 20, 24, 20, 18, 17}},
    {U'L', {16, 16, 16, 16, 16, 16, 31}},
    {U'M', {17, 27, 21, 21, 17, 17, 17}},
    {U'N', {17, 17, 25, 21, 19, 17, 17}},
    {U'O', {14, 17, 17, 17, 17, 17, 14}},
    {U'P', {30, 17, 17, 30, 16, 16, 16}},
    {U'Q', {14, 17, 17, 17, 21, 18, 13}},
    {U'R', {30, 17, 17, 30, 20, 18, 17}},
    {U'S', {15, 16, 16, 14, 1, 1, 30}},
    {U'T', {31, 4, 4, 4, 4, 4, 4}},
    {U'U', {17, 17, 17, 17, 17, 17, 14}},
    {U'V', {17, 17, 17, 17, 17, 10, 4}},
    {U'W', {17, 17, 17, 21, 21, 21, 10}},
    {U'X', {17, 17, 10, 4, 10, 17, 17}},
    {U'Y', {17, 17, 17, 10, 4, 4, 4}},
    {U'Z', {31, 1, 2, 4, 8, 16, 31}},
    {U'[', {14, 8, 8, 8, 8, 8, 14}},
    {U'\\', {0, 16, 8, 4, 2, 1, 0}},
    {U']', {14, 2, 2, 2, 2, 2, 14}},
    {U'^', {4, 10, 17, 0, 0, 0, 0}},
    {U'_', {0, 0, 0, 0, 0, 0, 31}},
    {U'`', {8, 4, 2, 0, 0, 0, 0}},
    {U'a', {0, 0, 14, 1, 15, 17, 15}},
    {U'b', {16, 16, 22, 25, 17, 17, 30}},
    {U'c', {0, 0, 14, 16, 16, 17, 14}},
    {U'd', {1, 1, 13, 19, 17, 17, 15}},
    {U'e', {0, 0, 14, 17, 31, 16, 14}},
    {U'f', {6, 9, 8, 28, 8, 8, 8}},
    {U'g', {0, 0, 15, 17, 17, 17, 15, 1, 14}},
    {U'h', {16, 16, 22, 25, 17, 17, 17}},
    {U'i', {4, 0, 12, 4, 4, 4, 14}},
    {U'j', {2, 0, 6, 2, 2, 2, 2, 18, 12}},
    {U'k', {16, 16, 18, 20, 24, 20, 18}},
    {U'l', {12, 4, 4, 4, 4, 4, 14}},
    {U'm', {0, 0, 26, 21, 21, 17, 17}},
    {U'n', {0, 0, 22, 25, 17, 17, 17}},
    {U'o', {0, 0, 14, 17, 17, 17, 14}},
    {U'p', {0, 0, 30, 17, 17, 17, 30, 16, 16}},
    {U'q', {0, 0, 15, 17, 17, 17, 15, 1, 1}},
    {U'r', {0, 0, 22, 25, 16, 16, 16}},
    {U's', {0, 0, 14, 16, 14, 1, 30}},
    {U't', {8, 8, 28, 8, 8, 9, 6}},
    {U'u', {0, 0, 17, 17, 17, 19, 13}},
    {U'v', {0, 0, 17, 17, 17, 10, 4}},
    {U'w', {0, 0, 17, 17, 21, 21, 10}},
    {U'x', {0, 0, 17, 10, 4, 10, 17}},
    {U'y', {0, 0, 17, 17, 17, 17, 15, 1, 14}},
    {U'z', {0, 0, 31, 2, 4, 8, 31}},
    {U'{', {2, 4, 4, 8, 4, 4, 2}},
    {U'|', {4, 4, 4, 4, 4, 4, 4}},
    {U'}', {8, 4, 4, 2, 4, 4, 8}},
    {U'~', {0, 0, 8, 21, 2, 0, 0}},
    {U'\u00b9', {4, 12, 4, 4, 14, 0, 0}},
    {U'\u00b2', {12, 2, 4, 8, 14, 0, 0}},
    {U'\u00b3', {12, 2, 4, 2, 12, 0, 0}},
    {U'\u207b', {0, 0, 14, 0, 0, 0, 0}},
    {U'\u00b0', {12, 18, 18, 12, 0, 0, 0}},
    {U'\u00b5', {0, 17, 17, 19, 29, 16, 16}},
    {U'\u00d7', {0, 17, 10, 4, 10, 17, 0}},
    {U'\u00b7', {0, 0, 0, 12, 12, 0, 0}},
};

const Glyph* find(char32_t character) {
    const auto* found = std::ranges::find(kGlyphs, character, &Glyph::character);
    return found == std::end(kGlyphs) ? nullptr : found;
}

/// Takes the first character off a text in UTF-8; 0xfffd for bytes that are none.
char32_t take_character(std::string_view& text) {
    const auto byte = [&](std::size_t n) {
        return n < text.size() ? static_cast<unsigned char>(text[n]) : 0u;
    };
    const auto follows = [&](std::size_t n) { return (byte(n) & 0xc0u) == 0x80u; };
    char32_t character = 0xfffd;
    std::size_t size = 1;
    if (byte(0) < 0x80u) {
        character = byte(0);
    } else if ((byte(0) & 0xe0u) == 0xc0u && follows(1)) {
        character = (byte(0) & 0x1fu) << 6 | (byte(1) & 0x3fu);
        size = 2;
    } else if ((byte(0) & 0xf0u) == 0xe0u && follows(1) && follows(2)) {
        character = (byte(0) & 0x0fu) << 12 | (byte(1) & 0x3fu) << 6 | (byte(2) & 0x3fu);
        size = 3;
    }
    text.remove_prefix(size);
    return character;
}

int characters(std::string_view text) {
    int count = 0;
    for (; !text.empty(); ++count) take_character(text);
    return count;
}

}  // namespace

void require_glyphs(const std::string& what, std::string_view text) {
    for (std::string_view left = text; !left.empty();) {
        const std::string_view before = left;
        if (!find(take_character(left)))
            throw Error(
                fmt::format("{} '{}': no glyph for '{}', expected ASCII and \u00b9 \u00b2 "
                            "\u00b3 \u207b \u00b0 \u00b5 \u00d7 \u00b7",
                            what, text, before.substr(0, before.size() - left.size())));
    }
}

int text_width(std::string_view text, int scale) {
    return scale * std::max(0, kGlyphAdvance * characters(text) - 1);
}

void draw_text(Image& image, int column, int row, std::string_view text, Rgba color,
               const TextStyle& style) {
    const auto fill = [&](int x0, int y0) {
        for (int y = y0; y < y0 + style.scale; ++y)
            for (int x = x0; x < x0 + style.scale; ++x)
                if (x >= 0 && x < image.width && y >= 0 && y < image.height) image.at(x, y) = color;
    };
    for (int along = 0; !text.empty(); along += kGlyphAdvance) {
        const Glyph* glyph = find(take_character(text));
        if (!glyph) continue;
        for (int y = 0; y < kGlyphRows; ++y)
            for (int x = 0; x < kGlyphWidth; ++x) {
                if (!(glyph->row[static_cast<std::size_t>(y)] >> (4 - x) & 1)) continue;
                const int right = style.scale * (along + x), down = style.scale * y;
                if (style.upwards)
                    fill(column + down, row - right - style.scale);
                else
                    fill(column + right, row + down);
            }
    }
}

int text_scale(int height) {
    constexpr double kShare = 36;
    return std::max(1, static_cast<int>(std::lround(height / (kShare * kGlyphHeight))));
}

Rgba ink_on(const Rgba& background) {
    // Rec. 709 luma of the background, white where it is clear.
    const float luma =
        background.a * (0.2126f * background.r + 0.7152f * background.g + 0.0722f * background.b) +
        (1 - background.a);
    return luma < 0.5f ? Rgba{1, 1, 1, 1} : Rgba{0, 0, 0, 1};
}

}  // namespace vog::shading
