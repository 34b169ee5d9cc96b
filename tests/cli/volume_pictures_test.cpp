// volume_pictures_test.cpp: vog render --show volume: pictures, reports and refusals.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/command.h"
#include "support/vdb_grids.h"
#include "vog/image.h"
#include "vog/ply.h"
#include "vog/volume_io.h"

namespace vog::test {

class volume_pictures_command : public CommandLine {
  protected:
    /// Cube of 8^3 voxels of edge 1 around (3.5, 3.5, 3.5), with values from 1 to 8 along x.
    void write_ramp(const std::string& name) const {
        Volume volume;
        volume.name = "density";
        Leaf& leaf = volume.leaves.emplace_back();
        for (int n = 0; n < kLeafVoxels; ++n) leaf.set(n, static_cast<float>((n >> 6) + 1));
        write_vdb(dir_ / name, volume);
    }
    nlohmann::json report(const std::string& arguments) const {
        return nlohmann::json::parse(must(arguments + " --json").out);
    }
    Rgba middle(const std::string& file) const {
        const Image image = read_image(dir_ / file);
        return image.at(image.width / 2, image.height / 2);
    }
};

constexpr const char* kFront = " --show volume --size 15 --view -x --orthographic ";

TEST_F(volume_pictures_command, show_bands_over_a_background) {
    write_ramp("ramp.vdb");
    // One voxel of the ray is in the band: alpha is its opacity at a unit distance of its edge.
    must(std::string("render ramp.vdb -o band.exr") + kFront +
         "--band 3,4,red,0.25 --unit-distance 1 --background transparent");
    const Rgba clear = middle("band.exr");
    EXPECT_NEAR(clear.r, 1, 1e-5);  // read back not multiplied by alpha
    EXPECT_NEAR(clear.a, 0.25, 1e-6);
    must(std::string("render ramp.vdb -o band.exr") + kFront +
         "--band 3,4,red,0.25 --band 5,6,#0000ff,0.5 --unit-distance 1 --background white");
    const Rgba white = middle("band.exr");
    EXPECT_NEAR(white.r, 0.25 + 0.375, 1e-6);
    EXPECT_NEAR(white.g, 0.375, 1e-6);
    EXPECT_NEAR(white.b, 0.375 + 0.375, 1e-6);
    // The plane hides the red voxel, x from 1.5 to 2.5.
    must(std::string("render ramp.vdb -o band.exr") + kFront +
         "--band 3,4,red,0.25 --unit-distance 1 --clip 1,0,0,2.5");
    EXPECT_EQ(middle("band.exr").r, 0);
    must(std::string("render ramp.vdb -o band.exr") + kFront +
         "--iso 3,red --light head --set light-weights=0.1,0.5,0,1 --threshold 2");
    EXPECT_NEAR(middle("band.exr").r, 0.6, 1e-3);
}

TEST_F(volume_pictures_command, have_a_colour_bar_over_the_range_of_values) {
    write_ramp("ramp.vdb");
    const std::string render = "render ramp.vdb --show volume --size 96 --band 2,4,red,0.1 -o ";
    must(render + "plain.exr");
    must(render + "bar.exr --color-bar --title ramp");
    const Image plain = read_image(dir_ / "plain.exr"), bar = read_image(dir_ / "bar.exr");
    ASSERT_GT(bar.width, plain.width);
    ASSERT_GT(bar.height, plain.height);
    // Values from 1 to 8: red is two sevenths of the bar, from the bottom a seventh up.
    std::vector<int> red;
    for (int y = 0; y < bar.height; ++y) {
        const Rgba at = bar.at(plain.width + 12, y);
        if (at.r > 0.9f && at.g < 0.1f) red.push_back(y);
    }
    ASSERT_FALSE(red.empty());
    const double rows = plain.height - 8.0;  // without gaps of 4 pixels
    EXPECT_NEAR(static_cast<double>(red.size()), rows * 2 / 7, 2);
    EXPECT_NEAR(bar.height - 4 - red.back(), rows / 7, 2);
}

TEST_F(volume_pictures_command, find_a_unit_distance_that_their_flags_repeat) {
    write_ramp("ramp.vdb");
    const std::string render = "render ramp.vdb -o ramp.exr --show volume --size 48 --frame data ";
    const nlohmann::json found = report(render);
    // Mass 64 (1 + ... + 8), over the median by mass, 6, and the mean silhouette of the cube, 3/2 of a face; half of that times
    // the median's opacity, 5/7; to two digits.
    EXPECT_EQ(found["unit_distance"], 1.4);
    EXPECT_NEAR(found["mean_opacity"].get<double>(), 0.85, 0.1);
    EXPECT_EQ(found["range"], (std::vector<double>{1, 8}));
    const std::string note = found["notes"][0];
    EXPECT_NE(note.find("--range 1,8 --unit-distance "), std::string::npos) << note;
    const std::string picture = read_text(dir_ / "ramp.exr");
    const std::size_t flags = note.find("--range");
    must(render + note.substr(flags, note.find(" repeats") - flags));
    EXPECT_EQ(read_text(dir_ / "ramp.exr"), picture);
    // A sequence keeps range and unit distance of its first picture.
    std::filesystem::copy(dir_ / "ramp.vdb", dir_ / "second.vdb");
    const nlohmann::json both =
        report("render ramp.vdb second.vdb -o all/ --show volume --size 48");
    EXPECT_EQ(both["pictures"][1]["unit_distance"], found["unit_distance"]);
    EXPECT_EQ(both["pictures"][1]["range"], found["range"]);
}

TEST_F(volume_pictures_command, read_transfer_functions_of_values) {
    write_ramp("ramp.vdb");
    write("tf.json", R"({"domain": [0, 10], "unit_distance": 1, "colors": [[0, 0, 1, 0]],
                         "opacity": [[4, 0], [4, 1], [5, 1], [5, 0]]})");
    const nlohmann::json made =
        report(std::string("render ramp.vdb -o tf.exr") + kFront + "--tf tf.json");
    EXPECT_EQ(made["unit_distance"], 1);
    EXPECT_NEAR(middle("tf.exr").g, 0.9999, 1e-6);
    EXPECT_NE(made["notes"].dump().find("opacity 1 counts as 0.9999"), std::string::npos);
    must_fail(2, "render ramp.vdb -o tf.png --show volume --tf tf.json --range 1,2",
              "--range: tf states values of its own");
}

