// bfloat16.h: floats of 16 bits with the range of 32: the upper half, cut off.
#pragma once

#include <bit>
#include <cstdint>

namespace vog {

/// Sign, 8 bits of exponent, 7 of mantissa: a relative error below 2^-7.
using BFloat16 = std::uint16_t;

/// Towards zero.
inline BFloat16 to_bfloat16(float value) {
    return static_cast<BFloat16>(std::bit_cast<std::uint32_t>(value) >> 16);
}
inline float from_bfloat16(BFloat16 value) {
    return std::bit_cast<float>(std::uint32_t{value} << 16);
}

}  // namespace vog
