// exr_test.cpp: writing, reading and refusing EXR images of depth and of colour.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <random>

#include "support/images.h"
#include "support/refused_files.h"

namespace {

using namespace vog;
using namespace vog::test;

TEST(exr, depth_survives_a_round_trip_bit_by_bit) {
    // Odd sizes; the last compressed block of 16 rows is incomplete.
    DepthImage image(37, 53);
    std::mt19937 random(7);
    for (float& t : image.depth) t = std::exp2(static_cast<float>(random() % 200) - 100.0f);
    image.extinction = 1.0 / 3;
    const TempDir dir;
    write_exr(dir / "t.exr", image);
    const DepthImage read = read_depth(dir / "t.exr");
    EXPECT_EQ(read.width, 37);
    EXPECT_EQ(read.height, 53);
    EXPECT_EQ(read.depth, image.depth);
    EXPECT_EQ(read.extinction, image.extinction);
    EXPECT_NE(read_bytes(dir / "t.exr").find(std::string("extinction\0double", 17)),
              std::string::npos);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(dir / "."), {}), 1);
}

TEST(exr, colors_survive_a_round_trip) {
    const TempDir dir;
    Image image(19, 300);  // more rows than are read at once
    std::mt19937 random(7);
    const auto component = [&] { return static_cast<float>(random() % 10000) / 9999; };
    for (Rgba& pixel : image.pixel) pixel = {component(), component(), component(), 1};
    write_exr(dir / "a.exr", image);
    EXPECT_EQ(read_image(dir / "a.exr").pixel, image.pixel);

    // Two roundings of half a unit in the last place, by multiplying with alpha and dividing by it.
    constexpr float kTolerance = 2 * std::numeric_limits<float>::epsilon();
    for (Rgba& pixel : image.pixel) pixel.a = 0.01f + 0.99f * component();
    write_exr(dir / "b.exr", image);
    const Image read = read_image(dir / "b.exr");
    for (std::size_t i = 0; i < image.pixel.size(); ++i) {
        EXPECT_EQ(read.pixel[i].a, image.pixel[i].a);
        EXPECT_NEAR(read.pixel[i].g, image.pixel[i].g, kTolerance);
    }
}

std::string floats(std::initializer_list<float> values) {
    std::string bytes;
    for (const float value : values) bytes += little_endian(value);
    return bytes;
}

TEST(exr, colors_in_files_are_multiplied_by_alpha) {
    const ExrBytes exr{{{"A", kExrFloat}, {"B", kExrFloat}, {"G", kExrFloat}, {"R", kExrFloat}},
                       1,
                       1,
                       0,
                       1,
                       {floats({0.5f, 0.125f, 0.25f, 0.5f})},
                       ""};
    EXPECT_EQ(read_bytes_as_image(exr.file()).at(0, 0), (Rgba{1, 0.5f, 0.25f, 0.5f}));
}

TEST(exr, half_colors_without_alpha_are_read_as_opaque) {
    const std::string half_one = {"\x00\x3c", 2}, half_quarter = {"\x00\x34", 2};
    const ExrBytes exr{{{"B", kExrHalf}, {"G", kExrHalf}, {"R", kExrHalf}},
                       1,
                       1,
                       0,
                       1,
                       {half_one + half_quarter + half_one},
                       ""};
    EXPECT_EQ(read_bytes_as_image(exr.file()).at(0, 0), (Rgba{1, 0.25f, 1, 1}));
}

TEST(exr, extinction_is_one_if_absent_and_may_be_a_float) {
    const TempDir dir;
    ExrBytes exr{{{"Y", kExrFloat}}, 2, 1, 0, 1, {floats({0, 2})}, ""};
    write_bytes(dir / "a.exr", exr.file());
    EXPECT_EQ(read_depth(dir / "a.exr").extinction, 1);
    EXPECT_EQ(read_depth(dir / "a.exr").depth, (std::vector<float>{0, 2}));
    exr.more = exr_attribute("extinction", "float", little_endian(0.25f));
    write_bytes(dir / "a.exr", exr.file());
    EXPECT_EQ(read_depth(dir / "a.exr").extinction, 0.25);
    exr.more = exr_attribute("extinction", "string", "much");
    expect_refused(exr.file(), read_any_depth, "attribute extinction is of type 'string'");
    exr.more = exr_attribute("extinction", "double", little_endian(-1.0));
    expect_refused(exr.file(), read_any_depth, "extinction -1, expected a finite number above 0");
}

TEST(exr, depth_and_color_files_are_told_apart) {
    const TempDir dir;
    write_exr(dir / "t.exr", small_depth());
    write_exr(dir / "c.exr", small_image());
    write_png(dir / "c.png", small_image());
    EXPECT_TRUE(is_depth_file(dir / "t.exr"));
    EXPECT_FALSE(is_depth_file(dir / "c.exr"));
    EXPECT_FALSE(is_depth_file(dir / "c.png"));
    EXPECT_THROW((void)is_depth_file(dir / "none.exr"), Error);
    expect_refused(read_bytes(dir / "t.exr"), read_any_image, "channels Y, expected R, G, B");
    expect_refused(read_bytes(dir / "c.exr"), read_any_depth,
                   "channels A, B, G, R, expected only Y");
    expect_refused(read_bytes(dir / "c.png"), read_any_depth, "not an EXR image");
}

