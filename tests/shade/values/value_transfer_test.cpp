// value_transfer_test.cpp: colour and extinction of values.
#include "vog/value_transfer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

#include "render/by_value/value_pieces.h"
#include "support/data.h"
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
    EXPECT_THROW(over_range(TransferFunction{"t", {{0, 0, 0, 0}}, {}}, 3, 3, 1), Error);
    EXPECT_THROW(light_of(two_points(), std::nan("")), Error);
}

TEST(value_transfer, pieces_are_light_of) {
    const ValueTransfer transfers[] = {
        two_points(),
        {"one", {{5, 1, 0.5f, 0}}, {{5, 0.3}}, 2},
        {"steps",
         {{0, 0, 0, 0}, {1, 1, 1, 1}, {1, 0, 1, 0}, {7, 1, 0, 1}},
         {{-3, 1}, {-3, 0}, {0.5, 0.2}, {0.5, 0}, {2, 0.9}, {2, 0}, {2, 0.1}},
         0.1},
        {"wide", {{-1e300, 0, 0, 0}, {1e300, 1, 1, 1}}, {{-1e-300, 0}, {1e-300, 1}}, 1},
        {"narrow",
         {{0, 0, 0, 0}, {1e9, 1, 1, 1}},
         {{1, 0}, {1, 0.5}, {1.0000001, 0.5}, {1.0000001, 0}},
         1}};
    for (const ValueTransfer& transfer : transfers) {
        SCOPED_TRACE(transfer.name);
        const by_value::ValuePieces pieces(transfer);
        std::vector<double> values{-1e300, -1e30, -4,  -1e-301, 0,   0.25, 1.5,
                                   1.9999, 6.99,  150, 250,     1e8, 1e30};
        const auto add = [&](double v) {
            for (const double end : {-HUGE_VAL, HUGE_VAL}) values.push_back(std::nextafter(v, end));
            values.push_back(v);
        };
        for (const ValueColor& point : transfer.color) add(point.value);
        for (const ValueOpacity& point : transfer.opacity) add(point.value);
        for (const double value : values) {
            const ValueLight expected = light_of(transfer, value), got = pieces(value);
            EXPECT_NEAR(got.extinction, expected.extinction, 1e-9 * (1 + expected.extinction))
                << value;
            EXPECT_NEAR(got.r, expected.r, 1e-12) << value;
            EXPECT_NEAR(got.g, expected.g, 1e-12) << value;
            EXPECT_NEAR(got.b, expected.b, 1e-12) << value;
        }
    }
}

TEST(value_transfer, a_window_ramps_and_bands_have_steps) {
    const ValueTransfer window = window_transfer(40, 400, 2);
    EXPECT_EQ(light_of(window, -160).extinction, 0);
    EXPECT_DOUBLE_EQ(light_of(window, 40).r, 0.5);
    EXPECT_DOUBLE_EQ(light_of(window, 40).extinction, -std::log(1 - kMostOpacity / 2) / 2);
    EXPECT_DOUBLE_EQ(light_of(window, 1e4).extinction, -std::log(1 - kMostOpacity) / 2);
    EXPECT_THROW(window_transfer(40, 0, 2), Error);

    constexpr double kNoEnd = std::numeric_limits<double>::infinity();
    const ValueTransfer bands =
        band_transfer({{3, kNoEnd, 0, 0, 1, 1}, {1, 2, 1, 0, 0, 0.5}, {2, 2.5, 0, 1, 0, 0.25}}, 1);
    EXPECT_EQ(light_of(bands, 0.999).extinction, 0);
    EXPECT_DOUBLE_EQ(light_of(bands, 1).extinction, std::log(2));
    EXPECT_EQ(light_of(bands, 1.999).r, 1);
    EXPECT_DOUBLE_EQ(light_of(bands, 2).extinction, -std::log(0.75));  // from lower on, below upper
    EXPECT_EQ(light_of(bands, 2).g, 1);
    EXPECT_EQ(light_of(bands, 2.5).extinction, 0);
    EXPECT_EQ(light_of(bands, 1e9).b, 1);
    EXPECT_DOUBLE_EQ(light_of(bands, 1e9).extinction, -std::log(1 - kMostOpacity));
    EXPECT_THROW(band_transfer({}, 1), Error);
    EXPECT_THROW(band_transfer({{2, 1, 0, 0, 0, 1}}, 1), Error);
    EXPECT_THROW(band_transfer({{0, 2, 0, 0, 0, 1}, {1, 3, 0, 0, 0, 1}}, 1), Error);
    EXPECT_THROW(band_transfer({{0, 2, 0, 0, 0, 1.5}}, 1), Error);
    EXPECT_THROW(band_transfer({{0, 2, 0, 0, 0, 1}}, -1), Error);
}

TEST(value_transfer, a_threshold_hides_what_is_below) {
    const ValueTransfer all = two_points(), cut = above(all, 150);
    EXPECT_EQ(light_of(cut, 149.999).extinction, 0);
    for (const double value : {150.0, 170.0, 200.0, 1000.0})
        EXPECT_DOUBLE_EQ(light_of(cut, value).extinction, light_of(all, value).extinction);
    EXPECT_EQ(light_of(above(all, 500), 499.0).extinction, 0);
    EXPECT_EQ(light_of(above(all, 500), 500.0).extinction, light_of(all, 500).extinction);
    EXPECT_DOUBLE_EQ(most_opacity(all, 0, 150), 0.25);
    EXPECT_DOUBLE_EQ(most_opacity(all, 0, 1e9), 0.75);
    EXPECT_EQ(most_opacity(cut, 0, 149), 0);
}

