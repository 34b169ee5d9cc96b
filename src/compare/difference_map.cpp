// difference_map.cpp: Heat maps of the difference of two images, with a colour scale.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "compare/grey.h"
#include "core/parallel.h"
#include "shade/annotation/bitmap_font.h"
#include "vog/compare.h"
#include "vog/error.h"

namespace vog {

using namespace comparison;
using shading::draw_text;
using shading::kGlyphHeight;

namespace {

/// Differences a pixel, in 1/255, with the colours of the map.
struct Differences {
    int width = 0, height = 0;
    std::vector<float> value;
    bool is_signed = false;
    TransferFunction colors;  ///< over [0, 1]; signed differences have 0 at 1/2
    const char* title = "";
};

/// The smallest 1, 2 or 5 times a power of ten that is >= `value`; 1 for 0.
double round_up(double value) {
    if (!(value > 0)) return 1;
    const double power = std::pow(10, std::floor(std::log10(value)));
    for (const double step : {1.0, 2.0, 5.0})
        if (value <= step * power) return step * power;
    return 10 * power;
}

double scale_limit(const Differences& differences, double requested) {
    if (!(std::isfinite(requested) && requested >= 0))
        throw Error(fmt::format("difference map: limit {}, expected a number >= 0", requested));
    if (requested > 0) return requested;
    float largest = 0;
    for (const float value : differences.value) largest = std::max(largest, std::abs(value));
    return round_up(static_cast<double>(largest));
}

Rgba color_at(const Differences& differences, double share) {
    const double position = differences.is_signed ? 0.5 + 0.5 * share : share;
    return color_at(differences.colors, static_cast<float>(std::clamp(position, 0.0, 1.0)));
}

/// Draws the colour scale into the right margin: title, bar, and numbers at its ends and quarters.
void draw_bar(const Differences& differences, double limit, int left, Image& image) {
    constexpr int kTop = 30, kBottom = 10, kBarWidth = 14, kGap = 10;
    const Rgba ink{0.1f, 0.1f, 0.1f, 1};
    draw_text(image, left + kGap, 6, differences.title, ink);
    draw_text(image, left + kGap, 16, "/255", ink);

    const int x0 = left + kGap, y0 = kTop, y1 = image.height - kBottom - 1;
    for (int y = y0; y <= y1; ++y) {
        const double up = 1 - static_cast<double>(y - y0) / (y1 - y0);
        const Rgba color = color_at(differences, differences.is_signed ? 2 * up - 1 : up);
        for (int x = x0; x < x0 + kBarWidth; ++x) image.at(x, y) = color;
    }
    for (int tick = 0; tick <= 4; ++tick) {
        const double up = tick / 4.0, share = differences.is_signed ? 2 * up - 1 : up;
        const int y = y1 - static_cast<int>(std::lround(up * (y1 - y0)));
        for (int x = x0 + kBarWidth; x < x0 + kBarWidth + 4; ++x) image.at(x, y) = ink;
        const bool plus = differences.is_signed && share > 0;
        const std::string figure = fmt::format("{}{:.4g}", plus ? "+" : "", share * limit);
        draw_text(image, x0 + kBarWidth + 7, y - kGlyphHeight / 2, figure, ink);
    }
}

Image paint(const Differences& differences, const DifferenceMapOptions& options) {
    constexpr int kBarMargin = 76, kLeastBarHeight = 120;
    const double limit = scale_limit(differences, options.limit);
    const int width = differences.width, height = differences.height;
    Image image(width + (options.bar ? kBarMargin : 0),
                options.bar ? std::max(height, kLeastBarHeight) : height);
    std::fill(image.pixel.begin(), image.pixel.end(), Rgba{1, 1, 1, 1});
    vog::parallel_for(0, height, [&](int y) {
        for (int x = 0; x < width; ++x) {
            const std::size_t n = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                                  static_cast<std::size_t>(x);
            image.at(x, y) =
                color_at(differences, static_cast<double>(differences.value[n]) / limit);
        }
    });
    if (options.bar) draw_bar(differences, limit, width, image);
    return image;
}

}  // namespace

Image difference_map(const DepthImage& reference, const DepthImage& image,
                     const DifferenceMapOptions& options) {
    require_same_size(reference, image);
    Differences differences{reference.width, reference.height, {}, true, {}, "B-A"};
    differences.colors = named_transfer_function("coolwarm");
    const double factor = to_extinction_of(reference, image);
    for (std::size_t n = 0; n < reference.depth.size(); ++n)
        differences.value.push_back(static_cast<float>(visibility_255(image.depth[n], factor) -
                                                       visibility_255(reference.depth[n], 1)));
    return paint(differences, options);
}

Image difference_map(const Image& reference, const Image& image,
                     const DifferenceMapOptions& options) {
    require_same_size(reference, image);
    Differences differences{reference.width, reference.height, {}, false, {}, "|B-A|"};
    differences.colors = named_transfer_function("inferno");
    const std::vector<Rgb8> a = color_bytes(reference), b = color_bytes(image);
    for (std::size_t n = 0; n < a.size(); ++n) {
        int largest = 0;
        for (int c = 0; c < 3; ++c)
            largest = std::max(largest, std::abs(int{b[n].channel[c]} - int{a[n].channel[c]}));
        differences.value.push_back(static_cast<float>(largest));
    }
    return paint(differences, options);
}

}  // namespace vog
