// compare_maps_test.cpp: differences of maps in closed form, their files, and the command that prints them.
#include "vog/compare_maps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

#include "support/command.h"
#include "vog/error.h"
#include "vog/quantity.h"

namespace vog::test {

namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

FieldMaps four_pixels() { return {2, 2, {4, 1, 1e-4f, 0}, {10, 20, 99, kNone}, {1, 2, 3, kNone}}; }

void write_maps(const std::filesystem::path& file, const FieldMaps& maps) {
    const NamedValues channels[] = {
        {"column", maps.column}, {"mean", maps.mean}, {"deviation", maps.deviation}};
    write_channels(file, maps.width, maps.height, channels);
}

/// An .npy file of this header and these bytes.
void write_npy(const std::filesystem::path& file, const std::string& header, std::size_t bytes,
               char version = 1) {
    std::string text = header;
    text.resize(118, ' ');
    std::ofstream out(file, std::ios::binary);
    out << "\x93NUMPY" << version << '\0' << static_cast<char>(text.size()) << '\0';
    if (version == 2) out << '\0' << '\0';
    out << text << std::string(bytes, '\0');
}

}  // namespace

class compare_maps : public CommandLine {};

TEST_F(compare_maps, of_fields_weighs_pixels_by_the_column) {
    const FieldMaps reference = four_pixels();
    FieldMaps image = reference;
    image.mean = {11, 18, 0, 5};
    image.deviation = {1, 3, 0, 5};
    image.column[3] = 7;
    const FieldDifference difference = compare(reference, image);
    // The third pixel has too little column, the fourth none.
    const double mean2 = 4 * 100 + 400, deviation2 = 4 * 1 + 4;
    EXPECT_NEAR(difference.mean_l2, std::sqrt((4 * 1 + 4) / mean2), 1e-12);
    EXPECT_NEAR(difference.deviation_l2, std::sqrt(1 / (mean2 + deviation2)), 1e-12);
    EXPECT_NEAR(difference.mean_bias, (4 * 1 - 2) / 5.0, 1e-12);
    EXPECT_NEAR(difference.deviation_bias, 1 / 5.0, 1e-12);
    EXPECT_EQ(difference.largest_mean, -2);
    EXPECT_EQ(difference.largest_column, 1);
    EXPECT_EQ(difference.largest_row, 0);
    EXPECT_EQ(difference.counted, 0.5);
    EXPECT_EQ(difference.missing, 0);
    EXPECT_NEAR(difference.column_l2, std::sqrt(49 / (17 + 1e-8)), 1e-6);
    image.mean[0] = image.deviation[0] = kNone;
    EXPECT_NEAR(compare(reference, image).missing, 4 / 5.0, 1e-12);
    EXPECT_NEAR(compare(reference, image).mean_l2, std::sqrt((400 + 4) / mean2), 1e-12);
    EXPECT_EQ(compare(reference, reference).mean_l2, 0);
    FieldMaps none = reference;
    none.column.assign(4, 0);
    EXPECT_THROW((void)compare(none, reference), Error);
    EXPECT_THROW((void)compare(reference, FieldMaps{1, 1, {1}, {1}, {1}}), Error);
}

TEST_F(compare_maps, of_one_map_masks_where_the_reference_has_none) {
    const ValueMap reference{3, 1, {3, kNone, -4}};
    const MapDifference difference = compare(reference, {3, 1, {3, 8, kNone}});
    EXPECT_NEAR(difference.relative_l2, 4.0 / 5, 1e-12);
    EXPECT_EQ(difference.bias, 2);
    EXPECT_EQ(difference.largest, 4);
    EXPECT_EQ(difference.largest_column, 2);
    EXPECT_NEAR(difference.counted, 2 / 3.0, 1e-12);
    EXPECT_EQ(difference.missing, 0.5);
    EXPECT_THROW((void)compare(ValueMap{1, 1, {kNone}}, ValueMap{1, 1, {1}}), Error);
    EXPECT_THROW((void)compare(reference, ValueMap{1, 1, {1}}), Error);
}

