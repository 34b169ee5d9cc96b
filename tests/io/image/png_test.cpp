// png_test.cpp: writing, reading and refusing PNG images.
#include "vog/image.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <limits>

#include "support/images.h"
#include "support/refused_files.h"

namespace {

using namespace vog;
using namespace vog::test;

TEST(png, components_are_rounded_and_clamped) {
    Image image(4, 1);
    image.pixel = {{0.5f, 1.49f / 255, 1.51f / 255}, {-1, 2, 1}, {kInfinity, -kInfinity, 0}, {}};
    const TempDir dir;
    write_png(dir / "a.png", image);
    const Image read = read_image(dir / "a.png");
    EXPECT_EQ(read.at(0, 0), (Rgba{128 / 255.0f, 1 / 255.0f, 2 / 255.0f, 1}));
    EXPECT_EQ(read.at(1, 0), (Rgba{0, 1, 1, 1}));
    EXPECT_EQ(read.at(2, 0), (Rgba{1, 0, 0, 1}));
}

TEST(png, bytes_in_memory_are_those_of_the_file) {
    const TempDir dir;
    Image image = small_image();
    for (const float alpha : {1.0f, 0.4f}) {
        image.at(1, 0).a = alpha;
        write_png(dir / "a.png", image);
        const std::vector<std::uint8_t> bytes = png_bytes(image);
        EXPECT_EQ(std::string(bytes.begin(), bytes.end()), read_bytes(dir / "a.png"));
        EXPECT_EQ(opaque(image), alpha == 1);
    }
    const std::vector<std::uint8_t> rgb = image_bytes(image, false),
                                    rgba = image_bytes(image, true);
    ASSERT_EQ(rgb.size(), 3 * image.pixel.size());
    ASSERT_EQ(rgba.size(), 4 * image.pixel.size());
    EXPECT_EQ(rgba[4 * 1 + 3], 102);
    EXPECT_EQ(rgb[3 * 1 + 2], rgba[4 * 1 + 2]);
    image.pixel.front().g = kNan;
    EXPECT_THROW((void)png_bytes(image), Error);
}

TEST(image, extension_says_what_is_written) {
    const TempDir dir;
    const Image image = small_image();
    write_image(dir / "a.png", image);
    write_png(dir / "b.png", image);
    write_image(dir / "a.exr", image);
    EXPECT_EQ(read_bytes(dir / "a.png"), read_bytes(dir / "b.png"));
    EXPECT_EQ(read_image(dir / "a.exr").pixel, image.pixel);
    EXPECT_THROW(write_image(dir / "a.jpg", image), Error);
}

TEST(png, every_8_bit_value_survives_a_round_trip) {
    Image image(256, 1);
    for (int i = 0; i < 256; ++i) {
        const auto c = static_cast<float>(i) / 255;
        image.at(i, 0) = {c, 1 - c, c, c};
    }
    const TempDir dir;
    write_png(dir / "a.png", image);
    const Image once = read_image(dir / "a.png");
    for (int i = 0; i < 256; ++i) EXPECT_EQ(once.at(i, 0).r, static_cast<float>(i) / 255);
    write_png(dir / "b.png", once);
    EXPECT_EQ(read_bytes(dir / "a.png"), read_bytes(dir / "b.png"));
}

TEST(png, is_8_bit_rgb_unless_some_alpha_is_below_one) {
    constexpr std::size_t kBitDepth = 24, kColorType = 25;  // offsets in a PNG's first chunk
    const TempDir dir;
    Image image = small_image();
    write_png(dir / "opaque.png", image);
    EXPECT_EQ(read_bytes(dir / "opaque.png")[kBitDepth], 8);
    EXPECT_EQ(read_bytes(dir / "opaque.png")[kColorType], 2);
    image.at(2, 1).a = 0.4f;
    write_png(dir / "clear.png", image);
    EXPECT_EQ(read_bytes(dir / "clear.png")[kColorType], 6);
    const Rgba clear = read_image(dir / "clear.png").at(2, 1);
    EXPECT_EQ(clear.a, 102 / 255.0f);
    EXPECT_EQ(clear.r, 230 / 255.0f);  // straight: alpha does not dim it
}

TEST(png, every_depth_and_color_type_is_read) {
    // One bit of grey: 1 0 1.
    Image image = read_bytes_as_image(PngBytes{3, 1, 1, 0, {"\0\xa0", 2}, ""}.file());
    EXPECT_EQ(image.at(0, 0), (Rgba{1, 1, 1, 1}));
    EXPECT_EQ(image.at(1, 0), (Rgba{0, 0, 0, 1}));
    // 16 bits of RGB.
    image =
        read_bytes_as_image(PngBytes{1, 1, 16, 2, {"\0\x12\x34\x80\x00\xff\xff", 7}, ""}.file());
    EXPECT_EQ(image.at(0, 0), (Rgba{0x1234 / 65535.0f, 0x8000 / 65535.0f, 1, 1}));
    // Grey with alpha.
    image = read_bytes_as_image(PngBytes{1, 1, 8, 4, {"\0\x40\x80", 3}, ""}.file());
    EXPECT_EQ(image.at(0, 0), (Rgba{64 / 255.0f, 64 / 255.0f, 64 / 255.0f, 128 / 255.0f}));
    // A palette whose second colour is half transparent.
    const std::string palette =
        png_chunk("PLTE", {"\xff\x00\x00\x00\x33\x00", 6}) + png_chunk("tRNS", {"\xff\x80", 2});
    image = read_bytes_as_image(PngBytes{2, 1, 8, 3, {"\0\0\1", 3}, palette}.file());
    EXPECT_EQ(image.at(0, 0), (Rgba{1, 0, 0, 1}));
    EXPECT_EQ(image.at(1, 0), (Rgba{0, 51 / 255.0f, 0, 128 / 255.0f}));
}

TEST(png, values_are_as_stored_whatever_gamma_and_profile_say) {
    const std::string chunks = png_chunk("gAMA", big_endian(100000)) +
                               png_chunk("iCCP", std::string("bad\0\0nothing", 12));
    const Image image =
        read_bytes_as_image(PngBytes{1, 1, 8, 2, {"\0\x10\x80\xf0", 4}, chunks}.file());
    EXPECT_EQ(image.at(0, 0), (Rgba{16 / 255.0f, 128 / 255.0f, 240 / 255.0f, 1}));
}

TEST(png, every_truncation_is_refused) {
    const TempDir dir;
    write_png(dir / "a.png", small_image());
    expect_all_truncations_refused(read_bytes(dir / "a.png"), read_any_image);
}

TEST(png, changed_bytes_are_refused_or_read) {
    const TempDir dir;
    write_png(dir / "a.png", small_image());
    expect_survives_changed_bytes(read_bytes(dir / "a.png"), read_any_image);
}

TEST(png, sizes_beyond_reason_are_refused_before_memory_is_claimed) {
    PngBytes png{60000, 4000, 16, 6, "", ""};
    expect_refused(png.file(), read_any_image, "too few for the declared 60000x4000 pixels");
    png.height = 60000;
    expect_refused(png.file(), read_any_image, "at most 65536 a side");
    png.width = 70000;
    expect_refused(png.file(), read_any_image, "not a whole PNG image");
}

TEST(png, what_is_no_image_is_refused) {
    const TempDir dir;
    expect_refused("", read_any_image, "neither a PNG nor an EXR");
    expect_refused("P6 1 1 255 abc", read_any_image, "neither a PNG nor an EXR");
    EXPECT_NE(error_of([&] { (void)read_image(dir / "none.png"); }).find("no such file"),
              std::string::npos);
    EXPECT_THROW((void)read_image(dir / ""), Error);
}

TEST(png, failed_writes_leave_the_old_file) {
    const TempDir dir;
    write_bytes(dir / "a.png", "old");
    Image image = small_image();
    image.at(1, 1).g = kNan;
    const std::string message = error_of([&] { write_png(dir / "a.png", image); });
    EXPECT_NE(message.find("pixel (1, 1)"), std::string::npos) << message;
    EXPECT_THROW(write_png(dir / "a.png", Image()), Error);
    image.pixel.pop_back();
    EXPECT_THROW(write_png(dir / "a.png", image), Error);
    EXPECT_EQ(read_bytes(dir / "a.png"), "old");
    EXPECT_THROW(write_png(dir / "none/a.png", small_image()), Error);
}

TEST(image, full_disk_is_an_error) {
    if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
    EXPECT_THROW(write_png("/dev/full", small_image()), Error);
    EXPECT_THROW(write_exr("/dev/full", small_image()), Error);
    EXPECT_THROW(write_exr("/dev/full", small_depth()), Error);
}

}  // namespace
