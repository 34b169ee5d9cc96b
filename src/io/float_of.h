// float_of.h: doubles as floats, where they may lie beyond float's range.
#pragma once

#include <cmath>
#include <limits>

namespace vog {

/// value / unit, infinite beyond float's range, where a conversion is undefined behaviour.
inline float float_of(double value, double unit = 1) {
    constexpr float kInfinite = std::numeric_limits<float>::infinity();
    const double scaled = value / unit;
    if (std::abs(scaled) > double{std::numeric_limits<float>::max()})
        return scaled < 0 ? -kInfinite : kInfinite;
    return static_cast<float>(scaled);
}

/// Unit in which numbers up to `largest` are floats: 1, or the power of ten of the largest.
inline double float_unit(double largest) {
    return std::isfinite(largest) && largest > double{std::numeric_limits<float>::max()}
               ? std::pow(10, std::floor(std::log10(largest)))
               : 1;
}

}  // namespace vog
