// picture_frame_test.cpp: outlines, scale bars and coordinates lie where the world says.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "shade/annotation/ticks.h"
#include "vog/quantity.h"

namespace vog {
namespace {

Image black(int width, int height) {
    Image image(width, height);
    std::ranges::fill(image.pixel, Rgba{0, 0, 0, 1});
    return image;
}
Camera along_z(double width) {
    Camera camera{{5, 3, 20}, {5, 3, 0}, {0, 1, 0}};
    camera.orthographic_width = width;
    return camera;
}

TEST(picture_frame, the_outline_lies_at_the_edges_of_the_box) {
    // 20 pixels a unit; x from -1 to 11: the box from 1 to 9 begins at column 40, rows 60 to 140.
    Image image = black(240, 200);
    draw_frame(image, {along_z(12), {{1, 1, -1}, {9, 5, 1}}, "", true, false});
    const auto ink = [&](int x, int y) { return image.at(x, y).r; };
    for (const int row : {70, 100, 130}) {
        EXPECT_GT(std::max(ink(39, row), ink(40, row)), 0.4f);
        EXPECT_GT(std::max(ink(199, row), ink(200, row)), 0.4f);
        EXPECT_EQ(ink(120, row), 0);
    }
    EXPECT_GT(std::max(ink(120, 59), ink(120, 60)), 0.4f);
    EXPECT_GT(std::max(ink(120, 139), ink(120, 140)), 0.4f);
}

TEST(picture_frame, an_eye_within_the_box_sees_edges_and_nothing_fails) {
    Image image = black(64, 64);
    Camera inside{{0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 90};
    EXPECT_NO_THROW(draw_frame(image, {inside, {{-1, -1, -1}, {1, 1, 1}}, "m", true, true}));
    EXPECT_GT(std::ranges::max(image.pixel, {}, &Rgba::r).r, 0.5f);
    // The far face fills the view of 90 degrees.
    EXPECT_GT(image.at(0, 32).r, 0.1f);
}

TEST(picture_frame, a_scale_bar_has_its_length) {
    Image image = black(300, 200);
    draw_frame(image,
               {along_z(7), {}, "kpc", false, true});  // 300 / 7 pixels a unit: a bar of 1, 42.9
    int longest = 0;
    for (int y = 0; y < image.height; ++y) {
        int run = 0;
        for (int x = 0; x < image.width; ++x) {
            run = image.at(x, y).r > 0.5f ? run + 1 : 0;
            longest = std::max(longest, run);
        }
    }
    EXPECT_NEAR(longest, 300 / 7.0, 3);
}

/// Pixels that have more ink than the lines behind a box.
long inked(const Image& image) {
    return std::ranges::count_if(image.pixel, [](const Rgba& c) { return c.r > 0.95f; });
}

TEST(picture_frame, a_scale_bar_leaves_coordinates_alone) {
    // The box begins at the left edge: the numbers of x lie where the bar would.
    const Camera camera = along_z(12);
    const Box box{{-0.6, -1, -1}, {9, 5, 1}};
    Image both = black(240, 200), axes = both, bar = both;
    draw_frame(both, {camera, box, "kpc", true, true});
    draw_frame(axes, {camera, box, "kpc", true, false});
    draw_frame(bar, {camera, box, "kpc", false, true});
    EXPECT_EQ(inked(both), inked(axes) + inked(bar));
    const auto lower_left = [](const Image& image) {
        long ink = 0;
        for (int y = 180; y < 200; ++y)
            for (int x = 0; x < 50; ++x) ink += image.at(x, y).r > 0.95f;
        return ink;
    };
    EXPECT_GT(lower_left(bar), 40);
    EXPECT_EQ(lower_left(both), lower_left(axes));
}

TEST(picture_frame, numbers_and_names_are_whole) {
    // Long numbers, and a name that has no room beside them at the left.
    for (const double far : {0.0, 5.4e6})
        for (const int size : {128, 256, 512, 1024}) {
            Camera camera{{far + 26, far + 16, 33}, {far, far, 0}, {0, 1, 0}, 38};
            Image image = black(size, size);
            draw_frame(
                image,
                {camera, {{far - 6, far - 6, -6}, {far + 6, far + 6, 6}}, "Mpc", true, false});
            for (int n = 0; n < size; ++n) {
                EXPECT_EQ(image.at(0, n).r, 0) << "left, row " << n << " of " << size;
                EXPECT_EQ(image.at(n, size - 1).r, 0) << "below, column " << n << " of " << size;
            }
        }
}

TEST(picture_frame, long_numbers_are_those_from_a_round_origin) {
    const auto texts = [](double low, double high) {
        const shading::AxisTicks axis = shading::axis_ticks(low, high, 0.16);
        std::string all;
        for (const shading::Tick& tick : axis.ticks) {
            EXPECT_GE(tick.value, low);
            EXPECT_LE(tick.value, high);
            all += tick.text + " ";
        }
        return all + "x" + axis.origin;
    };
    EXPECT_EQ(texts(0, 16), "0 5 10 15 x");
    EXPECT_EQ(texts(1e9 - 0.5, 1e9 + 15.5), "0 5 10 15 x - 1e9");
    EXPECT_EQ(texts(-4500200, -4500100), "-200 -180 -160 -140 -120 -100 x + 4.5e6");
    EXPECT_EQ(texts(1234567000, 1234567100), "0 20 40 60 80 100 x - 1234567000");
    EXPECT_EQ(texts(1e6, 2e6), "1e6 1.2e6 1.4e6 1.6e6 1.8e6 2e6 x");
    EXPECT_EQ(texts(0, 2e-7), texts(0, 2e-7).substr(0, texts(0, 2e-7).find('x') + 1));
}

TEST(picture_frame, coordinates_are_those_of_orthographic_pictures_along_axes) {
    const auto sides = side_ticks(along_z(12), 240, 200, "kpc");
    ASSERT_TRUE(sides);
    EXPECT_NEAR(sides->across.first, -1, 1e-12);
    EXPECT_NEAR(sides->across.last, 11, 1e-12);
    EXPECT_NEAR(sides->up.first, -2, 1e-12);
    EXPECT_NEAR(sides->up.last, 8, 1e-12);
    EXPECT_EQ(sides->across.name, "x [kpc]");
    EXPECT_EQ(sides->up.name, "y [kpc]");
    Camera behind = along_z(12);
    behind.eye.z = -20;  // x runs to the left
    EXPECT_NEAR(side_ticks(behind, 240, 200)->across.first, 11, 1e-12);
    Camera tilted = along_z(12);
    tilted.eye.x = 6;
    EXPECT_FALSE(side_ticks(tilted, 240, 200));
    EXPECT_FALSE(side_ticks(Camera{}, 240, 200));

    const Image picture = black(240, 200);
    Annotation around{"", "", false, sides};
    const Image framed = annotated(picture, {}, {ColorScale::Kind::linear, 0, 1}, around);
    EXPECT_GT(framed.width, 250);
    EXPECT_GT(framed.height, 220);
    // The picture is whole, at the right end of the first row.
    for (int y = 0; y < 200; ++y) EXPECT_EQ(framed.at(framed.width - 1, y).r, 0);
    // A tick at x = 10 lies 220 pixels from the picture's left edge, just below it.
    const int left = framed.width - 240;
    EXPECT_GT(std::max(framed.at(left + 219, 201).r, framed.at(left + 220, 201).r), 0.5f);
}

}  // namespace
}  // namespace vog