TEST_F(compare_maps, files_are_read_back_bit_for_bit) {
    const FieldMaps maps = four_pixels();
    write_maps(dir_ / "a.exr", maps);
    write_map(dir_ / "a.npy", {2, 2, maps.mean});
    EXPECT_TRUE(is_field_file(dir_ / "a.exr") && is_map_file(dir_ / "a.npy"));
    EXPECT_FALSE(is_field_file(dir_ / "a.npy"));
    const FieldMaps back = read_field_maps(dir_ / "a.exr");
    const ValueMap mean = read_map(dir_ / "a.npy");
    EXPECT_EQ(mean.width, 2);
    for (std::size_t n = 0; n < 4; ++n) {
        EXPECT_EQ(back.column[n], maps.column[n]);
        EXPECT_EQ(std::memcmp(&back.deviation[n], &maps.deviation[n], 4), 0);
        EXPECT_EQ(std::memcmp(&mean.value[n], &maps.mean[n], 4), 0);
    }
}

TEST_F(compare_maps, arrays_of_other_kinds_are_refused_in_one_line) {
    const std::string good = "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }";
    write_npy(dir_ / "wide.npy", good, 48);
    EXPECT_EQ(read_map(dir_ / "wide.npy").width, 3);
    write_npy(dir_ / "second.npy", good, 48, 2);
    EXPECT_EQ(read_map(dir_ / "second.npy").height, 2);
    const auto refused = [&](const std::string& header, std::size_t bytes, const char* what) {
        write_npy(dir_ / "bad.npy", header, bytes);
        try {
            (void)read_map(dir_ / "bad.npy");
            ADD_FAILURE() << header;
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find(what), std::string::npos) << error.what();
        }
    };
    refused(good, 47, "47 bytes of values, expected 48 for 3x2 pixels");
    refused("{'descr': '<i4', 'fortran_order': False, 'shape': (2, 3), }", 24, "expected a NumPy");
    refused("{'descr': '<f4', 'fortran_order': True, 'shape': (2, 3), }", 24, "expected a NumPy");
    refused("{'descr': '<f4', 'fortran_order': False, 'shape': (6,), }", 24, "expected a NumPy");
    refused("{'descr': '<f4', 'fortran_order': False, 'shape': (0, 3), }", 0, "expected");
    refused("{'descr': '<f4', 'fortran_order': False, 'shape': (999999999, 999999999), }", 0,
            "expected");
    std::ofstream(dir_ / "short.npy") << "\x93NUMPY";
    EXPECT_THROW((void)read_map(dir_ / "short.npy"), Error);
}

TEST_F(compare_maps, the_command_prints_them) {
    FieldMaps maps = four_pixels();
    write_maps(dir_ / "a.exr", maps);
    write_map(dir_ / "a.npy", {2, 2, maps.mean});
    maps.mean[1] = 18;
    write_maps(dir_ / "b.exr", maps);
    write_map(dir_ / "b.npy", {2, 2, maps.mean});
    const std::string fields = must("compare a.exr b.exr").out;
    EXPECT_NE(fields.find("L2 of mean           0.0707107"), std::string::npos) << fields;
    EXPECT_NE(fields.find("-2 at column 1, row 0"), std::string::npos) << fields;
    EXPECT_NE(must("compare --json a.exr b.exr").out.find("\"kind\": \"field\""),
              std::string::npos);
    EXPECT_NE(must("compare a.npy b.npy").out.find("missing"), std::string::npos);
    EXPECT_NE(must("compare --json a.npy b.npy").out.find("\"kind\": \"map\""), std::string::npos);
    must_fail(1, "compare a.exr b.npy",
              "b.npy is a map; to compare it, use a file of a field's maps like");
    must_fail(2, "compare a.exr b.exr --tf jet",
              "--tf has no effect with maps; it works with depth images");
    must_fail(2, "compare a.exr b.exr --diff d.png", "--diff has no effect with maps");
}

}  // namespace vog::test
