// morton.cpp: Morton order of 32-bit indices, by the highest differing bit instead of 96-bit codes.
#include "core/morton.h"

namespace vog {

namespace {

/// Whether the highest set bit of a lies below that of b.
bool lower_bit(std::uint32_t a, std::uint32_t b) { return a < b && a < (a ^ b); }

}  // namespace

bool morton_less(Vec3i a, Vec3i b) {
    // The axis whose coordinates differ in the highest bit decides; flipping the sign bit orders
    // negative indices before positive ones.
    constexpr std::uint32_t kSign = 0x80000000u;
    int decides = 0;
    std::uint32_t highest = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const std::uint32_t difference =
            static_cast<std::uint32_t>(a[axis]) ^ static_cast<std::uint32_t>(b[axis]);
        if (lower_bit(highest, difference)) {
            highest = difference;
            decides = axis;
        }
    }
    return (static_cast<std::uint32_t>(a[decides]) ^ kSign) <
           (static_cast<std::uint32_t>(b[decides]) ^ kSign);
}

}  // namespace vog
