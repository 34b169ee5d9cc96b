// transfer_function_json_test.cpp: transfer functions from ParaView's and from vog's JSON.
#include <gtest/gtest.h>

#include "support/data.h"
#include "support/refused_files.h"
#include "vog/shade.h"

namespace {

using namespace vog;
using namespace vog::test;

TransferFunction read_map(const std::string& text) {
    const TempDir dir;
    write_bytes(dir / "map.json", text);
    return read_transfer_function(dir / "map.json");
}

const auto read_any_map = [](const std::filesystem::path& file) {
    (void)read_transfer_function(file);
};

std::string preset(const std::string& keys) {
    return "[ { \"Name\" : \"test\", \"NanColor\" : [ 1, 1, 0 ], " + keys + " } ]";
}

const char* const kPoints =
    "\"RGBPoints\" : [ -2, 0.1, 0.2, 0.9,  0, 0.9, 0.8, 0.1,  6, 0.6, 0.1, 0.3 ]";

TEST(paraview_colors, are_those_of_paraview_in_every_space) {
    // Computed with VTK 9.1 (vtkColorTransferFunction) at V = 0.05, 0.2, 0.4, 0.7, 0.95 of kPoints.
    struct Case {
        const char* keys;
        float colors[5][3];
    };
    // clang-format off
    const Case cases[] = {
        {"\"ColorSpace\" : \"RGB\",", {{0.26000f, 0.32000f, 0.74000f}, {0.74000f, 0.68000f, 0.26000f}, {0.84000f, 0.66000f, 0.14000f}, {0.72000f, 0.38000f, 0.22000f}, {0.62000f, 0.14667f, 0.28667f}}},
        {"", {{0.26000f, 0.32000f, 0.74000f}, {0.74000f, 0.68000f, 0.26000f}, {0.84000f, 0.66000f, 0.14000f}, {0.72000f, 0.38000f, 0.22000f}, {0.62000f, 0.14667f, 0.28667f}}},
        {"\"ColorSpace\" : \"HSV\",", {{0.10000f, 0.68000f, 0.90000f}, {0.52000f, 0.90000f, 0.10000f}, {0.23539f, 0.84000f, 0.10267f}, {0.10400f, 0.28264f, 0.72000f}, {0.62000f, 0.10104f, 0.47210f}}},
        {"\"ColorSpace\" : \"HSV\", \"HSVWrap\" : 1,", {{0.10000f, 0.68000f, 0.90000f}, {0.52000f, 0.90000f, 0.10000f}, {0.84000f, 0.55981f, 0.10267f}, {0.72000f, 0.17176f, 0.10400f}, {0.62000f, 0.10104f, 0.26451f}}},
        {"\"ColorSpace\" : \"Lab\",", {{0.48225f, 0.30847f, 0.77679f}, {0.83428f, 0.67267f, 0.36446f}, {0.84854f, 0.67117f, 0.19697f}, {0.73317f, 0.41329f, 0.27387f}, {0.62354f, 0.17032f, 0.29775f}}},
        {"\"ColorSpace\" : \"CIELAB\",", {{0.48225f, 0.30847f, 0.77679f}, {0.83428f, 0.67267f, 0.36446f}, {0.84854f, 0.67117f, 0.19697f}, {0.73317f, 0.41329f, 0.27387f}, {0.62354f, 0.17032f, 0.29775f}}},
        {"\"ColorSpace\" : \"Diverging\",", {{0.56013f, 0.56431f, 1.00000f}, {1.00000f, 0.91139f, 0.55947f}, {1.00000f, 0.91139f, 0.55947f}, {1.00000f, 0.92142f, 0.78640f}, {0.73357f, 0.24575f, 0.32529f}}},
        {"\"ColorSpace\" : \"Step\",", {{0.90000f, 0.80000f, 0.10000f}, {0.90000f, 0.80000f, 0.10000f}, {0.60000f, 0.10000f, 0.30000f}, {0.60000f, 0.10000f, 0.30000f}, {0.60000f, 0.10000f, 0.30000f}}},
    };
    // clang-format on
    constexpr float kHalfStep = 0.5f / 255;  // what the header promises of sampling
    const float at[] = {0.05f, 0.2f, 0.4f, 0.7f, 0.95f};
    for (const Case& c : cases) {
        const TransferFunction tf = read_map(preset(c.keys + std::string(kPoints)));
        EXPECT_EQ(tf.name, "test");
        EXPECT_TRUE(tf.opacity.empty());
        for (int i = 0; i < 5; ++i) {
            const Rgba color = color_at(tf, at[i]);
            EXPECT_NEAR(color.r, c.colors[i][0], kHalfStep) << c.keys << at[i];
            EXPECT_NEAR(color.g, c.colors[i][1], kHalfStep) << c.keys << at[i];
            EXPECT_NEAR(color.b, c.colors[i][2], kHalfStep) << c.keys << at[i];
        }
        const ColorPoint last{1, 0.6f, 0.1f, 0.3f};
        EXPECT_EQ(tf.color.front().v, 0);
        EXPECT_EQ(tf.color.back().v, last.v);
        EXPECT_EQ(tf.color.back().g, last.g);
    }
}

TEST(paraview_opacity, has_midpoints_sharpness_and_the_range_of_the_colors) {
    // Computed with VTK 9.1 (vtkPiecewiseFunction): a line that starts below the colours' range,
    // a sharpened piece, a step at V = 0.825.
    const TransferFunction tf = read_map(preset(
        std::string(kPoints) +
        ", \"Points\" : [ -4, 0, 0.5, 0,  0, 0.8, 0.25, 0.5,  4, 0.2, 0.3, 1,  6, 1, 0.5, 0 ]"));
    const float expected[][2] = {{0, 0.4f},        {0.1f, 0.56f},    {0.25f, 0.8f},
                                 {0.3f, 0.79938f}, {0.4f, 0.37581f}, {0.5f, 0.21485f},
                                 {0.7f, 0.2f},     {0.8f, 0.2f},     {0.82f, 0.2f},
                                 {0.83f, 1},       {0.95f, 1},       {1, 1}};
    for (const auto& [v, opacity] : expected)
        EXPECT_NEAR(color_at(tf, v).a, opacity, 0.5f / 255) << v;
}

TEST(paraview_opacity, beside_the_colors_is_its_nearest_value) {
    const TransferFunction tf = read_map(
        preset(std::string(kPoints) + ", \"Points\" : [ 7, 0.25, 0.5, 0,  9, 1, 0.5, 0 ]"));
    EXPECT_EQ(color_at(tf, 0).a, 0.25f);
    EXPECT_EQ(color_at(tf, 1).a, 0.25f);
}

TEST(paraview_colors, first_preset_counts_and_one_may_stand_alone) {
    const std::string one = "{\"Name\":\"a\",\"RGBPoints\":[0,0,0,0,1,1,1,1]}";
    const std::string other = "{\"Name\":\"b\",\"RGBPoints\":[0,1,0,0,1,1,0,0]}";
    EXPECT_EQ(read_map("[" + one + "," + other + "]").name, "a");
    EXPECT_EQ(read_map(other).name, "b");
}

TEST(paraview_colors, equal_scalars_make_a_step) {
    const TransferFunction tf =
        read_map(preset("\"RGBPoints\" : [ 0,1,0,0, 5,1,0,0, 5,0,0,1, 10,0,0,1 ]"));
    EXPECT_EQ(color_at(tf, 0.499f), (Rgba{1, 0, 0, 1}));
    EXPECT_EQ(color_at(tf, 0.5f), (Rgba{0, 0, 1, 1}));
}

TEST(paraview_colors, what_is_no_map_is_refused_with_its_key) {
    expect_refused(preset("\"ColorSpace\" : \"RGB\""), read_any_map, "no RGBPoints");
    expect_refused(preset("\"IndexedColors\" : [ 1, 0, 0 ]"), read_any_map,
                   "a map of categories has no range");
    expect_refused(preset("\"RGBPoints\" : [ 0, 0, 0, 0, 1, 1, 1 ]"), read_any_map,
                   "RGBPoints: 7 numbers, expected a multiple of 4");
    expect_refused(preset("\"RGBPoints\" : []"), read_any_map, "RGBPoints: no points");
    expect_refused(preset("\"RGBPoints\" : \"blue\""), read_any_map,
                   "RGBPoints: string, expected an array");
    expect_refused(preset("\"RGBPoints\" : [ 0, 0, 0, null, 1, 1, 1, 1 ]"), read_any_map,
                   "RGBPoints[3]: null, expected a number");
    expect_refused(preset("\"RGBPoints\" : [ 1, 0, 0, 0, 0, 1, 1, 1 ]"), read_any_map,
                   "RGBPoints: point 1 at 0 after 1");
    expect_refused(preset("\"RGBPoints\" : [ 2, 0, 0, 0, 2, 1, 1, 1 ]"), read_any_map,
                   "from 2 to 2");
    expect_refused(preset("\"RGBPoints\" : [ 2, 0, 0, 0 ]"), read_any_map, "from 2 to 2");
    expect_refused(preset("\"RGBPoints\" : [ -1e308, 0, 0, 0, 1e308, 1, 1, 1 ]"), read_any_map,
                   "finite range");
    expect_refused(preset("\"RGBPoints\" : [ 0, 0, 0, 0, 1, 255, 255, 255 ]"), read_any_map,
                   "in [0, 1]");
    expect_refused(preset("\"ColorSpace\" : \"XYZ\", " + std::string(kPoints)), read_any_map,
                   "ColorSpace: 'XYZ', expected RGB");
    expect_refused(preset("\"UseLogScale\" : 1, " + std::string(kPoints)), read_any_map,
                   "UseLogScale");
    expect_refused(preset(std::string(kPoints) + ", \"Points\" : [ 0, 1, 0.5 ]"), read_any_map,
                   "Points: 3 numbers, expected a multiple of 4");
    expect_refused(preset(std::string(kPoints) + ", \"Points\" : [ 0, 2, 0.5, 0 ]"), read_any_map,
                   "Points: point at 0 has 2");
    expect_refused("[]", read_any_map, "an array without a preset");
    expect_refused("[1]", read_any_map, "an array without a preset");
}

TEST(own_json, holds_colors_and_opacity) {
    const TransferFunction tf = read_map(R"({"name": "fire",
        "colors": [[0, 0, 0, 0], [0.5, 1, 0, 0], [1, 1, 1, 0]], "opacity": [[0.25, 0], [1, 0.5]]})");
    EXPECT_EQ(tf.name, "fire");
    EXPECT_EQ(color_at(tf, 0.25f), (Rgba{0.5f, 0, 0, 0}));
    EXPECT_EQ(color_at(tf, 1), (Rgba{1, 1, 0, 0.5f}));
}

