// quantity_test.cpp: scales, ticks, colour bars and numbers of column density maps.
#include "vog/quantity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "shade/annotation/bitmap_font.h"
#include "shade/annotation/ticks.h"
#include "support/command.h"
#include "support/data.h"
#include "support/refused_files.h"
#include "vog/error.h"

namespace vog {
namespace {

using Kind = ColorScale::Kind;
using test::error_of;

DepthImage values_of(std::vector<float> values, double extinction = 1) {
    DepthImage image(static_cast<int>(values.size()), 1);
    image.depth = std::move(values);
    image.extinction = extinction;
    return image;
}

bool same_color(const Rgba& a, const Rgba& b) {
    return std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b) < 1e-6f;
}

TEST(quantity, column_density_is_t_without_extinction) {
    const DepthImage column = column_density(values_of({0, 3, 6}, 1.5));
    EXPECT_EQ(column.extinction, 1);
    EXPECT_EQ(column.depth, (std::vector<float>{0, 2, 4}));
}

TEST(quantity, positions_follow_the_scale_and_end_at_its_range) {
    const ColorScale linear{Kind::linear, 2, 6}, log{Kind::log, 0.01, 100};
    EXPECT_DOUBLE_EQ(scale_position(linear, 3), 0.25);
    EXPECT_EQ(scale_position(linear, 1), 0);
    EXPECT_EQ(scale_position(linear, 7), 1);
    EXPECT_NEAR(scale_position(log, 1), 0.5, 1e-12);
    EXPECT_EQ(scale_position(log, 0), 0);
    EXPECT_DOUBLE_EQ(scale_position({}, 1), 1 - std::exp(-1.0));
}

TEST(quantity, invalid_scales_are_refused) {
    for (const ColorScale& scale :
         {ColorScale{Kind::linear, 1, 1}, ColorScale{Kind::linear, 2, 1},
          ColorScale{Kind::linear, 0, INFINITY}, ColorScale{Kind::log, 0, 1},
          ColorScale{Kind::log, -1, 1}, ColorScale{Kind::linear, NAN, 1}})
        EXPECT_NE(error_of([&] { (void)scale_position(scale, 1); }).find("expected finite numbers"),
                  std::string::npos);
}

TEST(quantity, automatic_scales_span_the_values) {
    const DepthImage image = values_of({0, 0.5f, 8});
    const ColorScale linear = automatic_scale({&image, 1}, ScaleFit::linear);
    EXPECT_EQ(linear.low, 0);
    EXPECT_EQ(linear.high, 8);
    EXPECT_EQ(automatic_scale({&image, 1}, ScaleFit::log).low, 0.5);
    const DepthImage wide = values_of({1e-9f, 8});
    EXPECT_DOUBLE_EQ(automatic_scale({&wide, 1}, ScaleFit::log).low, 8e-4);
    const DepthImage one = values_of({8});
    EXPECT_DOUBLE_EQ(automatic_scale({&one, 1}, ScaleFit::log).low, 0.8);
    const DepthImage empty = values_of({0, 0});
    EXPECT_EQ(automatic_scale({&empty, 1}, ScaleFit::linear).high, 1);
    EXPECT_NO_THROW((void)scale_position(automatic_scale({&empty, 1}, ScaleFit::log), 0));
}

TEST(quantity, values_are_coloured_by_position_and_empty_pixels_by_the_background) {
    const TransferFunction gray = named_transfer_function("gray");
    const Rgba red{1, 0, 0, 1};
    const Image image =
        shade_values(values_of({0, 0.1f, 5, 10, 20}), gray, {Kind::linear, 0, 10}, {red});
    EXPECT_EQ(image.at(0, 0), red);
    EXPECT_NEAR(image.at(1, 0).r, 0.01, 1e-6);
    EXPECT_NEAR(image.at(2, 0).r, 0.5, 1e-6);
    EXPECT_EQ(image.at(3, 0), (Rgba{1, 1, 1, 1}));
    EXPECT_EQ(image.at(4, 0), (Rgba{1, 1, 1, 1}));
    EXPECT_THROW(shade_values(values_of({1}), gray, {Kind::linear, 0, 1}, {red, true}), Error);
}

TEST(quantity, automatic_scales_are_logarithmic_where_values_crowd_below) {
    std::vector<float> even, crowded;
    for (int n = 1; n <= 100; ++n) {
        even.push_back(static_cast<float>(n));
        crowded.push_back(static_cast<float>(std::exp(0.1 * n)));
    }
    const auto of = [](const std::vector<float>& values) {
        DepthImage image(10, static_cast<int>(values.size() / 10));
        image.depth = values;
        return automatic_scale({&image, 1}, ScaleFit::automatic).kind;
    };
    EXPECT_EQ(of(even), Kind::linear);
    EXPECT_EQ(of(crowded), Kind::log);
    EXPECT_EQ(fitted_scale(even, ScaleFit::automatic).kind, Kind::linear);
    EXPECT_EQ(fitted_scale(crowded, ScaleFit::automatic).kind, Kind::log);
    EXPECT_EQ(fitted_scale(crowded, ScaleFit::linear).kind, Kind::linear);
    crowded.insert(crowded.end(), 30, 0.0f);  // a logarithmic scale has no place for them
    EXPECT_EQ(fitted_scale(crowded, ScaleFit::automatic).kind, Kind::log);
    EXPECT_GT(fitted_scale(crowded, ScaleFit::automatic).low, 1);
    crowded.back() = -1;
    EXPECT_EQ(fitted_scale(crowded, ScaleFit::automatic).kind, Kind::linear);
    EXPECT_EQ(fitted_scale(std::vector<float>(5, 0.0f), ScaleFit::automatic).kind, Kind::linear);
}

TEST(quantity, fitted_scales_span_percentiles) {
    std::vector<float> values{std::nanf("")};
    for (int n = 1; n <= 100; ++n) values.push_back(static_cast<float>(n) - 31);
    const ColorScale linear = fitted_scale(values, ScaleFit::linear);
    EXPECT_EQ(linear.low, -30);
    EXPECT_EQ(linear.high, 68);
    const ColorScale symmetric = fitted_scale(values, ScaleFit::symmetric);
    EXPECT_EQ(symmetric.low, -68);
    EXPECT_EQ(symmetric.high, 68);
    const ColorScale log = fitted_scale(values, ScaleFit::log);
    EXPECT_EQ(log.kind, Kind::log);
    EXPECT_EQ(log.low, 1);
    EXPECT_EQ(log.high, 69);
    const std::vector<float> wide{1e-9f, 1, 8}, same{300, 300}, zero{0}, none;
    EXPECT_DOUBLE_EQ(fitted_scale(wide, ScaleFit::log).low, 8e-4);
    for (const ScaleFit fit : {ScaleFit::linear, ScaleFit::log, ScaleFit::symmetric}) {
        EXPECT_NO_THROW((void)scale_position(fitted_scale(same, fit), 300));
        if (fit == ScaleFit::log) continue;
        EXPECT_NO_THROW((void)scale_position(fitted_scale(zero, fit), 0));
        EXPECT_NO_THROW((void)scale_position(fitted_scale(none, fit), 0));
    }
    EXPECT_THROW(fitted_scale(zero, ScaleFit::log), Error);
}

TEST(quantity, maps_are_coloured_where_they_have_a_value) {
    const TransferFunction gray = named_transfer_function("gray");
    const Rgba clear{1, 0, 0, 0};
    const ValueMap map{4, 1, {-2, 0, std::nanf(""), 2}};
    const Image image = shade_map(map, gray, {Kind::linear, -2, 2}, {clear});
    EXPECT_EQ(image.at(0, 0), (Rgba{0, 0, 0, 1}));
    EXPECT_NEAR(image.at(1, 0).r, 0.5, 1e-6);
    EXPECT_EQ(image.at(2, 0), clear);
    EXPECT_EQ(image.at(3, 0), (Rgba{1, 1, 1, 1}));
}

TEST(quantity, channels_need_values_for_every_pixel) {
    const std::vector<float> three{1, 2, 3};
    const NamedValues channels[] = {{"mean", three}};
    EXPECT_THROW(write_channels("unused.exr", 2, 2, channels), Error);
    EXPECT_THROW(write_map("unused.exr", {3, 1, three}), Error);
}

TEST(quantity, ticks_of_labels_are_whole_numbers) {
    std::vector<double> values;
    for (const auto& tick : shading::ticks_of({Kind::linear, 0.5, 2.5}, 0.01, true))
        values.push_back(tick.value);
    EXPECT_EQ(values, (std::vector<double>{1, 2}));
}

TEST(quantity, ticks_are_one_two_five_steps_or_decades) {
    EXPECT_EQ(scale_ticks({Kind::linear, 0, 3.7}, 0.01),
              (std::vector<double>{0, 0.5, 1, 1.5, 2, 2.5, 3, 3.5}));
    EXPECT_EQ(scale_ticks({Kind::linear, 0, 1}, 0.3), (std::vector<double>{0, 0.5, 1}));
    const auto texts = [](const ColorScale& scale, double gap) {
        std::vector<std::string> all;
        for (const double tick : scale_ticks(scale, gap)) all.push_back(tick_text(tick));
        return all;
    };
    using Texts = std::vector<std::string>;
    EXPECT_EQ(texts({Kind::linear, -0.3, 0.3}, 0.01),
              (Texts{"-0.3", "-0.2", "-0.1", "0", "0.1", "0.2", "0.3"}));
    EXPECT_EQ(texts({Kind::log, 1e-7, 1e-3}, 0.1),
              (Texts{"1e-7", "1e-6", "1e-5", "0.0001", "0.001"}));
    EXPECT_EQ(texts({Kind::log, 0.02, 3}, 0.05),
              (Texts{"0.02", "0.05", "0.1", "0.2", "0.5", "1", "2"}));
    EXPECT_EQ(texts({Kind::log, 1, 1e12}, 0.2), (Texts{"1", "1000", "1e6", "1e9", "1e12"}));
    EXPECT_GE(texts({Kind::log, 2.2, 3.1}, 0.05).size(), 2u) << "less than a factor of two";
    // T where V = 1 - exp(-T) leaves room.
    EXPECT_EQ(texts({}, 0.04), (Texts{"0", "0.1", "0.2", "0.5", "1", "2", "3", "5"}));
    EXPECT_EQ(texts({}, 0.2), (Texts{"0", "0.5", "1", "2"}));
}

TEST(quantity, ticks_keep_their_distance) {
    for (const ColorScale& scale :
         {ColorScale{}, ColorScale{Kind::linear, 0, 7.3}, ColorScale{Kind::log, 3e-5, 0.4},
          ColorScale{Kind::log, 1.1, 1.3}, ColorScale{Kind::linear, 1e20, 1.0000001e20}})
        for (const double gap : {0.02, 0.1, 0.5}) {
            const std::vector<double> ticks = scale_ticks(scale, gap);
            for (std::size_t n = 1; n < ticks.size(); ++n)
                EXPECT_GE(scale_position(scale, ticks[n]) - scale_position(scale, ticks[n - 1]),
                          gap * (1 - 1e-6));
        }
}

TEST(quantity, texts_of_ticks_differ_far_from_zero) {
    const auto texts = [](const ColorScale& scale) {
        std::vector<std::string> all;
        for (const shading::Tick& tick : shading::ticks_of(scale, 0.3)) all.push_back(tick.text);
        return all;
    };
    using Texts = std::vector<std::string>;
    EXPECT_EQ(texts({Kind::linear, 5.4e6, 5400016}),
              (Texts{"5400000", "5400005", "5400010", "5400015"}));
    EXPECT_EQ(texts({Kind::linear, -1000.00002, -999.99999}),
              (Texts{"-1000.00002", "-1000.00001", "-1000"}));
    EXPECT_EQ(texts({Kind::log, 1, 1e12}), (Texts{"1", "10000", "1e8", "1e12"}));
}

TEST(quantity, a_colour_bar_shows_every_value_at_its_tick) {
    const TransferFunction tf = named_transfer_function("viridis");
    const Rgba black{0, 0, 0, 1};
    for (const int side : {128, 256, 512, 1024})
        for (const ColorScale& scale :
             {ColorScale{}, ColorScale{Kind::linear, 0, 8}, ColorScale{Kind::log, 0.1, 1000}}) {
            const DepthImage values(side, side);
            const Image picture = shade_values(values, tf, {Kind::linear, 0, 1});
            const Image image = annotated(picture, tf, scale, {"", "column density [g]"});
            ASSERT_EQ(image.height, side);
            ASSERT_GT(image.width, side + 15);
            // The bar's columns: the ones that begin with tf(1) and end with tf(0).
            int column = side;
            const Rgba top = color_at(tf, 1), bottom = color_at(tf, 0);
            const auto is_bar = [&](int x) {
                bool has_top = false, has_bottom = false;
                for (int y = 0; y < side; ++y) {
                    const Rgba& c = image.at(x, y);
                    const auto near = [&](const Rgba& to) {
                        return std::abs(c.r - to.r) + std::abs(c.g - to.g) + std::abs(c.b - to.b) <
                               0.1f;
                    };
                    has_top |= near(top);
                    has_bottom |= near(bottom);
                }
                return has_top && has_bottom;
            };
            while (column < image.width && !is_bar(column)) ++column;
            ASSERT_LT(column, image.width);
            // Ticks are as many as scale_ticks finds, and lie where the bar has their colours.
            int right = column;
            while (is_bar(right)) ++right;
            const int frame = std::max(1, static_cast<int>(std::lround(side / 252.0)));
            std::vector<int> rows;
            const int x = right + frame;  // right of the bar and its frame
            for (int y = 0; y < side; ++y)
                if (!same_color(image.at(x, y), black) &&
                    (y == 0 || same_color(image.at(x, y - 1), black)))
                    rows.push_back(y + frame / 2);
            EXPECT_GE(rows.size(), 4u);
            for (const int row : rows) {
                const Rgba c =
                    image.at(column, std::min(std::max(row, 5 * frame), side - 1 - 5 * frame));
                double best = 1;
                for (const double tick : scale_ticks(scale, 0.01)) {
                    const Rgba at = color_at(tf, static_cast<float>(scale_position(scale, tick)));
                    best = std::min(best, double{std::abs(c.r - at.r) + std::abs(c.g - at.g) +
                                                 std::abs(c.b - at.b)});
                }
                // Ticks at the ends are compared five frames inside, up to 4 % of the bar.
                EXPECT_LT(best, 0.1) << "side " << side << ", row " << row;
            }
        }
}

TEST(quantity, annotation_keeps_the_picture_and_refuses_text_it_cannot_draw) {
    const TransferFunction tf = named_transfer_function("gray");
    const DepthImage values = values_of({0, 1, 2, 3});
    DepthImage large(40, 30);
    for (std::size_t n = 0; n < large.depth.size(); ++n) large.depth[n] = float(n % 7);
    const ColorScale scale{Kind::linear, 0, 7};
    const Image picture = shade_values(large, tf, scale);
    const Image image = annotated(picture, tf, scale, {"cm³", "", false}, {1, 1, 1, 1});
    EXPECT_EQ(image.width, picture.width);
    const int top = image.height - picture.height;
    EXPECT_GT(top, 7);
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) ASSERT_EQ(image.at(x, top + y), picture.at(x, y));
    int ink = 0;
    for (int y = 0; y < top; ++y)
        for (int x = 0; x < image.width; ++x) ink += image.at(x, y) == Rgba{0, 0, 0, 1};
    EXPECT_GT(ink, 20) << "dark text on white";
    EXPECT_NE(error_of([&] {
                  (void)annotated(picture, tf, scale, {"日", "", false});
              }).find("no glyph"),
              std::string::npos);
    EXPECT_NE(error_of([&] {
                  (void)annotated(picture, tf, scale, {std::string(40, 'w'), "", false});
              }).find("239 pixels wide"),
              std::string::npos);
    EXPECT_EQ(annotated(picture, tf, scale, {"", "", false}).pixel, picture.pixel);
}

