// morton_test.cpp: Morton codes and order against interleaving bit by bit.
#include "core/morton.h"

#include <gtest/gtest.h>

#include <array>
#include <bitset>
#include <cstdint>
#include <random>
#include <string>

namespace vog {
namespace {

/// Digits of the lower `bits` bits of three coordinates, interleaved from the highest down.
std::string interleaved(std::array<std::uint32_t, 3> axis, int bits) {
    std::string digits;
    for (int bit = bits - 1; bit >= 0; --bit)
        for (const std::uint32_t value : axis) digits += value / (1u << bit) % 2 ? '1' : '0';
    return digits;
}

TEST(morton, codes_interleave_the_bits_of_all_axes) {
    static_assert(morton_code(1, 0, 0) == 4 && morton_code(0, 1, 0) == 2);
    constexpr std::uint32_t kLast = (1u << kMortonAxisBits) - 1;
    EXPECT_EQ(morton_code(kLast, kLast, kLast), (std::uint64_t{1} << 63) - 1);
    std::mt19937 random(1);
    for (int n = 0; n < 10000; ++n) {
        const std::array<std::uint32_t, 3> at{std::uint32_t(random()) & kLast,
                                              std::uint32_t(random()) & kLast,
                                              std::uint32_t(random()) & kLast};
        ASSERT_EQ(std::bitset<63>(morton_code(at[0], at[1], at[2])).to_string(),
                  interleaved(at, kMortonAxisBits));
    }
}

TEST(morton, bits_beyond_an_axis_are_dropped) {
    EXPECT_EQ(spread_bits(~std::uint64_t{0}), spread_bits((1u << kMortonAxisBits) - 1));
    EXPECT_EQ(spread_bits(1u << kMortonAxisBits), 0u);
}

TEST(morton, place_inverts_every_code_of_a_cube_of_16) {
    for (int code = 0; code < 16 * 16 * 16; ++code) {
        const Vec3i at = morton_place(code);
        ASSERT_TRUE(at.x < 16 && at.y < 16 && at.z < 16) << code;
        ASSERT_EQ(interleaved({std::uint32_t(at.x), std::uint32_t(at.y), std::uint32_t(at.z)}, 4),
                  std::bitset<12>(static_cast<unsigned>(code)).to_string());
    }
}

TEST(morton, order_is_that_of_codes_with_negative_indices_first) {
    std::mt19937 random(2);
    // Few distinct values, so that axes often agree in their high bits.
    constexpr std::array<std::int32_t, 8> kValues{INT32_MIN, -4097, -8, -1, 0, 1, 7, INT32_MAX};
    const auto index = [&] {
        const auto axis = [&] { return kValues[random() % kValues.size()]; };
        const std::int32_t x = axis(), y = axis(), z = axis();
        return Vec3i{x, y, z};
    };
    const auto digits = [](Vec3i v) {  // offset by 2^31: unsigned, in the same order
        const auto shifted = [](std::int32_t value) {
            return static_cast<std::uint32_t>(std::int64_t{value} - INT32_MIN);
        };
        return interleaved({shifted(v.x), shifted(v.y), shifted(v.z)}, 32);
    };
    for (int n = 0; n < 10000; ++n) {
        const Vec3i a = index(), b = index();
        ASSERT_EQ(morton_less(a, b), digits(a) < digits(b))
            << a.x << ' ' << a.y << ' ' << a.z << " / " << b.x << ' ' << b.y << ' ' << b.z;
    }
}

TEST(morton, aligned_rounds_towards_minus_infinity) {
    EXPECT_EQ(aligned({-1, 8, 15}, 3), (Vec3i{-8, 8, 8}));
    EXPECT_EQ(aligned({-9, 0, 7}, 3), (Vec3i{-16, 0, 0}));
    EXPECT_EQ(aligned({-9, 0, 7}, 0), (Vec3i{-9, 0, 7}));
}

}  // namespace
}  // namespace vog
