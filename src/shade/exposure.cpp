// exposure.cpp: extinction that brings a picture of T to a mean luminance in the middle.
#include "vog/exposure.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "shade/named_extinction.h"
#include "shade/ramp.h"
#include "vog/shade.h"

namespace vog {

namespace {

/// Depths of nearly one size: their sum and number.
struct Depths {
    double sum = 0, count = 0;
};

/// Depths above 0 times a factor, in bins of a 32nd of a power of two: the upper 14 bits of floats.
std::vector<Depths> bins_of(const std::vector<float>& depths, double factor) {
    constexpr int kLowerBits = 18;
    std::vector<Depths> bins(std::size_t{1} << (31 - kLowerBits));
    for (const float depth : depths) {
        const auto scaled = static_cast<float>(factor * double{depth});
        if (!(scaled > 0)) continue;
        Depths& bin = bins[std::bit_cast<std::uint32_t>(scaled) >> kLowerBits];
        bin.sum += double{scaled}, ++bin.count;
    }
    std::erase_if(bins, [](const Depths& bin) { return bin.count == 0; });
    return bins;
}

/// Mean luminance of depths times a factor, as shade() colours them on black; 0.2126 R + 0.7152 G + 0.0722 B of sRGB values.
double mean_luminance(const std::vector<Depths>& bins, const shading::Ramp<3>& color,
                      double factor) {
    // Opacity from which a pixel counts as one: no jumps as it grows.
    constexpr double kShown = 0.02;
    double light = 0, shown = 0;
    for (const auto& [sum, count] : bins) {
        const double seen = -std::expm1(-factor * sum / count);
        const double opacity = std::min(seen / double{kRim}, 1.0);
        const double pixels = count * std::min(opacity / kShown, 1.0);
        const auto [r, g, b] = color(static_cast<float>(seen));
        light += pixels * opacity * (0.2126 * double{r} + 0.7152 * double{g} + 0.0722 * double{b});
        shown += pixels;
    }
    return light / shown;
}

}  // namespace

double picture_extinction(const DepthImage& image, const std::string& source) {
    constexpr double kLeast = 0.40, kMost = 0.55, kFarthest = 2;  // powers of two
    const double usual = shading::auto_extinction_of(image, source);
    const std::vector<Depths> bins = bins_of(image.depth, usual / image.extinction);
    if (bins.empty()) return usual;
    const shading::Ramp<3> color(named_transfer_function(kDefaultMap).color);
    const double first = mean_luminance(bins, color, 1);
    if (first >= kLeast && first <= kMost) return usual;
    // Bisection of the exponent to the accuracy of floats.
    const bool is_dark = first < kLeast;
    double inside = is_dark ? kFarthest : -kFarthest, outside = 0;
    for (int step = 0; step < 32; ++step) {
        const double exponent = 0.5 * (inside + outside);
        const double mean = mean_luminance(bins, color, std::exp2(exponent));
        (is_dark ? mean >= kLeast : mean <= kMost) ? inside = exponent : outside = exponent;
    }
    return usual * std::exp2(inside);
}

}  // namespace vog