TEST_F(volume_pictures_command, show_models_as_their_voxels_and_clip_them) {
    must("sample cloud cloud.vdb --size 64");
    must("convert cloud.vdb -o m.ply --budget 1500 --no-hierarchy");
    const std::string look =
        " --show volume --frame data --size 64 --band 0.1,0.25,#0040ff,0.1 --band 0.3,9,white,0.5"
        " --unit-distance 0.05 --clip 1,0,0,0 --light head -o ";
    must("render cloud.vdb" + look + "voxels.png");
    must("render m.ply" + look + "slabs.png");
    must("render m.ply" + look + "many.png --slabs 256");
    must("render m.ply" + look + "exact.png --renderer trace");
    const auto psnr = [&](const std::string& a, const std::string& b) {
        return report("compare " + a + " " + b)["psnr_rgb_db"].get<double>();
    };
    EXPECT_GT(psnr("voxels.png", "slabs.png"), 24);  // few Gaussians
    EXPECT_GT(psnr("exact.png", "slabs.png"), 40);
    EXPECT_GT(psnr("exact.png", "many.png"), psnr("exact.png", "slabs.png"));
    must_fail(2, "render m.ply" + look + "p.png --renderer trace --slabs 8",
              "--slabs has no effect with --renderer trace");
    must_fail(2, "render m.ply" + look + "p.png --slabs 0", "--slabs");
    must_fail(2, "render m.ply -o p.png --slabs 8", "--slabs has no effect with --show T");
}
TEST_F(volume_pictures_command, show_values_below_0) {
    const auto grid = make_grid("HU");
    for (int n = 0; n < kLeafVoxels; ++n)
        set_voxel(*grid, {n >> 6, n >> 3 & 7, n & 7}, n >> 6 == 2 ? -700.0f : 40.0f);
    write_grids(dir_ / "ct.vdb", {grid});
    const nlohmann::json made = report(
        "render ct.vdb -o ct.exr --show volume --size 15 --view +x --orthographic --band "
        "-800,-600,blue,0.5 --unit-distance 1");
    EXPECT_NEAR(middle("ct.exr").b, 0.5, 1e-6);
    EXPECT_EQ(made["range"], (std::vector<double>{-700, 40}));
    must_fail(1, "render ct.vdb -o ct.png", "ct.vdb");
}

