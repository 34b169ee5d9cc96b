// label_table_test.cpp: tables of labels by 3D Slicer, FreeSurfer and ITK-SNAP as transfer functions.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "support/data.h"
#include "support/refused_files.h"
#include "vog/value_transfer.h"

namespace vog::test {

namespace {

/// A table, or a label of it.
TransferPoints read_table(const std::string& text, const std::string& label = {}) {
    const TempDir dir;
    write_bytes(dir / "organs.ctbl", text);
    return transfer_points((dir / "organs.ctbl").string() + label);
}
ValueLight light_at(const TransferPoints& points, double value) {
    return light_of(over_range(points, 0, 1, 1), value);
}
const auto read_any_table = [](const std::filesystem::path& file) {
    (void)transfer_points(file.string());
};

const char* const kSlicer =
    "# Color table file organs.ctbl\n"
    "# 4 values\n"
    "0 Background 0 0 0 0\n"
    "1 liver 221 130 101 255\n"
    "3 left_lung 197 165 145 51\r\n"
    "2 spleen 157 108 162 0\n";

const char* const kSnap =
    "################################################\n"
    "# ITK-SnAP Label Description File\n"
    "    0     0    0    0        0  0  0    \"Clear Label\"\n"
    "    1   255    0    0        1  1  1    \"Left lung\"\n"
    "    2     0  255    0        0.5  1  0    \"Liver\"\n"
    "    3     0    0  255        1  0  1    \"Hidden\"\n";

}  // namespace

TEST(label_table, of_slicer_has_a_band_for_each_visible_label) {
    const TransferPoints points = read_table(kSlicer);
    EXPECT_TRUE(points.at_values);
    EXPECT_FALSE(points.has_unit_distance);
    EXPECT_EQ(points.points.name, "organs");
    EXPECT_EQ(points.lower, 0.5);
    EXPECT_EQ(points.upper, 3.5);
    for (const double clear : {-1.0, 0.0, 0.49, 1.5, 2.0, 2.49, 3.5, 9.0})
        EXPECT_EQ(light_at(points, clear).extinction, 0) << clear;
    for (const double liver : {0.5, 1.0, 1.49}) {
        const ValueLight light = light_at(points, liver);
        EXPECT_NEAR(light.extinction, -std::log(1 - kMostOpacity), 1e-9);
        EXPECT_NEAR(light.r, 221.0 / 255, 1e-6);
        EXPECT_NEAR(light.g, 130.0 / 255, 1e-6);
        EXPECT_NEAR(light.b, 101.0 / 255, 1e-6);
    }
    const ValueLight lung = light_at(points, 3);
    EXPECT_NEAR(lung.extinction, -std::log(0.8), 1e-9);
    EXPECT_NEAR(lung.g, 165.0 / 255, 1e-6);
}

TEST(label_table, of_itk_snap_hides_what_it_hides) {
    const TransferPoints points = read_table(kSnap);
    EXPECT_EQ(points.upper, 2.5);
    EXPECT_NEAR(light_at(points, 1).r, 1, 1e-6);
    EXPECT_NEAR(light_at(points, 2).g, 1, 1e-6);
    EXPECT_NEAR(light_at(points, 2).extinction, -std::log(0.5), 1e-9);
    EXPECT_EQ(light_at(points, 0).extinction, 0);
    EXPECT_EQ(light_at(points, 3).extinction, 0);
}

TEST(label_table, without_opacities_shows_all_but_the_background) {
    const TransferPoints points = read_table("0 Unknown 0 0 0 0\n2 Left-White 245 245 245 0\n");
    EXPECT_EQ(points.lower, 1.5);
    EXPECT_GT(light_at(points, 2).extinction, 9);
}

TEST(label_table, is_read_as_windows_writes_it) {
    const TransferPoints points = read_table(
        "\xef\xbb\xbf"
        "1 L\xc3\xa9sion 200 0 0 255\r\n2 b 0 200 0 255\r\n");
    EXPECT_EQ(points.lower, 0.5);
    EXPECT_EQ(points.upper, 2.5);
}

TEST(label_table, a_name_chooses_a_label) {
    for (const char* const name : {":left_lung", ":Left lung"}) {
        const TransferPoints points = read_table(kSlicer, name);
        EXPECT_EQ(points.lower, 2.5) << name;
        EXPECT_EQ(light_at(points, 1).extinction, 0);
        EXPECT_NEAR(light_at(points, 3).extinction, -std::log(0.8), 1e-9);
    }
    EXPECT_GT(light_at(read_table(kSlicer, ":spleen"), 2).extinction, 9);  // hidden in the table
    EXPECT_GT(light_at(read_table(kSnap, ":hidden"), 3).extinction, 9);
    const std::string message = error_of([] { (void)read_table(kSlicer, ":kidney"); });
    EXPECT_NE(message.find("no label 'kidney', expected one of Background, liver"),
              std::string::npos)
        << message;
}

TEST(label_table, is_refused_by_its_line) {
    expect_refused("1 liver 221 130 300 255\n", read_any_table, "line 1 '1 liver 221 130 300 255'");
    expect_refused("# a\n1.5 liver 1 2 3 4\n", read_any_table, "line 2");
    expect_refused("1 liver 1 2\n", read_any_table, "a table of labels");
    expect_refused("1 liver 1 2 3 4\n1 spleen 1 2 3 4\n", read_any_table, "label 1 twice");
    expect_refused("0 Background 0 0 0 0\n", read_any_table, "no label is visible");
    expect_refused("# nothing\n", read_any_table, "no label is visible");
    expect_refused("nan liver 1 2 3 4\n", read_any_table, "line 1");
}

}  // namespace vog::test
