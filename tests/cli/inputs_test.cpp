// inputs_test.cpp: several volumes as levels, parts or sums; values that are no density; options
// without effect.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/command.h"
#include "support/level_volumes.h"
#include "vog/image.h"
#include "vog/volume_io.h"

namespace vog::test {

namespace {

using Json = nlohmann::json;

/// Mean of a depth image, or of the one of a command.
double mean_of(const DepthImage& depth) {
    double sum = 0;
    for (const float t : depth.depth) sum += double{t};
    return sum / static_cast<double>(depth.depth.size());
}

}  // namespace

class inputs : public CommandLine {
  protected:
    /// A cube of 20^3 voxels.
    /// shift  along x, voxels
    void write_cube(const std::string& file, double shift = 0, float density = 0.5f,
                    const std::string& name = "density") const {
        Volume cube = cube_of(20, density, {{}, {shift, 0, 0}});
        cube.name = name;
        write_vdb(dir_ / file, cube);
    }
    double mean_t(const std::string& arguments) const {
        must("render " + arguments + " --depth-out T.exr --size 32 --extinction 1");
        return mean_of(read_depth(dir_ / "T.exr"));
    }
};

TEST_F(inputs, densities_near_the_largest_float_are_converted_or_refused_by_name) {
    write_cube("max.vdb", 0, 1e38f);
    must("convert max.vdb -o max.ply --block 4");
    EXPECT_NE(must("convert max.vdb -o max.ply").out.find("mass ratio 1.00000"), std::string::npos);
    for (const std::string file : {"max.vdb", "max.ply"})
        must_fail(1, "render " + file + " -o a.png --size 64", file + ": optical depth inf");
    must_fail(1, "page max.ply -o a.html", "max.vdb density: auto extinction: optical depth inf");
    must_fail(1, "evaluate max.vdb -o report --json",
              "max.vdb: auto extinction: optical depth inf");
}

TEST_F(inputs, a_model_of_nothing_is_refused) {
    write_cube("faint.vdb", 0, 1e-30f);
    must_fail(1, "convert faint.vdb -o a.ply --method paper",
              "faint.vdb: no Gaussian: no group of voxels has a mean density above "
              "--set opacity-threshold=0.0001");
    must("convert faint.vdb -o a.ply --method paper --set opacity-threshold=0");
    must("convert faint.vdb -o a.ply");
}

TEST_F(inputs, a_picture_of_next_to_nothing_is_reported) {
    Volume cube = cube_of(20, 0.5f, {});
    cube.leaves.emplace_back().origin = {100000, 0, 0};
    cube.leaves.back().set(0, 0.001f);
    sort_nodes(cube);
    write_vdb(dir_ / "stray.vdb", cube);
    EXPECT_NE(must("render stray.vdb -o a.png --size 64").error.find("pixels show anything"),
              std::string::npos);
    const Json json = Json::parse(must("convert stray.vdb -o a.ply --json").out);
    EXPECT_NE(json["notes"].dump().find("far outside"), std::string::npos);
    EXPECT_GT(json["gaussians"], 1);
    EXPECT_EQ(must("render stray.vdb -o a.png --size 64 --look-at 10,10,10 --orthographic "
                   "--width 40")
                  .error,
              "");
}

TEST_F(inputs, time_steps_are_never_taken_for_levels) {
    write_cube("step_1.vdb", 0, 0.5f);
    write_cube("step_2.vdb", 0.25, 0.9f);
    const std::string problem = "voxels of the same size at the same place";
    for (const std::string command :
         {"render 'step_*.vdb' -o a.png", "convert 'step_*.vdb' -o a.ply",
          "page 'step_*.vdb' -o a.html", "evaluate step_1.vdb step_2.vdb -o report"}) {
        must_fail(1, command, problem);
        for (const char* choice : {"-o FOLDER/", "--combine sum", "--combine mesh"})
            must_fail(1, command, choice);
    }
    for (const char* file : {"a.png", "a.ply", "a.html", "report"})
        EXPECT_FALSE(std::filesystem::exists(dir_ / file)) << file;
    must("render 'step_*.vdb' -o pictures/ --size 16");
    EXPECT_TRUE(std::filesystem::exists(dir_ / "pictures/step_2.png"));
    must_fail(2, "render 'step_*.vdb' -o a.png --combine sum --combine mesh",
              "--combine: At Most 1");
    must_fail(2, "render step_1.vdb -o a.png --combine sum", "--sum needs several volumes");
}

TEST_F(inputs, volumes_add_up_or_hide_each_other_where_it_is_said) {
    write_cube("a.vdb", 0, 0.5f);
    write_cube("b.vdb", 0, 0.9f);
    const std::string camera = "--eye 10,10,90 --look-at 9.5,9.5,9.5 ";
    const double a = mean_t("a.vdb " + camera), b = mean_t("b.vdb " + camera);
    EXPECT_NEAR(mean_t("a.vdb b.vdb --combine sum " + camera), a + b, 1e-5 * (a + b));
    EXPECT_NEAR(mean_t("b.vdb a.vdb --combine mesh " + camera), b, 1e-5 * b) << "the first counts";
    const Result summed = must("render a.vdb b.vdb --combine sum -o s.png --size 16 --json");
    EXPECT_EQ(Json::parse(summed.out)["notes"][0], "2 volumes add up (--combine sum)");
    EXPECT_NE(summed.error.find("2 volumes add up (--combine sum)"), std::string::npos)
        << summed.error;
    const auto converted =
        Json::parse(must("convert a.vdb b.vdb --combine mesh --block 4 -o m.ply --json").out);
    EXPECT_NE(converted["notes"][0].get<std::string>().find("(--combine mesh)"), std::string::npos);
}

TEST_F(inputs, parts_and_levels_are_found_and_said) {
    write_cube("left.vdb");
    write_cube("right.vdb", 20);
    const Result parts = must("render left.vdb right.vdb -o p.png --size 16 --json");
    EXPECT_NE(parts.error.find("2 volumes are parts side by side"), std::string::npos);
    EXPECT_NE(Json::parse(parts.out)["notes"][0].get<std::string>().find("parts side by side"),
              std::string::npos);
    EXPECT_NEAR(mean_t("left.vdb right.vdb"), mean_t("left.vdb right.vdb --combine sum"), 1e-6);
    must("sample amr amr.vdb --size 64");
    const Result levels = must("render amr.vdb --grid 'density_L*' -o p.png --size 16 --json");
    EXPECT_EQ(Json::parse(levels.out)["notes"][0],
              "3 volumes are 3 levels of one mesh: the finest counts where they overlap");
    must("convert amr.vdb --grid 'density_L*' -o m.ply --block 16");
    EXPECT_EQ(
        Json::parse(
            must("evaluate amr.vdb m.ply --grid 'density_L*' -o r --size 16 --repeat 1 --json")
                .out)["notes"]
            .size(),
        1u);
    EXPECT_FALSE(Json::parse(must("render left.vdb -o p.png --json").out).contains("notes"));
}

TEST_F(inputs, grids_of_different_names_are_different_quantities) {
    Volume density = cube_of(20, 0.5f, {}), heat = density;
    density.name = "density";
    heat.name = "temperature";
    write_vdb(dir_ / "both.vdb", std::vector<Volume>{density, heat});
    must_fail(1, "render both.vdb --grid '*' -o a.png", "are different quantities");
    must_fail(1, "convert both.vdb --grid '*' -o a.ply", "--grid NAME");
    must("render both.vdb --grid '*' --combine sum -o a.png --size 16");
}

TEST_F(inputs, steps_quantities_and_levels_of_real_data) {
    VOG_NEEDS_DATA("plume/plume_0028.vdb");
    VOG_NEEDS_DATA("fire.vdb");
    VOG_NEEDS_DATA("enzo/level0.vdb");
    const std::string data = data_dir().string() + "/";
    must_fail(1, "render '" + data + "plume/*.vdb' -o a.png",
              "voxels of the same size at the same place");
    must_fail(1, "render '" + data + "fire.vdb' --grid '*' -o a.png", "are different quantities");
    EXPECT_NE(must("render '" + data + "enzo/*.vdb' -o a.png --size 16").error.find("3 levels"),
              std::string::npos);
}

TEST_F(inputs, invalid_values_are_refused_or_said) {
    write("points.csv", "x,y,z,mass\n0,0,0,1\n1,0,0,nan\n0,1,0,2\n0,0,1,-3\n1,1,1,4\n");
    must_fail(1, "convert points.csv -o a.ply --value mass",
              "points.csv: 'mass' of particle 1 is missing, expected a number (--skip-nonfinite");
    must("render points.csv -o a.png");  // the mass is not used
    must_fail(1, "convert points.csv -o a.ply --value mass --skip-nonfinite",
              "is -3, expected 0 or more (--clip-negative");
    for (const std::string command :
         {"convert points.csv -o a.ply", "render points.csv -o a.png"}) {
        const Result result =
            must(command + " --value mass --skip-nonfinite --clip-negative --json");
        const Json notes = Json::parse(result.out)["notes"];
        EXPECT_EQ(notes[0], "points.csv: 1 value not finite, left out");
        EXPECT_EQ(notes[1], "points.csv: 1 negative value set to 0");
        EXPECT_NE(result.error.find(notes[1]), std::string::npos) << result.error;
    }
}

TEST_F(inputs, options_without_effect_are_refused) {
    must("sample cloud c.vdb --size 64");
    must("convert c.vdb -o c.ply --block 8");
    must("render c.ply -o a.png --size 16 --depth-out T.exr");
    write("p.xyz", "1 2 3\n4 5 6\n7 8 9\n");
    must_fail(2, "render c.vdb -o a.png --set step=0.5",
              "--set step has no effect with --interpolation constant");
    must_fail(2, "render c.ply -o a.png --renderer trace --set hits-per-slab=4",
              "--set hits-per-slab");
    must_fail(2, "compare a.png a.png --tf jet", "--tf has no effect with pictures");
    must_fail(2, "compare a.png a.png --extinction 2", "--extinction has no effect with pictures");
    must_fail(2, "render c.ply -o b.png --grid density", "--grid has no effect with models");
    must("pack c.ply -o c.vogz");
    must_fail(2, "render c.vogz -o b.png --skip-nonfinite",
              "--skip-nonfinite has no effect with compact models");
    must_fail(2, "page c.ply -o b.html --combine sum", "--combine has no effect with models");
    must_fail(2, "render p.xyz -o b.png --radius 1 --grid a",
              "--grid has no effect with particles");
    must_fail(2, "convert c.vdb -o b.ply --again",
              "--again has no effect with -o FILE.ply; it works with -o FOLDER/");
    must_fail(1, "render nofile -o b.png", "nofile: no such file");
    must_fail(1, "evaluate c.vdb -o a.png", "a.png: a file; vog evaluate writes a folder");
    for (const char* wrong : {"0", "-3", "many"}) {
        const Result result = run(std::string("convert c.vdb -o b.ply --budget ") + wrong);
        EXPECT_EQ(result.exit_code, 2);
        EXPECT_NE(result.error.find("--budget"), std::string::npos);
        EXPECT_LT(result.error.size(), 120u) << result.error;
    }
    must_fail(2, "render c.vdb -o b.png --threads -1", "-1: expected a whole number, at least 0");
}

}  // namespace vog::test
