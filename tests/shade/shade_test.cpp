// shade_test.cpp: shading formula, named transfer functions, automatic extinction.
#include "vog/shade.h"
#include "vog/quantity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "support/data.h"
#include "vog/error.h"
#include "vog/progress.h"

namespace {

using namespace vog;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Tolerance of shaded values: a few float roundings of V and of the interpolation, both in [0, 1].
constexpr float kRounding = 1e-6f;

DepthImage depths(std::vector<float> values) {
    DepthImage image(static_cast<int>(values.size()), 1);
    image.depth = std::move(values);
    return image;
}

Rgba shade_one(float t, const TransferFunction& tf, const ShadeOptions& options = {}) {
    return shade(depths({t}), tf, options).at(0, 0);
}

void expect_near(const Rgba& got, const Rgba& expected, float tolerance, const std::string& where) {
    EXPECT_NEAR(got.r, expected.r, tolerance) << where;
    EXPECT_NEAR(got.g, expected.g, tolerance) << where;
    EXPECT_NEAR(got.b, expected.b, tolerance) << where;
    EXPECT_NEAR(got.a, expected.a, tolerance) << where;
}

/// White to red, half opaque at V = 0 and opaque at V = 1.
TransferFunction half_to_opaque() {
    return {"test", {{0, 1, 1, 1}, {1, 1, 0, 0}}, {{0, 0.5f}, {1, 1}}};
}

TEST(shade, color_is_that_of_visibility) {
    const TransferFunction gray = named_transfer_function("gray");
    for (const float t : {1e-6f, 0.01f, 0.5f, 1.0f, 4.0f, 20.0f, 1e30f}) {
        const auto v = static_cast<float>(-std::expm1(-double{t}));
        const float grey = v * std::min(v / kRim, 1.0f);
        expect_near(shade_one(t, gray), {grey, grey, grey, 1}, kRounding, std::to_string(t));
    }
}

TEST(shade, zero_depth_is_background_and_nothing_else_is) {
    const TransferFunction map{"map", {{0, 0, 1, 0}, {1, 0, 1, 0}}, {}};
    const ShadeOptions options{.background = {0.2f, 0.3f, 0.4f, 1}};
    EXPECT_EQ(shade_one(0, map, options), options.background);
    EXPECT_EQ(shade_one(-0.0f, map, options), options.background);
    EXPECT_EQ(shade_one(0.06f, map, options), (Rgba{0, 1, 0, 1}));
}

TEST(shade, rims_fade_out) {
    const TransferFunction map{"map", {{0, 0, 1, 0}, {1, 0, 1, 0}}, {}};
    const ShadeOptions options{.background = {1, 0, 0, 1}};
    const float t = -std::log1p(-0.4f * kRim);
    expect_near(shade_one(t, map, options), {0.6f, 0.4f, 0, 1}, kRounding, "two fifths");
    expect_near(shade_one(1e-30f, map, options), options.background, kRounding, "nearly nothing");
}

TEST(shade, blended_fog_has_no_dark_rim) {
    const auto luma = [](const Rgba& c) { return 0.2126f * c.r + 0.7152f * c.g + 0.0722f * c.b; };
    for (const char* name : {"ember", "white", "inferno", "magma", "hot", "gray", "cubehelix"})
        for (const Rgba& ground :
             {Rgba{0.2f, 0.4f, 0.6f, 1}, Rgba{0.1f, 0.3f, 0.1f, 1}, Rgba{0, 0, 0, 1}}) {
            const TransferFunction tf = named_transfer_function(name);
            for (float t = 0.01f; t < 6; t *= 1.1f) {
                const float least = std::min(luma(ground), 0.2f);
                EXPECT_GE(luma(shade_one(t, tf, {ground, true})), least - 1e-3f)
                    << name << " " << t;
            }
        }
}

TEST(shade, thin_fog_has_a_hue_on_black) {
    const Rgba thin = shade_one(0.06f, named_transfer_function(kDefaultMap));
    EXPECT_GT(0.2126f * thin.r + 0.7152f * thin.g + 0.0722f * thin.b, 0.2f);
    const Rgba white = shade_one(0.06f, named_transfer_function("white"));
    EXPECT_EQ(white, (Rgba{1, 1, 1, 1}));
}

TEST(shade, opacity_mixes_with_the_background) {
    const ShadeOptions options{.background = {0, 0.25f, 1, 1}};
    const float t = 0.7f, v = 1 - std::exp(-t), opacity = 0.5f + 0.5f * v;
    const auto mix = [&](float front, float back) {
        return opacity * front + (1 - opacity) * back;
    };
    expect_near(shade_one(t, half_to_opaque(), options),
                {mix(1, 0), mix(1 - v, 0.25f), mix(1 - v, 1), 1}, kRounding, "opaque background");
}

TEST(shade, blend_multiplies_opacity_by_visibility) {
    const ShadeOptions options{.background = {0, 0, 0.5f, 1}, .blend = true};
    const float t = 0.3f, v = 1 - std::exp(-t);
    expect_near(shade_one(t, named_transfer_function("white-red"), options),
                {v, v * (1 - v), v * (1 - v) + (1 - v) * 0.5f, 1}, kRounding,
                "map without opacity");
    const float opacity = v * (0.5f + 0.5f * v);
    expect_near(shade_one(t, half_to_opaque(), options),
                {opacity, opacity * (1 - v), opacity * (1 - v) + (1 - opacity) * 0.5f, 1},
                kRounding, "map with opacity");
}

TEST(shade, clear_background_gives_straight_alpha) {
    const ShadeOptions clear{.background = {0.1f, 0.2f, 0.3f, 0}};
    const float t = 0.7f, v = 1 - std::exp(-t);
    EXPECT_EQ(shade_one(0, half_to_opaque(), clear), clear.background);
    expect_near(shade_one(t, half_to_opaque(), clear), {1, 1 - v, 1 - v, 0.5f + 0.5f * v},
                kRounding, "color undimmed, alpha = opacity");
    const TransferFunction invisible{"none", {{0, 1, 1, 1}}, {{0, 0}}};
    EXPECT_EQ(shade_one(t, invisible, clear).a, 0);
    // Half transparent background: Porter-Duff over with straight alpha.
    const ShadeOptions half{.background = {0, 0, 1, 0.5f}};
    const float a = 0.5f + 0.5f * v, alpha = a + 0.5f * (1 - a);
    expect_near(shade_one(t, half_to_opaque(), half),
                {a / alpha, a * (1 - v) / alpha, (a * (1 - v) + 0.5f * (1 - a)) / alpha, alpha},
                2 * kRounding, "half clear");
}

TEST(shade, is_the_line_between_points_at_every_depth) {
    // Uneven points, a step at 0.3, and a piece narrower than one of 1024 buckets.
    const TransferFunction tf{
        "uneven",
        {{0.1f, 0, 0, 1}, {0.3f, 1, 0, 0}, {0.3f, 0, 1, 0}, {0.3003f, 1, 1, 0}, {0.9f, 0.5f, 0, 1}},
        {{0.2f, 0.25f}, {0.8f, 1}}};
    const auto line = [&](double v, auto component) {
        const auto& p = tf.color;
        if (v < p.front().v) return double{component(p.front())};
        for (std::size_t i = p.size() - 1; i-- > 0;)
            if (v >= p[i].v && v < p[i + 1].v)
                return component(p[i]) + (v - p[i].v) / (double{p[i + 1].v} - p[i].v) *
                                             (double{component(p[i + 1])} - component(p[i]));
        return double{component(p.back())};
    };
    DepthImage image(4096, 1);
    for (int x = 0; x < image.width; ++x) image.at(x, 0) = 1e-4f + static_cast<float>(x) / 1000;
    const Image shaded = shade(image, tf, {.background = {0, 0, 0, 0}});
    for (int x = 0; x < image.width; ++x) {
        const float v = 1 - std::exp(-image.at(x, 0));
        // The narrow piece rises by 1 over 0.0003, which amplifies the rounding of V by 1/0.0003.
        const float slope = v > 0.299f && v < 0.301f ? 1 / 0.0003f : 1;
        const float tolerance = kRounding + slope * std::numeric_limits<float>::epsilon();
        EXPECT_NEAR(shaded.at(x, 0).r, line(v, [](auto p) { return p.r; }), tolerance) << v;
        EXPECT_NEAR(shaded.at(x, 0).g, line(v, [](auto p) { return p.g; }), tolerance) << v;
        EXPECT_NEAR(shaded.at(x, 0).a,
                    std::clamp(0.25f + (v - 0.2f) * 1.25f, 0.25f, 1.0f) * std::min(v / kRim, 1.0f),
                    kRounding);
        EXPECT_EQ(color_at(tf, v).b, shaded.at(x, 0).b);
    }
}

TEST(shade, a_step_has_its_right_value_at_the_step) {
    const TransferFunction tf{"step", {{0.5f, 1, 0, 0}, {0.5f, 0, 0, 1}}, {}};
    EXPECT_EQ(color_at(tf, 0.49999f), (Rgba{1, 0, 0, 1}));
    EXPECT_EQ(color_at(tf, 0.5f), (Rgba{0, 0, 1, 1}));
    EXPECT_EQ(color_at(tf, 0), (Rgba{1, 0, 0, 1}));
    EXPECT_EQ(color_at(tf, 1), (Rgba{0, 0, 1, 1}));
}

TEST(shade, is_the_same_for_any_number_of_threads) {
    DepthImage image(517, 301);
    for (std::size_t i = 0; i < image.depth.size(); ++i)
        image.depth[i] = static_cast<float>(i % 977) / 200;
    const TransferFunction tf = named_transfer_function("viridis");
    const ShadeOptions options{.background = {1, 1, 1, 1}, .blend = true};
    const Image all = shade(image, tf, options);
    const ThreadLimit one(1);
    EXPECT_EQ(shade(image, tf, options).pixel, all.pixel);
}

TEST(shade, what_cannot_be_shaded_is_an_error) {
    const TransferFunction gray = named_transfer_function("gray");
    for (const float t : {kNan, kInfinity, -1e-3f})
        EXPECT_THROW((void)shade(depths({1, t, 0}), gray), Error) << t;
    DepthImage short_of_pixels(2, 2);
    short_of_pixels.depth.pop_back();
    EXPECT_THROW((void)shade(short_of_pixels, gray), Error);
    EXPECT_THROW((void)shade(depths({1}), TransferFunction{}), Error);
    EXPECT_THROW((void)shade(depths({1}), {"unsorted", {{0.5f, 0, 0, 0}, {0.4f, 1, 1, 1}}, {}}),
                 Error);
    EXPECT_THROW((void)shade(depths({1}), {"bright", {{0.5f, 0, 2, 0}}, {}}), Error);
    EXPECT_THROW((void)shade(depths({1}), {"nan", {{0.5f, 0, 0, 0}}, {{0, kNan}}}), Error);
    EXPECT_THROW((void)shade(depths({1}), gray, {.background = {0, 255, 0, 1}}), Error);
    EXPECT_THROW((void)color_at(gray, 1.5f), Error);
    EXPECT_THROW((void)color_at(gray, kNan), Error);
}

TEST(color_maps, follow_the_published_tables) {
    // Entries 0, 29, 77, 111, 150, 202, 239 and 255 of the published tables, most of them not among
    // the stored points, whose interpolation is within 1/255. Entries are rounded to 8 bits.
    constexpr float kTolerance = 1.5f / 255;
    constexpr std::array<int, 8> kEntries{0, 29, 77, 111, 150, 202, 239, 255};
    struct Map {
        const char* name;
        std::array<std::array<int, 3>, 8> colors;
    };
    // clang-format off
    const Map maps[] = {
        {"viridis", {{{68, 1, 84}, {72, 41, 121}, {52, 96, 141}, {38, 129, 142}, {33, 165, 133}, {117, 208, 84}, {213, 226, 26}, {253, 231, 37}}}},
        {"inferno", {{{0, 0, 4}, {28, 12, 67}, {108, 24, 110}, {162, 43, 98}, {217, 77, 61}, {252, 161, 8}, {242, 232, 101}, {252, 255, 164}}}},
        {"magma", {{{0, 0, 4}, {25, 16, 63}, {101, 26, 128}, {155, 46, 127}, {217, 70, 107}, {253, 155, 107}, {253, 224, 161}, {252, 253, 191}}}},
        {"plasma", {{{13, 8, 135}, {72, 3, 159}, {145, 14, 163}, {187, 52, 136}, {222, 97, 100}, {252, 163, 56}, {249, 221, 37}, {240, 249, 33}}}},
        {"cividis", {{{0, 34, 78}, {20, 54, 112}, {80, 87, 108}, {110, 111, 115}, {146, 140, 120}, {198, 182, 103}, {239, 215, 72}, {254, 232, 56}}}},
        {"turbo", {{{48, 18, 59}, {70, 100, 218}, {24, 215, 202}, {105, 253, 102}, {219, 226, 54}, {242, 96, 20}, {172, 23, 1}, {122, 4, 3}}}},
        {"cubehelix", {{{0, 0, 0}, {27, 26, 54}, {31, 103, 65}, {111, 123, 49}, {205, 125, 137}, {194, 198, 243}, {226, 246, 240}, {255, 255, 255}}}},
    };
    // clang-format on
    for (const Map& map : maps)
        for (std::size_t i = 0; i < kEntries.size(); ++i) {
            const auto c = [&](std::size_t k) {
                return static_cast<float>(map.colors[i][k]) / 255;
            };
            const float v = static_cast<float>(kEntries[i]) / 255;
            expect_near(color_at(named_transfer_function(map.name), v), {c(0), c(1), c(2), 1},
                        kTolerance, map.name + (" at " + std::to_string(v)));
        }
}

TEST(color_maps, coolwarm_is_morelands) {
    // Rows 0, 8, 16, 24 and 32 of the 33 published by K. Moreland, with half an 8-bit step.
    const TransferFunction map = named_transfer_function("coolwarm");
    const float published[5][3] = {{0.2298f, 0.2987f, 0.7537f},
                                   {0.5530f, 0.6889f, 0.9954f},
                                   {0.8654f, 0.8654f, 0.8654f},
                                   {0.9585f, 0.6028f, 0.4818f},
                                   {0.7057f, 0.0156f, 0.1502f}};
    for (int i = 0; i < 5; ++i)
        expect_near(color_at(map, static_cast<float>(i) / 4),
                    {published[i][0], published[i][1], published[i][2], 1}, 0.5f / 255,
                    std::to_string(i));
}

TEST(color_maps, jet_is_the_classic_ramp) {
    const TransferFunction jet = named_transfer_function("jet");
    for (int i = 0; i <= 100; ++i) {
        const float v = static_cast<float>(i) / 100;
        const auto ramp = [&](float peak) {
            return std::clamp(1.5f - std::abs(4 * v - peak), 0.0f, 1.0f);
        };
        expect_near(color_at(jet, v), {ramp(3), ramp(2), ramp(1), 1}, kRounding, std::to_string(v));
    }
}

TEST(color_maps, ends_are_what_the_names_say) {
    EXPECT_EQ(color_at(named_transfer_function("white-red"), 0), (Rgba{1, 1, 1, 1}));
    EXPECT_EQ(color_at(named_transfer_function("white-red"), 1), (Rgba{1, 0, 0, 1}));
    EXPECT_EQ(color_at(named_transfer_function("blue-white"), 0), (Rgba{0, 0, 1, 1}));
    EXPECT_EQ(color_at(named_transfer_function("blue-white"), 1), (Rgba{1, 1, 1, 1}));
    EXPECT_EQ(color_at(named_transfer_function("gray"), 0.25f), (Rgba{0.25f, 0.25f, 0.25f, 1}));
}

TEST(color_maps, are_found_in_any_case_and_listed_where_not_found) {
    EXPECT_EQ(named_transfer_function("Viridis").name, "viridis");
    EXPECT_EQ(named_transfer_function("WHITE_RED").name, "white-red");
    EXPECT_EQ(named_transfer_function("grey").name, "gray");
    try {
        (void)named_transfer_function("rainbow");
        ADD_FAILURE() << "no error";
    } catch (const Error& error) {
        for (const std::string& name : transfer_function_names())
            EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << name;
    }
    EXPECT_GE(transfer_function_names().size(), 12u);
    for (const std::string& name : transfer_function_names())
        EXPECT_NO_THROW((void)shade(depths({1}), named_transfer_function(name))) << name;
}

TEST(color_maps, samples_of_other_programs_are_even_and_alpha_is_opacity) {
    const Rgba colors[] = {{0, 0, 0, 1}, {1, 0, 0.5f, 1}, {1, 1, 1, 1}};
    const TransferFunction tf = sampled_transfer_function("mine", colors);
    EXPECT_EQ(tf.name, "mine");
    EXPECT_TRUE(tf.opacity.empty());
    EXPECT_EQ(color_at(tf, 0.5f), (Rgba{1, 0, 0.5f, 1}));
    EXPECT_EQ(color_at(tf, 0.25f), (Rgba{0.5f, 0, 0.25f, 1}));
    const Rgba clear[] = {{0, 0, 0, 0}, {1, 1, 1, 0.5f}};
    EXPECT_EQ(color_at(sampled_transfer_function("clear", clear), 0.5f),
              (Rgba{0.5f, 0.5f, 0.5f, 0.25f}));
    EXPECT_EQ(color_at(sampled_transfer_function("one", {colors + 1, 1}), 0.7f), colors[1]);
    EXPECT_THROW((void)sampled_transfer_function("none", {}), Error);
    const Rgba bright[] = {{2, 0, 0, 1}};
    EXPECT_THROW((void)sampled_transfer_function("bright", bright), Error);
}

TEST(color_maps, picture_in_the_docs_is_current) {
    // One strip per map, V from 0 to 1, in the order of names. VOG_UPDATE_DOCS=1 writes the file.
    constexpr int kWidth = 512, kStrip = 24, kGap = 4;
    const std::vector<std::string> names = transfer_function_names();
    Image picture(kWidth, static_cast<int>(names.size()) * (kStrip + kGap) - kGap);
    std::fill(picture.pixel.begin(), picture.pixel.end(), Rgba{1, 1, 1, 1});
    DepthImage ramp(kWidth, 1);
    for (int x = 0; x < kWidth; ++x)  // never 0, which would be background
        ramp.at(x, 0) = std::max(static_cast<float>(x) / (kWidth - 1), 1e-9f);
    for (std::size_t i = 0; i < names.size(); ++i) {
        const Image strip =
            shade_values(ramp, named_transfer_function(names[i]), {ColorScale::Kind::linear, 0, 1});
        for (int y = 0; y < kStrip; ++y)
            std::copy(strip.pixel.begin(), strip.pixel.end(),
                      &picture.at(0, static_cast<int>(i) * (kStrip + kGap) + y));
    }
    const auto file = test::source_dir() / "docs/images/color_maps.png";
    if (std::getenv("VOG_UPDATE_DOCS")) write_png(file, picture);
    const Image shown = read_image(file);
    ASSERT_EQ(shown.width, picture.width);
    ASSERT_EQ(shown.height, picture.height);
    for (std::size_t i = 0; i < picture.pixel.size(); ++i)
        expect_near(shown.pixel[i], picture.pixel[i], 1.0f / 255, "pixel " + std::to_string(i));
}

TEST(extinction, brings_the_99th_percentile_of_found_depths_to_four) {
    std::vector<float> values(350, 0.0f);  // rays that met nothing do not count
    for (int i = 100; i >= 1; --i) values.push_back(static_cast<float>(i));
    EXPECT_DOUBLE_EQ(auto_extinction(depths(values)), 4.0 / 99);  // number ceil(99.00) of 100
    values.push_back(101);
    EXPECT_DOUBLE_EQ(auto_extinction(depths(values)), 4.0 / 100);  // number ceil(99.99) of 101
    EXPECT_DOUBLE_EQ(auto_extinction(depths({0, 8})), 0.5);
    EXPECT_EQ(auto_extinction(depths({0, 0})), 1);
}

TEST(extinction, auto_does_not_depend_on_the_present_one) {
    DepthImage image = depths({0, 1, 2, 3, 4, 5});
    const double value = auto_extinction(image);
    set_extinction(image, 0.125);
    EXPECT_DOUBLE_EQ(auto_extinction(image), value);
}

TEST(extinction, scales_every_depth) {
    DepthImage image = depths({0, 1, 0.1f, 1e30f});
    set_extinction(image, 0.25);
    EXPECT_EQ(image.extinction, 0.25);
    EXPECT_EQ(image.depth, (std::vector<float>{0, 0.25f, 0.25f * 0.1f, 0.25f * 1e30f}));
    set_extinction(image, 1);
    EXPECT_EQ(image.depth, (std::vector<float>{0, 1, 0.1f, 1e30f}));
}

TEST(extinction, out_of_range_is_an_error_and_changes_nothing) {
    DepthImage image = depths({0, 1, 1e30f});
    for (const double extinction : {0.0, -1.0, double{kNan}, double{kInfinity}, 1e20})
        EXPECT_THROW(set_extinction(image, extinction), Error) << extinction;
    EXPECT_EQ(image.depth, (std::vector<float>{0, 1, 1e30f}));
    EXPECT_EQ(image.extinction, 1);
    EXPECT_THROW((void)auto_extinction(depths({1, kNan})), Error);
}

}  // namespace