TEST_F(volume_pictures_command, say_in_one_line_what_is_wrong) {
    write_ramp("ramp.vdb");
    Gaussians model;
    model.mean.push_back({0, 0, 0});
    model.scale.push_back({1, 1, 1});
    model.density.push_back(1);
    write_ply(dir_ / "model.ply", model);
    must_fail(
        1, "render model.ply -o p.png --show volume",
        "model.ply: --show volume needs a scalar field, and the model has none; vog convert VOLUME "
        "-o model.ply makes a model with one, of particles with --field NAME");
    const std::string render = "render ramp.vdb -o p.png --size 8 --show volume ";
    const auto refused = [&](int code, const std::string& options, const std::string& text) {
        must_fail(code, render + options, text);
        EXPECT_FALSE(std::filesystem::exists(dir_ / "p.png"));
    };
    refused(1, "--band 9,10,red,0.5",
            "ramp.vdb: the band from 9 to 10 is outside the data's values, 1 to 8");
    for (const char* value : {"0", "-1", "9"})
        refused(1, std::string("--iso=") + value,
                std::string("ramp.vdb: the surface at ") + value +
                    " is outside the data's values, 1 to 8");
    refused(1, "--threshold 9", "shows none of the data's values, 1 to 8");
    refused(2, "--clip 0,0,0,1,-1,1", "y from 0 to -1, expected the first below the second");
    refused(2, "--interpolation linear --set step=0",
            "--set step=0: volume rendering takes samples");
    refused(2, "--scale log --window 3,1", "--scale and --window exclude each other");
    must_fail(2, "render ramp.vdb -o p.png --window 3,1", "--window has no effect with --show T");
    must_fail(2, "render ramp.vdb -o p.png --show maximum --light head",
              "--light has no effect with --show maximum");
    must_fail(2, "render ramp.vdb -o p.png --show maximum --interpolation linear",
              "--interpolation linear has no effect");
    must_fail(1, "render model.ply -o p.png --show maximum",
              "model.ply: --show maximum needs a scalar field");
    must_fail(2, "render model.ply -o p.png --show mean --field density --clip 0,0,0,1,-1,1",
              "y from 0 to -1, expected the first below the second");
}

TEST_F(volume_pictures_command, show_the_largest_value) {
    write_ramp("ramp.vdb");
    must("convert ramp.vdb -o ramp.ply --block 2");
    const std::string side = " --show maximum --size 16 --view +z --orthographic --width 8 ";
    for (const char* input : {"ramp.vdb", "ramp.ply"}) {
        const nlohmann::json shown = report(std::string("render ") + input +
                                            " -o m.png --values-out m.npy --color-bar" + side);
        EXPECT_EQ(shown["quantity"], "maximum of density");
        EXPECT_FALSE(shown.contains("extinction"));
        // Planes of the last cells stay within the range of the data.
        EXPECT_NEAR(shown["max_t"].get<double>(), 8, 0.3) << input;
        must(std::string("render ") + input + " --values-out m.exr" + side +
             "--clip -1,-1,-1,3.5,9,9");
        EXPECT_NEAR(report(std::string("render ") + input + " -o m.png" + side +
                           "--clip -1,0,0,-3.5")["max_t"]
                        .get<double>(),
                    4, 0.4)
            << input;
    }
    // A line of text without an extinction, which these have not.
    EXPECT_EQ(must("render ramp.vdb -o v.png --show volume --size 8").out.find("extinction"),
              std::string::npos);
    EXPECT_NE(must("render ramp.vdb -o t.png --size 8").out.find("extinction"), std::string::npos);
    std::filesystem::copy(dir_ / "ramp.vdb", dir_ / "second.vdb");
    must("render ramp.vdb second.vdb -o all/ --show maximum --size 8");
}

TEST_F(volume_pictures_command, scans_beside_images_without_axes_of_a_patient_are_noted) {
    const std::string shape = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\n",
                      values = "encoding: ascii\n\n1 1 1 1 1 1 1 1\n";
    write_bytes(dir_ / "scan.nrrd", shape +
                                        "space: right-anterior-superior\nspace directions: "
                                        "(1,0,0) (0,1,0) (0,0,1)\nspace origin: (5,5,0)\n" +
                                        values);
    write_bytes(dir_ / "plain.nrrd", shape + "spacings: 1 1 1\n" + values);
    EXPECT_NE(must("render scan.nrrd plain.nrrd -o p.png --size 8")
                  .error.find("plain.nrrd states no axes of a patient as scan.nrrd does: they may "
                              "lie half a turn apart"),
              std::string::npos);
    EXPECT_EQ(must("render scan.nrrd scan.nrrd --combine sum -o p.png --size 8")
                  .error.find("axes of a patient"),
              std::string::npos);
}

}  // namespace vog::test