TEST(own_json, takes_colors_from_a_named_map) {
    const TransferFunction tf = read_map(R"({"colors": "jet", "opacity": [[0, 0], [1, 1]]})");
    EXPECT_EQ(tf.name, "jet");
    EXPECT_EQ(color_at(tf, 0.875f), (Rgba{1, 0, 0, 0.875f}));
    EXPECT_EQ(read_map(R"({"colors": [[0, 1, 1, 1]]})").name, "map");  // the file's
}

TEST(own_json, survives_a_round_trip_bit_by_bit) {
    TransferFunction tf = named_transfer_function("coolwarm");
    tf.name = "a \"quoted\"\nname \xc3\xa9";
    tf.opacity = {{0.1f, 1.0f / 3}, {0.7f, 1e-20f}};
    const TempDir dir;
    for (const bool with_opacity : {true, false}) {
        if (!with_opacity) tf.opacity.clear();
        write_transfer_function(dir / "a.json", tf);
        const TransferFunction read = read_transfer_function(dir / "a.json");
        EXPECT_EQ(read.name, tf.name);
        ASSERT_EQ(read.color.size(), tf.color.size());
        for (std::size_t i = 0; i < tf.color.size(); ++i) {
            EXPECT_EQ(read.color[i].v, tf.color[i].v);
            EXPECT_EQ(read.color[i].b, tf.color[i].b);
        }
        ASSERT_EQ(read.opacity.size(), tf.opacity.size());
        for (std::size_t i = 0; i < tf.opacity.size(); ++i)
            EXPECT_EQ(read.opacity[i].opacity, tf.opacity[i].opacity);
    }
    EXPECT_THROW(write_transfer_function(dir / "a.json", TransferFunction{}), Error);
}