class value_transfer_files : public testing::Test {
  protected:
    ValueTransfer read(const std::string& text, double lower = 0, double upper = 1) const {
        std::ofstream(dir_ / "tf.json") << text;
        return read_value_transfer((dir_ / "tf.json").string(), lower, upper, 5);
    }
    void refused(const std::string& text, const std::string& why) const {
        try {
            read(text);
            ADD_FAILURE() << "accepted: " << text;
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
        }
    }
    test::TempDir dir_;
};

TEST_F(value_transfer_files, a_domain_makes_points_data_values) {
    const std::string text = R"({"name": "ct", "domain": [-1000, 3000], "unit_distance": 2.5,
        "colors": [[-200, 1, 0, 0], [300, 1, 1, 1]], "opacity": [[-200, 0], [300, 0.5], [3500, 1]]})";
    const ValueTransfer transfer = read(text, 0, 1);
    EXPECT_EQ(transfer.color[0].value, -200);
    EXPECT_EQ(transfer.opacity[2].value, 3500);
    EXPECT_EQ(transfer.unit_distance, 2.5);
    // V of pictures of T: shares of the domain, clipped to it.
    const TransferFunction tf = read_transfer_function(dir_ / "tf.json");
    EXPECT_EQ(tf.color[0].v, 0.2f);
    EXPECT_EQ(tf.opacity.back().v, 1);
    EXPECT_FLOAT_EQ(tf.opacity.back().opacity, 0.5f + 0.5f * 2700 / 3200);
    // The domain places a map by its name, and the ramp of a file without opacity.
    const ValueTransfer named = read(R"({"domain": [10, 30], "colors": "gray"})");
    EXPECT_EQ(named.color.front().value, 10);
    EXPECT_EQ(named.color.back().value, 30);
    EXPECT_DOUBLE_EQ(light_of(named, 20).extinction, -std::log(0.5) / 5);
}

TEST_F(value_transfer_files, without_a_domain_points_are_shares_of_the_range) {
    const ValueTransfer transfer =
        read(R"({"colors": [[0, 0, 0, 0], [1, 1, 1, 1]], "opacity": [[0.25, 0.5]]})", 100, 300);
    EXPECT_EQ(transfer.opacity[0].value, 150);
    EXPECT_EQ(transfer.color[1].value, 300);
    EXPECT_EQ(transfer.unit_distance, 5);
    const ValueTransfer named = read_value_transfer("viridis", -2, 2, 7);
    EXPECT_EQ(named.color.front().value, -2);
    EXPECT_EQ(named.opacity.back().value, 2);
    EXPECT_EQ(named.unit_distance, 7);
}

TEST_F(value_transfer_files, of_paraview_keep_their_values) {
    const ValueTransfer transfer = read(
        R"([{"Name": "p", "ColorSpace": "Lab", "RGBPoints": [500, 1, 0, 0, 500.3, 0, 1, 0, 501, 0, 0, 1],
        "Points": [400, 0, 0.5, 0, 500.3, 0.25, 0.5, 0, 900, 1, 0.5, 0], "ScalarOpacityUnitDistance": 3}])");
    EXPECT_EQ(transfer.color.front().value, 500);
    EXPECT_EQ(transfer.color.back().value, 501);
    EXPECT_TRUE(
        std::ranges::any_of(transfer.color, [](const ValueColor& p) { return p.value == 500.3; }));
    EXPECT_EQ(transfer.opacity.front().value, 400);
    EXPECT_EQ(light_of(transfer, 500.3).extinction, -std::log(0.75) / 3);
    EXPECT_EQ(transfer.opacity.back().value, 900);
}

TEST_F(value_transfer_files, that_are_wrong_are_refused_in_one_line) {
    const std::string colors = R"("colors": [[0, 0, 0, 0], [1, 1, 1, 1]])";
    refused("{" + colors + R"(, "domain": [3, 3]})",
            "tf.json: domain: 3 to 3, expected the first below");
    refused("{" + colors + R"(, "domain": [3]})",
            "tf.json: domain: expected an array of 2 numbers");
    refused("{" + colors + R"(, "domain": [3, "a"]})",
            "tf.json: domain: string, expected a number");
    refused("{" + colors + R"(, "unit_distance": -2})",
            "tf.json: unit_distance: -2, expected a length");
    refused("{" + colors + R"(, "unit": 1})", "unknown key 'unit'");
    refused("{" + colors + R"(, "domain": [0, 9], "opacity": [[5, 0], [4, 1]]})",
            "expected sorted points");
    refused("{" + colors + R"(, "opacity": [[5, 0]]})",
            "opacity point 0: expected numbers in [0, 1]");
    refused("{" + colors + R"(, "domain": [0, 9], "opacity": [[20, 7]]})", "in [0, 1]");
}

}  // namespace
}  // namespace vog
