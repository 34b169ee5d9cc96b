// compare_test.cpp: Error metrics against values computed by hand and by their definitions.
#include "vog/compare.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <nlohmann/json.hpp>

#include "compare/ssim.h"
#include "support/data.h"
#include "support/scenes.h"
#include "vog/error.h"
#include "vog/progress.h"

namespace vog::test {

using namespace vog::comparison;

namespace {

// Figures are sums of a few hundred doubles: rounding stays far below this.
constexpr double kExact = 1e-12;

Image grey_image(int width, int height, const std::function<int(int, int)>& value) {
    Image image(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float v = static_cast<float>(value(x, y)) / 255;
            image.at(x, y) = {v, v, v, 1};
        }
    return image;
}

DepthImage depth_image(int width, int height, const std::function<double(int, int)>& value) {
    DepthImage image(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) image.at(x, y) = static_cast<float>(value(x, y));
    return image;
}

Image noise(int width, int height, std::uint64_t seed) {
    Random random(seed);
    return grey_image(width, height, [&](int, int) { return static_cast<int>(random(0, 256)); });
}

double decibels(double mean_square) { return 10 * std::log10(255.0 * 255.0 / mean_square); }

/// SSIM by its definition: a two-dimensional sum for each window.
double ssim_by_definition(const std::vector<float>& a, const std::vector<float>& b, int width,
                          int height) {
    double weight[11][11], norm = 0, total = 0;
    for (int y = 0; y < 11; ++y)
        for (int x = 0; x < 11; ++x) {
            weight[y][x] = std::exp(-((x - 5) * (x - 5) + (y - 5) * (y - 5)) / 4.5);
            norm += weight[y][x];
        }
    for (int top = 0; top + 11 <= height; ++top)
        for (int left = 0; left + 11 <= width; ++left) {
            const auto mean = [&](const std::function<double(std::size_t)>& f) {
                double sum = 0;
                for (int y = 0; y < 11; ++y)
                    for (int x = 0; x < 11; ++x)
                        sum += weight[y][x] / norm *
                               f(static_cast<std::size_t>((top + y) * width + left + x));
                return sum;
            };
            const double ma = mean([&](std::size_t n) { return double{a[n]}; });
            const double mb = mean([&](std::size_t n) { return double{b[n]}; });
            const double va = mean([&](std::size_t n) { return (a[n] - ma) * (a[n] - ma); });
            const double vb = mean([&](std::size_t n) { return (b[n] - mb) * (b[n] - mb); });
            const double cov = mean([&](std::size_t n) { return (a[n] - ma) * (b[n] - mb); });
            total += (2 * ma * mb + 6.5025) * (2 * cov + 58.5225) /
                     ((ma * ma + mb * mb + 6.5025) * (va + vb + 58.5225));
        }
    return total / ((width - 10) * (height - 10));
}

}  // namespace

TEST(compare, a_picture_equals_itself) {
    const Image image = noise(40, 30, 1);
    const PictureDifference difference = compare(image, image);
    EXPECT_TRUE(std::isinf(difference.psnr_db));
    EXPECT_NEAR(difference.ssim, 1, kExact);
    EXPECT_EQ(difference.share_off_1, 0);
    EXPECT_EQ(difference.largest, 0);
}

TEST(compare, a_depth_image_equals_itself) {
    const DepthImage image = depth_image(20, 20, [](int x, int y) { return 0.01 * x * y; });
    const DepthDifference difference = compare(image, image);
    EXPECT_TRUE(difference.identical);
    EXPECT_TRUE(std::isinf(difference.grey.psnr_db));
    EXPECT_EQ(difference.relative_l2, 0);
    EXPECT_EQ(difference.bias, 1);
    EXPECT_EQ(difference.largest_dt, 0);
}

TEST(compare, psnr_of_one_changed_pixel) {
    const Image a = grey_image(16, 16, [](int, int) { return 100; });
    Image b = a;
    b.at(3, 7).g = 105.0f / 255;  // one channel of three, one pixel of 256, off by 5
    const PictureDifference difference = compare(a, b);
    EXPECT_NEAR(difference.psnr_db, decibels(25.0 / (3 * 256)), kExact);
    EXPECT_EQ(difference.share_off_1, 1.0 / 256);
    EXPECT_EQ(difference.share_off_4, 1.0 / 256);
    EXPECT_EQ(difference.largest, 5);
    EXPECT_EQ(difference.largest_column, 3);
    EXPECT_EQ(difference.largest_row, 7);
}

TEST(compare, off_by_exactly_1_or_4_does_not_count_as_more) {
    const Image a = grey_image(16, 16, [](int, int) { return 100; });
    const Image b = grey_image(16, 16, [](int x, int) { return x < 4 ? 101 : x < 8 ? 96 : 100; });
    const PictureDifference difference = compare(a, b);
    EXPECT_EQ(difference.share_off_1, 0.25);
    EXPECT_EQ(difference.share_off_4, 0);
}

TEST(compare, an_edge_shifted_by_one_pixel) {
    // One column of sixteen flips from black to white.
    const Image a = grey_image(16, 16, [](int x, int) { return x < 8 ? 0 : 255; });
    const Image b = grey_image(16, 16, [](int x, int) { return x < 7 ? 0 : 255; });
    const PictureDifference difference = compare(a, b);
    EXPECT_NEAR(difference.psnr_db, 10 * std::log10(16), kExact);
    EXPECT_EQ(difference.share_off_4, 1.0 / 16);
    EXPECT_EQ(difference.largest_column, 7);
}

TEST(compare, a_depth_ramp_shifted_by_one_pixel) {
    // T = x against T = x - 1, clamped at 0: dT = -1 in 15 columns of 16, 0 in the first.
    const DepthImage a = depth_image(16, 4, [](int x, int) { return x; });
    const DepthImage b = depth_image(16, 4, [](int x, int) { return std::max(x - 1, 0); });
    const DepthDifference difference = compare(a, b);
    EXPECT_NEAR(difference.relative_l2, std::sqrt(15.0 / 1240), kExact);  // sum of x², x < 16
    EXPECT_NEAR(difference.bias, 105.0 / 120, kExact);
    EXPECT_EQ(difference.largest_dt, -1);
    EXPECT_EQ(difference.largest_column, 1);
    EXPECT_EQ(difference.largest_row, 0);
}

TEST(compare, depth_scaled_by_two) {
    // V goes from 1/2 to 3/4: 127.5 rounds to 128, 191.25 to 191. The float of ln 2 lies above it.
    const DepthImage a = depth_image(12, 12, [](int, int) { return std::log(2); });
    const DepthImage b = depth_image(12, 12, [](int, int) { return 2 * std::log(2); });
    const DepthDifference difference = compare(a, b);
    EXPECT_NEAR(difference.relative_l2, 1, kExact);
    EXPECT_NEAR(difference.bias, 2, kExact);
    EXPECT_NEAR(difference.largest_dt, std::log(2), 1e-7);
    EXPECT_NEAR(difference.grey.psnr_db, decibels(63 * 63), kExact);
    EXPECT_EQ(difference.grey.share_off_4, 1);
}

TEST(compare, both_are_compared_at_the_extinction_of_the_reference) {
    DepthImage a = depth_image(8, 8, [](int x, int y) { return 0.125 * x + y; });
    DepthImage b = a;
    set_extinction(b, 4);  // a power of two: no rounding
    EXPECT_TRUE(compare(a, b).identical);
    EXPECT_EQ(compare(a, b).extinction, 1);
    EXPECT_EQ(compare(b, a).extinction, 4);
    set_extinction(a, 0.5);
    b = a;
    b.extinction = 1;  // the same T at twice the extinction: half the density
    EXPECT_NEAR(compare(a, b).bias, 0.5, kExact);
}

TEST(compare, empty_references_have_defined_figures) {
    const DepthImage empty(12, 12), full = depth_image(12, 12, [](int, int) { return 1; });
    EXPECT_EQ(compare(empty, empty).relative_l2, 0);
    EXPECT_EQ(compare(empty, empty).bias, 1);
    EXPECT_TRUE(std::isinf(compare(empty, full).relative_l2));
    EXPECT_TRUE(std::isinf(compare(empty, full).bias));
    EXPECT_EQ(compare(full, empty).relative_l2, 1);
    EXPECT_EQ(compare(full, empty).bias, 0);
}

TEST(compare, shaded_figures_are_those_of_the_shaded_pictures) {
    const DepthImage a = depth_image(16, 16, [](int x, int y) { return 0.02 * x * y; });
    DepthImage b = depth_image(16, 16, [](int x, int y) { return 0.03 * x * y; });
    const TransferFunction tf = named_transfer_function("viridis");
    const double expected = compare(shade(a, tf), shade(b, tf)).psnr_db;
    EXPECT_EQ(compare_shaded(a, b, tf).psnr_db, expected);
    set_extinction(b, 2);
    EXPECT_NEAR(compare_shaded(a, b, tf).psnr_db, expected, 0.01);
}

TEST(compare, transparent_colours_are_composited_over_black) {
    Image a(12, 12), b(12, 12);
    for (Rgba& pixel : a.pixel) pixel = {1, 0.5f, 0, 0};
    for (Rgba& pixel : b.pixel) pixel = {0, 0, 0, 1};
    EXPECT_EQ(compare(a, b).largest, 0);
}

TEST(compare, different_sizes_throw) {
    try {
        (void)compare(DepthImage(4, 5), DepthImage(5, 4));
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_STREQ(error.what(), "the images differ in size: 5x4 pixels, expected 4x5");
    }
    EXPECT_THROW((void)compare(Image(4, 4), Image(4, 3)), Error);
    EXPECT_THROW((void)difference_map(Image(4, 4), Image(4, 3)), Error);
}

TEST(ssim, of_two_constants_is_the_luminance_term) {
    const std::vector<float> a(20 * 20, 100), b(20 * 20, 120);
    const double expected = (2 * 100 * 120 + 6.5025) / (100 * 100 + 120 * 120 + 6.5025);
    EXPECT_NEAR(structural_similarity(a, b, 20, 20), expected, 1e-9);
}

TEST(ssim, is_the_definition_window_by_window) {
    const Image a = noise(23, 50, 2), b = noise(23, 50, 3);
    std::vector<float> grey_a, grey_b;
    for (std::size_t n = 0; n < a.pixel.size(); ++n) {
        grey_a.push_back(std::round(255 * a.pixel[n].r));
        grey_b.push_back(0.7f * grey_a.back() + std::round(80 * b.pixel[n].r));
    }
    EXPECT_NEAR(structural_similarity(grey_a, grey_b, 23, 50),
                ssim_by_definition(grey_a, grey_b, 23, 50), 1e-9);
}

TEST(ssim, is_undefined_where_no_window_fits) {
    const std::vector<float> values(10 * 30, 1);
    EXPECT_TRUE(std::isnan(structural_similarity(values, values, 10, 30)));
}

TEST(compare, figures_are_the_same_for_any_number_of_threads) {
    const Image a = noise(300, 200, 4), b = noise(300, 200, 5);
    const PictureDifference many = compare(a, b);
    const ThreadLimit limit(1);
    const PictureDifference one = compare(a, b);
    EXPECT_EQ(many.ssim, one.ssim);
    EXPECT_EQ(many.psnr_db, one.psnr_db);
}

TEST(difference_map, is_blue_below_grey_at_and_red_above_the_reference) {
    const DepthImage a = depth_image(3, 1, [](int, int) { return 1; });
    const DepthImage b = depth_image(3, 1, [](int x, int) { return 0.5 + 0.5 * x; });
    const Image map = difference_map(a, b, {0, false});
    ASSERT_EQ(map.width, 3);
    EXPECT_GT(map.at(0, 0).b, map.at(0, 0).r + 0.3f);
    EXPECT_EQ(map.at(1, 0), color_at(named_transfer_function("coolwarm"), 0.5f));
    EXPECT_GT(map.at(2, 0).r, map.at(2, 0).b + 0.1f);
}

TEST(difference_map, scale_ends_at_the_next_round_number_or_the_limit) {
    const Image a = grey_image(2, 2, [](int, int) { return 10; });
    const Image b = grey_image(2, 2, [](int x, int y) { return 10 + 37 * x * y; });
    const TransferFunction colors = named_transfer_function("inferno");
    EXPECT_EQ(difference_map(a, b, {0, false}).at(1, 1), color_at(colors, 37.0f / 50));
    EXPECT_EQ(difference_map(a, b, {100, false}).at(1, 1), color_at(colors, 0.37f));
    EXPECT_EQ(difference_map(a, b, {20, false}).at(1, 1), color_at(colors, 1));
    EXPECT_EQ(difference_map(a, a, {0, false}).at(1, 1), color_at(colors, 0));
    EXPECT_THROW((void)difference_map(a, b, {-1, false}), Error);
}

TEST(difference_map, bar_leaves_the_map_as_it_is) {
    const Image a = noise(64, 130, 6), b = noise(64, 130, 7);
    const Image bare = difference_map(a, b, {0, false}), with_bar = difference_map(a, b);
    ASSERT_GT(with_bar.width, bare.width);
    ASSERT_EQ(with_bar.height, bare.height);
    for (int y = 0; y < bare.height; ++y)
        for (int x = 0; x < bare.width; ++x) ASSERT_EQ(with_bar.at(x, y), bare.at(x, y));
    int ink = 0;
    for (int y = 0; y < bare.height; ++y)
        for (int x = bare.width; x < with_bar.width; ++x)
            ink += !(with_bar.at(x, y) == Rgba{1, 1, 1, 1});
    EXPECT_GT(ink, 14 * 80);
}

namespace {

/// Runs `vog compare arguments`. returns its output, errors included, and its exit code
std::pair<std::string, int> run_compare(const TempDir& dir, const std::string& arguments) {
    const std::string command = "cd '" + (dir / "").string() + "' && '" + vog_command() +
                                "' compare " + arguments + " 2>&1";
    std::FILE* pipe = popen(command.c_str(), "r");
    std::string text;
    for (int c; (c = std::fgetc(pipe)) != EOF;) text += static_cast<char>(c);
    return {text, WEXITSTATUS(pclose(pipe))};
}

}  // namespace

TEST(compare_command, json_holds_every_figure_and_null_for_infinity) {
    const TempDir dir;
    const DepthImage a = depth_image(16, 16, [](int x, int y) { return 0.125 * x + 0.25 * y; });
    DepthImage b = a;
    for (float& t : b.depth) t *= 2;
    write_exr(dir / "a.exr", a);
    write_exr(dir / "b.exr", b);
    const auto [text, code] = run_compare(dir, "a.exr b.exr --json --diff diff.png");
    ASSERT_EQ(code, 0) << text;
    const auto json = nlohmann::json::parse(text);
    EXPECT_NEAR(json.at("relative_l2").get<double>(), 1, kExact);
    EXPECT_NEAR(json.at("bias").get<double>(), 2, kExact);
    EXPECT_NEAR(json.at("max_abs_dt").get<double>(), 15 * 0.375, kExact);
    EXPECT_EQ(json.at("dt_at"), nlohmann::json({15, 15}));
    for (const char* key : {"psnr_v_db", "psnr_rgb_db", "ssim", "off_by_more_than_1",
                            "off_by_more_than_4", "extinction"})
        EXPECT_TRUE(json.at(key).is_number()) << key;
    EXPECT_FALSE(json.at("identical").get<bool>());
    EXPECT_GT(read_image(dir / "diff.png").width, 16);

    const auto [same, same_code] = run_compare(dir, "a.exr a.exr --json");
    ASSERT_EQ(same_code, 0) << same;
    EXPECT_TRUE(nlohmann::json::parse(same).at("psnr_v_db").is_null());
    EXPECT_TRUE(nlohmann::json::parse(same).at("identical").get<bool>());
}

TEST(compare_command, kinds_and_sizes_must_agree) {
    const TempDir dir;
    write_exr(dir / "t.exr", DepthImage(16, 16));
    write_png(dir / "a.png", Image(16, 16));
    write_png(dir / "b.png", Image(16, 17));
    const auto [kinds, kinds_code] = run_compare(dir, "t.exr a.png");
    EXPECT_EQ(kinds_code, 1);
    EXPECT_EQ(kinds, "vog: a.png is a picture; to compare it, use a depth image like t.exr\n");
    const auto [sizes, sizes_code] = run_compare(dir, "a.png b.png");
    EXPECT_EQ(sizes_code, 1);
    EXPECT_EQ(sizes,
              "vog: a.png and b.png: the images differ in size: 16x17 pixels, expected 16x16\n");
    EXPECT_EQ(run_compare(dir, "a.png none.png").second, 1);
    EXPECT_EQ(run_compare(dir, "a.png").second, 2);
}

}  // namespace vog::test