TEST(quantity, text_is_drawn_in_whole_multiples_and_upwards) {
    const Rgba white{1, 1, 1, 1};
    Image one(20, 12), three(60, 36), up(12, 20);
    shading::draw_text(one, 1, 1, "Lp", white);
    shading::draw_text(three, 3, 3, "Lp", white, {3});
    shading::draw_text(up, 1, 18, "Lp", white, {1, true});
    for (int y = 0; y < three.height; ++y)
        for (int x = 0; x < three.width; ++x)
            ASSERT_EQ(three.at(x, y) == white, one.at(x / 3, y / 3) == white) << x << " " << y;
    for (int y = 0; y < 10; ++y)
        for (int x = 0; x < 17; ++x)
            ASSERT_EQ(one.at(1 + x, 1 + y) == white, up.at(1 + y, 17 - x) == white);
    EXPECT_EQ(shading::text_width("cm³", 2), 2 * 17);
}

TEST(quantity, values_are_written_as_numpy_and_exr_read_them) {
    const test::TempDir dir;
    DepthImage values(3, 2);
    values.depth = {0, 1, 2, 3, 4, 0.5f};
    write_values(dir / "v.npy", values);
    const std::string bytes = test::read_text(dir / "v.npy");
    ASSERT_EQ(bytes.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
    const std::size_t header =
        static_cast<unsigned char>(bytes[8]) + 256u * static_cast<unsigned char>(bytes[9]);
    EXPECT_EQ((10 + header) % 64, 0u);
    EXPECT_NE(bytes.find("'descr': '<f4', 'fortran_order': False, 'shape': (2, 3)"),
              std::string::npos);
    ASSERT_EQ(bytes.size(), 10 + header + 6 * sizeof(float));
    std::vector<float> read(6);
    std::memcpy(read.data(), bytes.data() + 10 + header, 6 * sizeof(float));
    EXPECT_EQ(read, values.depth);
    write_values(dir / "v.exr", values);
    EXPECT_EQ(read_depth(dir / "v.exr").depth, values.depth);
    EXPECT_NE(error_of([&] { write_values(dir / "v.png", values); }).find("expected .npy or .exr"),
              std::string::npos);
}

}  // namespace
}  // namespace vog
