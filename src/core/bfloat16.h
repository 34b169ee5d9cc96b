// bfloat16.h: 16-bit floats, the upper half of a float32.
#pragma once

#include <bit>
#include <cstdint>

namespace vog {

/// Bits of a bfloat16: sign, 8 of exponent, 7 of mantissa; relative error below 2^-7.
using BFloat16 = std::uint16_t;

/// Rounds towards zero.
inline BFloat16 to_bfloat16(float value) {
    return static_cast<BFloat16>(std::bit_cast<std::uint32_t>(value) >> 16);
}
inline float from_bfloat16(BFloat16 value) {
    return std::bit_cast<float>(std::uint32_t{value} << 16);
}

}  // namespace vog
