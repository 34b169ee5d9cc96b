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

/// Unit in which numbers up to `largest` are floats: 1, or the power of ten of a largest that is beyond or below their range.
inline double float_unit(double largest) {
    using Float = std::numeric_limits<float>;
    const bool fits = largest >= double{Float::min()} && largest <= double{Float::max()};
    if (fits || largest == 0 || !std::isfinite(largest)) return 1;
    return std::pow(10, std::floor(std::log10(largest)));
}

}  // namespace vog
