// value_transfer_test.cpp: colour and extinction of values.
#include "vog/value_transfer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "vog/error.h"

namespace vog {
namespace {

ValueTransfer two_points() {
    return {"two", {{100, 1, 0, 0}, {300, 0, 0.5f, 1}}, {{100, 0}, {200, 0.5}, {200, 0.75}}, 2};
}

TEST(value_transfer, opacity_and_colour_are_linear_between_points) {
    const ValueTransfer transfer = two_points();
    const ValueLight quarter = light_of(transfer, 150);
    EXPECT_DOUBLE_EQ(quarter.extinction, -std::log(1 - 0.25) / 2);
    EXPECT_DOUBLE_EQ(quarter.r, 0.75);
    EXPECT_DOUBLE_EQ(quarter.g, 0.125);
    EXPECT_DOUBLE_EQ(quarter.b, 0.25);
    // A step: at the value the second point holds, beyond the ends the last.
    EXPECT_DOUBLE_EQ(light_of(transfer, 200).extinction, -std::log(0.25) / 2);
    EXPECT_DOUBLE_EQ(light_of(transfer, std::nextafter(200.0, 0)).extinction, -std::log(0.5) / 2);
    EXPECT_DOUBLE_EQ(light_of(transfer, 1e300).extinction, -std::log(0.25) / 2);
    EXPECT_EQ(light_of(transfer, -1e300).extinction, 0);
    EXPECT_EQ(light_of(transfer, -1e300).r, 1);
}

TEST(value_transfer, opacity_1_is_a_finite_extinction) {
    ValueTransfer transfer = two_points();
    transfer.opacity = {{0, 1}};
    EXPECT_DOUBLE_EQ(light_of(transfer, 0).extinction, -std::log(1 - kMostOpacity) / 2);
}

TEST(value_transfer, shares_of_a_range_become_values) {
    const TransferFunction tf{"t", {{0, 0, 0, 0}, {0.5f, 1, 1, 1}}, {}};
    const ValueTransfer transfer = over_range(tf, -1000, 3000, 5);
    EXPECT_EQ(transfer.color[1].value, 1000);
    EXPECT_EQ(transfer.unit_distance, 5);
    EXPECT_DOUBLE_EQ(light_of(transfer, 0).extinction, -std::log(0.75) / 5);  // a ramp
}

TEST(value_transfer, what_is_wrong_is_refused_in_one_line) {
    const auto refused = [](auto change) {
        ValueTransfer transfer = two_points();
        change(transfer);
        try {
            validate(transfer);
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string("accepted");
    };
    const std::string where = "transfer function two: ";
    EXPECT_EQ(refused([](auto& t) { t.color.clear(); }),
              where + "no points of colour, expected at least one");
    EXPECT_EQ(refused([](auto& t) { t.opacity[1].value = 50; }),
              where + "opacity at 50 after 100, expected sorted points");
    EXPECT_EQ(refused([](auto& t) { t.color[0].g = 1.5f; }),
              where + "colour component 1.5 at 100, expected in [0, 1]");
    EXPECT_EQ(refused([](auto& t) { t.opacity[0].opacity = -0.1; }),
              where + "opacity -0.1 at 100, expected in [0, 1]");
    EXPECT_EQ(refused([](auto& t) { t.unit_distance = 0; }),
              where + "unit_distance 0, expected a finite length > 0");
    EXPECT_EQ(refused([](auto& t) { t.color[0].value = std::nan(""); }),
              where + "colour at a value of nan, expected finite");
    EXPECT_THROW(over_range({"t", {{0, 0, 0, 0}}, {}}, 3, 3, 1), Error);
    EXPECT_THROW(light_of(two_points(), std::nan("")), Error);
}

}  // namespace
}  // namespace vog