TEST(own_json, what_is_no_map_is_refused_with_its_key) {
    expect_refused("", read_any_map, "not JSON");
    expect_refused("\xff\xfe\x7b", read_any_map, "not JSON");
    expect_refused("{\"colors\": [[0, 0, 0, 0]", read_any_map, "not JSON");
    expect_refused("{}", read_any_map, "no transfer function");
    expect_refused("12", read_any_map, "no transfer function");
    expect_refused("{\"colors\": []}", read_any_map, "colors: no points");
    expect_refused("{\"colors\": [[0, 0, 0]]}", read_any_map,
                   "colors[0]: expected an array of 4 numbers");
    expect_refused("{\"colors\": [[0, 0, 0, \"1\"]]}", read_any_map,
                   "colors[0]: string, expected a number");
    expect_refused("{\"colors\": [[1, 0, 0, 0], [0, 1, 1, 1]]}", read_any_map,
                   "colors: point 1 at 0 after 1");
    expect_refused("{\"colors\": [[0, 0, 0, 0], [2, 1, 1, 1]]}", read_any_map, "in [0, 1]");
    expect_refused("{\"colors\": [[0, 0, 0, 1e999]]}", read_any_map, "");
    expect_refused("{\"colors\": \"rainbow\"}", read_any_map,
                   "colors: 'rainbow', expected points or one of");
    expect_refused("{\"colors\": \"jet\", \"opacity\": [[0, -1]]}", read_any_map,
                   "opacity point 0");
    expect_refused("{\"colors\": \"jet\", \"opactiy\": [[0, 1]]}", read_any_map,
                   "unknown key 'opactiy'");
    expect_refused("{\"colors\": \"jet\", \"name\": 3}", read_any_map,
                   "name: number, expected a string");
}

TEST(own_json, every_truncation_is_refused) {
    const std::string text = R"({"colors": [[0, 0, 0, 0], [1, 1, 1, 1]], "opacity": [[0, 1]]})";
    for (std::size_t size = 0; size < text.size(); ++size)
        EXPECT_THROW((void)read_map(text.substr(0, size)), Error) << size;
}

TEST(load_transfer_function, takes_a_name_or_a_file) {
    const TempDir dir;
    write_bytes(dir / "map.json", R"({"colors": [[0, 1, 0, 0]]})");
    EXPECT_EQ(load_transfer_function("Jet").name, "jet");
    EXPECT_EQ(load_transfer_function((dir / "map.json").string()).name, "map");
    EXPECT_THROW((void)load_transfer_function((dir / "none.json").string()), Error);
    EXPECT_THROW((void)load_transfer_function(""), Error);
    EXPECT_THROW((void)load_transfer_function((dir / ".").string()), Error);
}

}  // namespace