TEST(exr, what_no_depth_image_is_is_refused) {
    const ExrBytes good{{{"Y", kExrFloat}}, 2, 1, 0, 1, {floats({1, 2})}, ""};
    ExrBytes exr = good;
    exr.channels[0].second = kExrHalf;
    exr.rows = {std::string(4, '\0')};
    expect_refused(exr.file(), read_any_depth, "channel Y is half, expected float32");
    exr = good;
    exr.channels[0].second = kExrUint;
    expect_refused(exr.file(), read_any_depth, "channel Y is uint32, expected float32");
    exr = good;
    exr.display_width = 3;
    expect_refused(exr.file(), read_any_depth, "data window");
    exr = good;
    exr.sampling = 2;
    expect_refused(exr.file(), read_any_depth, "");
    for (const float t : {kNan, kInfinity, -0.5f}) {
        exr = good;
        exr.rows = {floats({1, t})};
        expect_refused(exr.file(), read_any_depth,
                       "at pixel (1, 0), expected a finite number >= 0");
    }
}

TEST(exr, sizes_beyond_reason_are_refused) {
    ExrBytes exr{{{"Y", kExrFloat}}, 2000000000, 1, 0, 1, {floats({1})}, ""};
    expect_refused(exr.file(), read_any_depth, "");
    exr.width = 1, exr.height = 2000000000;
    expect_refused(exr.file(), read_any_depth, "");
    exr.width = 65536, exr.height = 4096;  // within the limits, but the rows are not there
    expect_refused(exr.file(), read_any_depth, "not a whole EXR image");
}

TEST(exr, rows_never_written_are_refused) {
    // A crashed writer leaves zeros in the offset table, and OpenEXR would reconstruct it.
    const ExrBytes exr{{{"Y", kExrFloat}}, 1, 2, 0, 1, {floats({1}), floats({2})}, ""};
    std::string bytes = exr.file();
    constexpr std::size_t kChunk = 4 + 4 + 4,
                          kOffset = 8;  // row, size and one float; a table entry
    for (std::size_t i = 0; i < kOffset; ++i) bytes[bytes.size() - 2 * kChunk - kOffset + i] = 0;
    expect_refused(bytes, read_any_depth, "rows are missing");
}

TEST(exr, attributes_larger_than_the_file_are_refused_before_memory_is_claimed) {
    ExrBytes exr{{{"Y", kExrFloat}}, 1, 1, 0, 1, {floats({1})}, ""};
    exr.more = std::string("note\0opaque\0", 12) + little_endian(0x7fffffff);
    expect_refused(exr.file(), read_any_depth, "attribute note goes beyond the end");
    exr.more = std::string("note\0opaque\0", 12) + little_endian(-1);
    expect_refused(exr.file(), read_any_depth, "attribute note goes beyond the end");
}

TEST(exr, attributes_of_another_size_than_their_type_are_refused) {
    ExrBytes exr{{{"Y", kExrFloat}}, 1, 1, 0, 1, {floats({1})}, ""};
    const std::string none(64, '\0');
    for (const auto& [type, value] : std::vector<std::pair<std::string, std::string>>{
             {"float", none},
             {"chlist", "Z" + none},
             {"chlist", std::string(16, 'Z')},
             {"preview", little_endian(1 << 14) + little_endian(1 << 14)},
             {"stringvector", little_endian(1 << 30)}}) {
        exr.more = exr_attribute("note", type, value);
        expect_refused(exr.file(), read_any_depth, "attribute note of type '" + type + "'");
    }
    exr.more =
        exr_attribute("note", "preview", little_endian(1) + little_endian(1) + none.substr(0, 4));
    exr.more += exr_attribute("names", "stringvector", little_endian(2) + "ab" + little_endian(0));
    const TempDir dir;
    write_bytes(dir / "t.exr", exr.file());
    EXPECT_EQ(read_depth(dir / "t.exr").depth, std::vector<float>{1});
}

TEST(exr, several_parts_and_deep_pixels_are_refused) {
    for (const int flags : {0x08, 0x10}) {
        std::string bytes = ExrBytes{{{"Y", kExrFloat}}, 1, 1, 0, 1, {floats({1})}, ""}.file();
        bytes[5] = static_cast<char>(flags);  // second byte of the version
        expect_refused(bytes, read_any_depth, "expected one flat image");
    }
}

TEST(exr, every_truncation_is_refused) {
    const TempDir dir;
    write_exr(dir / "t.exr", small_depth());
    write_exr(dir / "c.exr", small_image());
    expect_all_truncations_refused(read_bytes(dir / "t.exr"), read_any_depth);
    expect_all_truncations_refused(read_bytes(dir / "c.exr"), read_any_image);
}

TEST(exr, changed_bytes_are_refused_or_read) {
    const TempDir dir;
    write_exr(dir / "t.exr", small_depth());
    expect_survives_changed_bytes(read_bytes(dir / "t.exr"), read_any_depth);
}

TEST(exr, non_finite_depth_is_not_written) {
    const TempDir dir;
    DepthImage image = small_depth();
    image.at(2, 0) = kNan;
    EXPECT_THROW(write_exr(dir / "t.exr", image), Error);
    EXPECT_FALSE(std::filesystem::exists(dir / "t.exr"));
}

}  // namespace
