// column_density_test.cpp: vog render --show column: numbers, ranges, colour bars and their refusals.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "support/command.h"
#include "support/level_volumes.h"
#include "vog/image.h"
#include "vog/volume_io.h"

namespace vog::test {

namespace {

using Json = nlohmann::json;

/// Values of a .npy of float32.
std::vector<float> npy_values(const std::string& bytes) {
    const std::size_t begin = bytes.find('\n') + 1;
    std::vector<float> values((bytes.size() - begin) / sizeof(float));
    std::memcpy(values.data(), bytes.data() + begin, values.size() * sizeof(float));
    return values;
}

}  // namespace

class column_density_command : public CommandLine {
  protected:
    /// A cube of 20 world units of constant density.
    void write_cube(const std::string& file, float density) const {
        Volume cube = cube_of(20, density, {});
        cube.name = "density";
        write_vdb(dir_ / file, cube);
    }
};

TEST_F(column_density_command, values_are_density_times_length) {
    write_cube("cube.vdb", 0.25f);
    // From far away on the axis, rays through the middle are 20 world units long.
    const std::string view = " --eye 9.5,9.5,4000 --look-at 9.5,9.5,9.5 --fov 0.4 --size 64x48";
    const auto report = Json::parse(must("render cube.vdb --show column -o map.png --units g/cm2 "
                                         "--color-bar --title cube --values-out map.npy --json" +
                                         view)
                                        .out);
    EXPECT_EQ(report["quantity"], "column density");
    EXPECT_EQ(report["units"], "g/cm2");
    EXPECT_EQ(report["log"], false);
    EXPECT_EQ(report["range"][0], 0);
    EXPECT_NEAR(report["range"][1].get<double>(), 5, 1e-3);
    const std::vector<float> values = npy_values(read_text(dir_ / "map.npy"));
    ASSERT_EQ(values.size(), 64u * 48u);
    EXPECT_NEAR(values[24 * 64 + 32], 5, 1e-4);
    EXPECT_EQ(values[0], 0);
    const Image map = read_image(dir_ / "map.png");
    EXPECT_GT(map.width, 64);
    EXPECT_GT(map.height, 48);
    must("render cube.vdb --show column --values-out map.exr" + view);
    EXPECT_EQ(read_depth(dir_ / "map.exr").depth, values);
    // T is the same numbers times the extinction.
    must("render cube.vdb --values-out T.npy --extinction 3" + view);
    EXPECT_NEAR(npy_values(read_text(dir_ / "T.npy"))[24 * 64 + 32], 15, 1e-3);
}

TEST_F(column_density_command, particles_give_number_and_value_per_area) {
    std::string text = "x,y,z,mass\n";
    for (int n = 0; n < 200; ++n)
        text += std::to_string(n % 7) + "," + std::to_string(n % 11) + "," +
                std::to_string(n % 13) + ",2.5\n";
    write("p.csv", text);
    must("render p.csv --show column --radius 0.5 --values-out count.npy --size 32");
    const auto report = Json::parse(
        must("render p.csv --show column --radius 0.5 --value mass --values-out mass.npy --size 32 "
             "--json")
            .out);
    EXPECT_EQ(report["quantity"], "mass per area");
    const std::vector<float> count = npy_values(read_text(dir_ / "count.npy"));
    const std::vector<float> mass = npy_values(read_text(dir_ / "mass.npy"));
    // At the rims of supports F is a small difference: SIMD targets with coarse reciprocals round T to 1e-4 there.
    for (std::size_t n = 0; n < count.size(); ++n)
        ASSERT_NEAR(mass[n], 2.5f * count[n], 3e-4f * mass[n] + 1e-9f);
}

TEST_F(column_density_command, colours_follow_the_range_and_its_logarithm) {
    write_cube("cube.vdb", 0.25f);
    const std::string view =
        "render cube.vdb --show column --tf gray --eye 9.5,9.5,4000 --look-at 9.5,9.5,9.5 --fov "
        "0.4 --size 32 -o map.png ";
    const auto middle = [&] { return read_image(dir_ / "map.png").at(16, 16).r; };
    must(view + "--range 0,10");
    EXPECT_NEAR(middle(), 0.5, 1.0 / 255);
    must(view + "--range 0.05,500 --scale log");
    EXPECT_NEAR(middle(), 0.5, 1.0 / 255);
    must(view + "--range 0,2 --background 0,0,1");
    EXPECT_EQ(middle(), 1);
    EXPECT_EQ(read_image(dir_ / "map.png").at(0, 0).b, 1) << "empty pixels: the background";
}

TEST_F(column_density_command, a_sequence_has_one_range) {
    write_cube("step_1.vdb", 0.25f);
    write_cube("step_2.vdb", 0.5f);
    const Result result = must(
        "render 'step_*.vdb' -o maps/ --values-out values/ --show column --size 32 --color-bar "
        "--json");
    const auto pictures = Json::parse(result.out)["pictures"];
    EXPECT_EQ(pictures[0]["range"], pictures[1]["range"]);
    EXPECT_EQ(pictures[0]["above_range"], 0);
    EXPECT_GT(pictures[1]["above_range"].get<double>(), 0);
    EXPECT_NE(result.error.find("the range of the first"), std::string::npos) << result.error;
    const std::vector<float> first = npy_values(read_text(dir_ / "values/step_1.npy"));
    const std::vector<float> second = npy_values(read_text(dir_ / "values/step_2.npy"));
    EXPECT_NEAR(*std::ranges::max_element(second), 2 * *std::ranges::max_element(first), 1e-3);
    must("render 'step_*.vdb' -o volumes/ --show volume --size 16");
    EXPECT_TRUE(std::filesystem::exists(dir_ / "volumes/step_2.png"));
}

TEST_F(column_density_command, a_colour_bar_of_t_leaves_the_picture_as_it_was) {
    write_cube("cube.vdb", 0.25f);
    must("render cube.vdb -o plain.png --size 128");
    must("render cube.vdb -o bar.png --size 128 --color-bar --show T");
    const Image plain = read_image(dir_ / "plain.png"), bar = read_image(dir_ / "bar.png");
    ASSERT_GT(bar.width, 128 + 30);
    ASSERT_EQ(bar.height, 128);
    for (int row = 0; row < 128; ++row)
        for (int column = 0; column < 128; ++column)
            ASSERT_EQ(bar.at(column, row), plain.at(column, row));
}

TEST_F(column_density_command, options_that_contradict_are_refused) {
    write_cube("cube.vdb", 0.25f);
    const std::string render = "render cube.vdb -o a.png ";
    must_fail(2, render + "--scale log", "--scale has no effect with --show T");
    must_fail(2, render + "--range 0,1", "--range has no effect with --show T");
    must_fail(2, render + "--units g", "--units has no effect with --show T");
    must_fail(2, render + "--show column --extinction 2", "--extinction");
    must_fail(2, render + "--show column --blend", "--blend");
    for (const char* range : {"1", "2,1", "a,b", "0,inf", "1,2,3", "0,1x"})
        must_fail(2, render + "--show column --range " + range, "--range");
    must_fail(2, render + "--show column --scale log --range 0,1", "above 0");
    must_fail(2, "render cube.vdb --show column --values-out a.npy --color-bar", "--color-bar");
    must_fail(1, render + "--values-out a.txt", "a.txt: this command writes .npy, .exr");
    must_fail(1, render + "--title '\xe6\x97\xa5'", "no glyph");
}

TEST_F(column_density_command, numbers_convert_between_units_that_a_file_states) {
    // 4 voxels of 2 kpc along z, of 3 g/cm3.
    const std::string head =
        "NRRD0004\ntype: float\ndimension: 3\nsizes: 4 4 4\nspacings: 2 2 2\nendian: little\n"
        "encoding: raw\nunits: \"kpc\" \"kpc\" \"kpc\"\nsample units: g/cm3\n\n";
    const std::vector<float> three(64, 3.0f);
    std::string bytes(64 * sizeof(float), '\0');
    std::memcpy(bytes.data(), three.data(), bytes.size());
    std::ofstream(dir_ / "gas.nrrd", std::ios::binary) << head << bytes;
    const std::string map =
        "render gas.nrrd --show column --values-out map.npy --json --size 4 --view +z "
        "--orthographic --width 4 --look-at 3,3,3";
    const auto largest = [&](const std::string& units, const std::string& expected) {
        EXPECT_EQ(Json::parse(must(map + units).out)["units"], expected);
        return std::ranges::max(npy_values(read_text(dir_ / "map.npy")));
    };
    // The length of the column in floats, of which the renderer sums a few.
    constexpr double kRounding = 1e-5;
    EXPECT_NEAR(largest("", "g/cm3 kpc") / 24, 1, kRounding);
    EXPECT_NEAR(largest(" --units g/cm2", "g/cm2") / (24 * 3.0856775814913673e21), 1, kRounding);
    must_fail(2, map + " --units K",
              "--units K: the data are in g/cm3 kpc, expected a unit that it converts to");
    const std::string mean =
        "render gas.nrrd --show mean --field value --values-out map.npy --json --size 4 --view +z";
    EXPECT_EQ(Json::parse(must(mean + " --units kg/m3").out)["units"], "kg/m3");
    EXPECT_NEAR(std::ranges::max(npy_values(read_text(dir_ / "map.npy"))) / 3000, 1, kRounding);
}

}  // namespace vog::test
