// command_line_test.cpp: the vog command as a user runs it: exit codes, outputs, one-line errors.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "support/command.h"
#include "vog/image.h"
#include "vog/ply.h"

namespace vog::test {

class cli : public CommandLine {};

TEST_F(cli, goes_from_nothing_to_a_picture) {
    must("sample cloud cloud.vdb --size 64");
    must("info cloud.vdb");
    const Result converted =
        must("convert cloud.vdb -o cloud.ply --method paper --lod 3 --set amplitude=mass --json");
    const auto conversion = nlohmann::json::parse(converted.out);
    const Gaussians model = read_ply(dir_ / "cloud.ply");
    EXPECT_EQ(conversion["gaussians"], model.size());
    EXPECT_NEAR(conversion["mass_ratio"].get<double>(), 1, 1e-4);

    const Result rendered =
        must("render cloud.ply -o cloud.png --depth-out T.exr --size 80x60 --json");
    const auto rendering = nlohmann::json::parse(rendered.out);
    EXPECT_EQ(rendering["width"], 80);
    EXPECT_GT(rendering["covered"].get<double>(), 0.1);
    EXPECT_GE(rendering["render_ms"]["median"].get<double>(), 0);
    const Image image = read_image(dir_ / "cloud.png");
    EXPECT_EQ(image.width, 80);
    EXPECT_EQ(image.height, 60);
    const DepthImage depth = read_depth(dir_ / "T.exr");
    EXPECT_NEAR(depth.extinction, rendering["extinction"].get<double>(), 1e-5 * depth.extinction);
}

TEST_F(cli, same_bytes_with_one_two_and_eight_threads) {
    std::vector<std::string> models, pictures;
    for (const char* threads : {"1", "2", "8"}) {
        const std::string t = std::string(" --threads ") + threads;
        must("sample explosion e.vdb --size 64" + t);
        must("convert e.vdb -o e.ply --method paper --lod 1" + t);
        must("render e.ply -o e.png --size 64" + t);
        models.push_back(read_text(dir_ / "e.ply"));
        pictures.push_back(read_text(dir_ / "e.png"));
    }
    EXPECT_EQ(models[0], models[1]);
    EXPECT_EQ(models[0], models[2]);
    EXPECT_EQ(pictures[0], pictures[1]);
    EXPECT_EQ(pictures[0], pictures[2]);
}

TEST_F(cli, views_agree_however_they_are_given) {
    must("sample cloud c.vdb --size 64");
    must("convert c.vdb -o c.ply --method paper --lod 5");
    const std::string report = must("render c.ply -o paper.png --size 40 --view paper --json").out;
    write("camera.json", report);
    must(
        "render c.ply -o angles.png --size 40 --view 34.37746770784939,20.05352282957881 "
        "--distance 3 --frame data");
    must("render c.ply -o file.png --size 40 --camera camera.json");
    must("render c.ply -o picture.png --size 40 --camera paper.png");
    const auto camera = nlohmann::json::parse(report)["camera"];
    const auto list = [&](const char* key) {
        const std::string text = camera[key].dump();
        return text.substr(1, text.size() - 2);
    };
    must("render c.ply -o eye.png --size 40 --eye=" + list("eye") +
         " --look-at=" + list("look_at") + " --fov " + camera["fov_degrees"].dump());
    for (const char* other : {"angles.png", "file.png", "picture.png", "eye.png"})
        expect_same_pixels("paper.png", other);
}

TEST_F(cli, orthographic_views_combine_with_every_way_to_place_the_camera) {
    must("sample cloud c.vdb --size 64");
    const auto camera_of = [&](const std::string& options) {
        return nlohmann::json::parse(
            must("render c.vdb -o c.png --size 40x30 --json " + options).out)["camera"];
    };
    const auto fitted = camera_of("--orthographic");
    EXPECT_FALSE(fitted.contains("fov_degrees"));
    for (const char* options :
         {"--view +x", "--view -z --up z", "--view 20,-30", "--distance 2", "--eye 1,2,3",
          "--eye 1,2,3 --look-at 0,0.1,0 --up z --set roll=30"}) {
        SCOPED_TRACE(options);
        const auto own = camera_of(std::string(options) + " --orthographic");
        EXPECT_GT(own["orthographic_width"].get<double>(), 0);
        const auto wide = camera_of(std::string(options) + " --orthographic --width 0.7");
        EXPECT_EQ(wide["orthographic_width"], 0.7);
        EXPECT_EQ(wide["eye"], own["eye"]);
    }
    must("render c.vdb -o o.png --size 40 --orthographic --width 0.3");
    EXPECT_EQ(camera_of("--camera o.png")["orthographic_width"], 0.3);
    EXPECT_EQ(camera_of("--camera o.png --width 0.4")["orthographic_width"], 0.4);
    for (const char* options : {"--width 1", "--orthographic --fov 30", "--view +w", "--up 0,0,0",
                                "--view 0,91", "--view 30", "--camera o.png --eye 1,2,3"}) {
        SCOPED_TRACE(options);
        EXPECT_EQ(run("render c.vdb -o c.png " + std::string(options)).exit_code, 2);
    }
}

TEST_F(cli, json_is_the_only_standard_output) {
    must("sample cloud c.vdb --size 64");
    const auto info = nlohmann::json::parse(must("info c.vdb --json").out);
    EXPECT_EQ(info["files"][0]["grids"][0]["name"], "density");
    EXPECT_GT(info["files"][0]["grids"][0]["active_tiles"]["8"].get<int>(), 0);
    must("convert c.vdb -o c.ply --method paper --lod 4");
    const auto model = nlohmann::json::parse(must("info c.ply --json").out)["files"][0]["model"];
    EXPECT_EQ(model["method"], "paper");
    const auto timing = nlohmann::json::parse(must("render c.ply --size 32 --repeat 3 --json").out);
    EXPECT_EQ(timing["render_ms"]["repeats"], 3);
}

TEST_F(cli, particles_are_listed_converted_and_rendered) {
    std::string text = "x,y,z,vx,vy,vz,mass\n";
    for (int n = 0; n < 500; ++n)
        text += std::to_string(n % 7) + "," + std::to_string(n % 11) + "," +
                std::to_string(n * n % 101) + ",3,4," + std::to_string(n % 5) + ",2\n";
    write("p.csv", text);
    const auto info = nlohmann::json::parse(must("info p.csv --json").out)["files"][0]["points"];
    EXPECT_EQ(info["particles"], 500);
    EXPECT_EQ(info["values"][1]["name"], "mass");
    must("info p.csv");
    write("units.csv", "x [kpc],y [kpc],z [kpc]\n1,2,3\n4,5,6\n");
    EXPECT_NE(must("info units.csv").out.find("(1, 2, 3) to (4, 5, 6) kpc"), std::string::npos);
    const auto all = nlohmann::json::parse(must("convert p.csv -o p.ply --value mass --json").out);
    EXPECT_EQ(all["particles"], 500);
    EXPECT_EQ(all["gaussians"], 500);
    EXPECT_NEAR(all["mass_ratio"].get<double>(), 1, 1e-6);
    const auto few = nlohmann::json::parse(
        must("convert p.csv -o few.ply --budget 50 --set measure-error=1 --json").out);
    EXPECT_LE(few["gaussians"], 50);
    EXPECT_GT(few["measured_error"], 0);
    EXPECT_EQ(read_ply(dir_ / "few.ply").source, "p.csv count");
    must("convert p.csv -o paper.ply --method paper --radius 0.5 --set kappa=0.1");
    EXPECT_EQ(read_ply(dir_ / "paper.ply").size(), 500u);

    // Particles render like their model of one Gaussian each.
    must("render p.csv -o p.png --value mass --size 48");
    must("render p.ply -o q.png --size 48");
    expect_same_pixels("p.png", "q.png");
    must("convert p.csv -o p.xyz");
    must("convert p.xyz p.csv -o both.ply");
    EXPECT_EQ(read_ply(dir_ / "both.ply").size(), 1000u);

    // A PointDataGrid holds the same particles in another order.
    must("convert p.csv -o p.vdb");
    EXPECT_EQ(
        nlohmann::json::parse(must("info p.vdb --json").out)["files"][0]["grids"][0]["points"],
        500);
    must("convert p.vdb -o v.ply --value mass");
    EXPECT_NEAR(mass(read_ply(dir_ / "v.ply")), 1000, 1e-3);
    must("sample particles s.xyz --size 12");
    must("convert s.xyz -o s.ply --lod 2");
    EXPECT_EQ(read_ply(dir_ / "s.ply").source_voxels, 1728u);

    must_fail(2, "sample particles s.vdb --half", "--half");
    must_fail(1, "convert p.csv -o a.ply --value heat", "it has: count, speed, mass");
    must_fail(1, "render p.csv -o a.png --renderer reference", "holds particles");
    must_fail(1, "evaluate p.csv -o out", "particles; vog evaluate needs a volume");
    must_fail(1, "convert p.csv p.ply -o a.ply", "different kinds");
    must_fail(2, "convert p.csv -o a.ply --set strategy=strict", "has no effect with");
    must_fail(2, "convert p.csv -o a.ply --budget 5 --block 2", "exclude each other");
    must_fail(1, "render p.csv -o a.png --radius wide", "no value named 'wide'");
    must_fail(2, "render p.ply -o a.png --radius 2", "--radius has no effect with models");
    write("bad.xyz", "1 2 3\n4 5 6\n7 8\n");
    must_fail(1, "render bad.xyz -o a.png", "bad.xyz:3: got 2 columns, expected 3");
    write("one.xyz", "1 2 3\n");
    must_fail(1, "render one.xyz -o a.png", "--radius X");
    must("render one.xyz -o one.png --radius 1 --size 32");
}

TEST_F(cli, wrong_usage_is_exit_code_two) {
    write("m.ply", "ply\n");
    must_fail(2, "paint", "no command or file 'paint'");
    must_fail(2, "sample cloud", "output");
    must_fail(2, "sample cloud c.vdb --size 63", "size");
    must_fail(2, "convert a.vdb -o a.ply --lod 6", "lod");
    must_fail(2, "convert a.vdb -o a.ply --method paper --lod 1 --set strategy=strict", "exclude");
    must_fail(2, "render m.ply -o m.png --size 12y", "--size 12y");
    must_fail(2, "render m.ply -o m.png --background 1,2", "--background 1,2");
    must_fail(2, "render m.ply -o m.png --eye 1,2", "--eye: 1,2: expected x,y,z");
    must_fail(2, "render m.ply -o m.png --extinction -1", "--extinction");
    must_fail(2, "render m.ply --turntable 3", "--turntable needs -o with a folder");
}

TEST_F(cli, every_failure_is_one_line_that_names_the_file) {
    write("text.vdb", "this is not a volume");
    write("text.ply", "this is not a model");
    write("odd.doc", "");
    must("sample cloud c.vdb --size 64");
    must("convert c.vdb -o c.ply --method paper --lod 5");
    must_fail(1, "info absent.vdb", "absent.vdb: no such file");
    must_fail(1, "info text.vdb", "text.vdb: ");
    must_fail(1, "info text.ply", "text.ply: not a PLY file");
    must_fail(1, "info odd.doc", "odd.doc: unknown extension");
    must_fail(1, "convert absent.vdb -o a.ply", "absent.vdb: no such file");
    must_fail(1, "convert c.vdb -o a.png",
              "this command writes .ply, .vogz; use vog render c.vdb -o a.png");
    must_fail(1, "convert c.vdb -o no/a.ply", "no folder 'no'");
    must_fail(1, "convert c.vdb -o a.ply --grid heat", "no grid named 'heat' (it has: density)");
    must_fail(2, "convert c.ply -o a.ply --method paper", "--method has no effect with models");
    must_fail(1, "render c.ply -o a.jpg", "a.jpg: this command writes .png, .exr");
    must_fail(1, "render c.ply -o a.png --tf mauve", "mauve");
    must_fail(1, "render c.ply -o a.png --camera absent.json", "absent.json: no such file");
    EXPECT_FALSE(std::filesystem::exists(dir_ / "a.ply"));
    EXPECT_FALSE(std::filesystem::exists(dir_ / "a.png"));
}

TEST_F(cli, an_input_is_never_overwritten) {
    must("sample cloud c.vdb --size 64");
    must("convert c.vdb -o c.ply --method paper --lod 5");
    const std::string before = read_text(dir_ / "c.ply");
    must_fail(1, "render c.ply --depth-out c.ply", "c.ply");
    must_fail(1, "convert ./c.vdb -o c.vdb", "c.vdb");
    EXPECT_EQ(read_text(dir_ / "c.ply"), before);
}

TEST_F(cli, help_explains_every_subcommand) {
    for (const char* command : {"", "sample ", "info ", "convert ", "render ", "compare ",
                                "evaluate ", "view ", "page ", "pack ", "export "})
        EXPECT_GT(must(std::string(command) + "--help").out.size(), 200u) << command;
    EXPECT_EQ(must("--version").out.substr(0, 4), "vog ");
}

TEST_F(cli, levels_of_one_file_and_of_several_make_one_picture) {
    must("sample amr amr.vdb --size 64");
    must("render amr.vdb --grid 'density_L*' --depth-out levels.exr --size 48 --extinction 5");
    must("render amr.vdb --grid density_L0 --depth-out coarse.exr --size 48 --extinction 5");
    must(
        "render amr.vdb --grid 'density_L?' --combine sum --depth-out sum.exr --size 48 "
        "--extinction "
        "5");
    const auto mean = [&](const std::string& name) {
        double sum = 0;
        for (const float t : read_depth(dir_ / name).depth) sum += double{t};
        return sum;
    };
    EXPECT_NEAR(mean("levels.exr") / mean("coarse.exr"), 1, 0.05);
    EXPECT_GT(mean("sum.exr"), 1.5 * mean("levels.exr"))
        << "no masks: the dense parts count thrice";

    for (const std::string method : {"paper --set amplitude=mass", "moments --block 2"}) {
        must("convert amr.vdb --grid 'density_L*' -o m.ply --json --method " + method);
        must("render m.ply --depth-out model.exr --size 48 --extinction 5");
        EXPECT_NEAR(mean("model.exr") / mean("levels.exr"), 1, 0.01) << method;
    }
    // Masks by name: here the levels themselves.
    must(
        "render amr.vdb --grid 'density_L*' --mask 'density_L*' --depth-out masked.exr --size 48 "
        "--extinction 5");
    EXPECT_EQ(read_depth(dir_ / "masked.exr").depth, read_depth(dir_ / "levels.exr").depth);
    // All conversions of levels: evaluate.levels_are_one_model_against_the_masked_reference.
    must("evaluate amr.vdb m.ply --grid 'density_L*' -o report --size 32 --repeat 1");
}

TEST_F(cli, invalid_levels_are_refused) {
    must("sample amr amr.vdb --size 64");
    EXPECT_NE(
        must("render amr.vdb -o p.png").error.find("reading the grids 'density_L*' as levels"),
        std::string::npos);
    must_fail(1, "render amr.vdb --grid 'rho*' -o p.png", "no grid matches 'rho*'");
    must_fail(1, "render amr.vdb --grid 'density_L*' --mask 'm*' -o p.png", "no grid named 'm0'");
    must_fail(2, "render amr.vdb --grid 'density_L*' --mask m -o p.png", "expected a *");
    must_fail(2, "render amr.vdb --grid density_L0 --mask 'm*' -o p.png", "expected a *");
    must_fail(2, "render amr.vdb --grid 'd*' --mask 'd*' --combine sum -o p.png",
              "it works with --combine mesh");
}

TEST_F(cli, traces_the_picture_it_splats) {
    must("sample cloud cloud.vdb --size 64");
    must("convert cloud.vdb -o cloud.ply --budget 2000");
    must("render cloud.ply --size 64 --extinction 1 --depth-out splat.exr");
    const DepthImage splat = read_depth(dir_ / "splat.exr");
    const float largest = *std::max_element(splat.depth.begin(), splat.depth.end());
    for (const char* anyhit : {"accumulate", "collect --set hits-per-slab=2"}) {
        const Result traced =
            must(std::string("render cloud.ply --size 64 --extinction 1 --renderer trace ") +
                 "--depth-out trace.exr --json --set anyhit=" + anyhit);
        const auto json = nlohmann::json::parse(traced.out);
        EXPECT_EQ(json["renderer"], "trace");
        EXPECT_GT(json["hits"], 0);
        const DepthImage trace = read_depth(dir_ / "trace.exr");
        for (std::size_t n = 0; n < splat.depth.size(); ++n)
            // Near the size of a pixel both round the share of a Gaussian for themselves.
            ASSERT_NEAR(trace.depth[n], splat.depth[n], 3e-4f * largest) << "pixel " << n;
    }
    must("render cloud.ply --set kappa=0.1 --renderer trace --set aabb-sigma=1 -o boxes.png");
    must(
        "render cloud.ply --renderer trace --set anyhit=collect --set stop-transmittance=0.001 "
        "--extinction 100 -o early.png");
}

TEST_F(cli, an_absent_renderer_fails_with_one_line) {
    must("sample cloud cloud.vdb --size 64");
    must("convert cloud.vdb -o cloud.ply");
    for (const std::string what : {"cloud.ply --renderer cuda", "cloud.ply --renderer optix",
                                   "cloud.vdb --renderer optix"}) {
        const Result result = run("render -o a.png " + what);
        if (result.exit_code == 0) continue;  // there is a GPU
        must_fail(1, "render -o a.png " + what, "vog: ");
        EXPECT_TRUE(result.error.find("cuda: ") != std::string::npos ||
                    result.error.find("optix: ") != std::string::npos)
            << result.error;
    }
}

TEST_F(cli, optix_draws_the_references_pictures_of_volumes_or_says_what_is_missing) {
    must("sample amr amr.vdb --size 64");
    must("sample cloud cloud.vdb --size 64");
    const std::string levels = "amr.vdb --grid 'density_L*' ";
    for (const std::string& what :
         {std::string("cloud.vdb --show volume --light head --clip 1,0,0.2,0 --samples 2"),
          levels + "--show volume", levels + "--show maximum --clip 1,0,0.2,0",
          std::string("cloud.vdb --show mean --field density"),
          levels + "--show mean --field 'density=density_L*'",
          levels + "--clip 0,0,0,20,20,20 --extinction 1"}) {
        const std::string command = "render " + what + " --size 24 -o ";
        must(command + "right.png --renderer reference");
        const Result result = run(command + "gpu.png --renderer optix");
        if (result.exit_code == 0)
            expect_same_pixels("gpu.png", "right.png");
        else
            EXPECT_NE(result.error.find("optix: "), std::string::npos) << what << result.error;
    }
}

TEST_F(cli, views_from_afar_draw_coarser_gaussians) {
    must("sample cloud cloud.vdb --size 64");
    must("convert cloud.vdb -o cloud.ply --block 1");
    must("convert cloud.vdb -o plain.ply --block 1 --no-hierarchy");
    EXPECT_NE(must("info plain.ply").out.find("none"), std::string::npos);
    const auto facts =
        nlohmann::json::parse(must("info cloud.ply --json").out)["files"][0]["model"];
    EXPECT_GT(facts["nodes"], facts["gaussians"].get<std::size_t>() / 8);
    EXPECT_EQ(facts["bytes"], std::filesystem::file_size(dir_ / "cloud.ply"));
    const auto cut = [&](const std::string& options) {
        return nlohmann::json::parse(must("render " + options + " -o a.png --json").out)["cut"];
    };
    const std::size_t all = facts["gaussians"];
    // A voxel covers 10 pixels, then a quarter of one.
    EXPECT_EQ(cut("cloud.ply --size 1024")["gaussians"], all);
    const auto small = cut("cloud.ply --size 24 --distance 5");
    EXPECT_LT(small["drawn"], all / 20);
    EXPECT_LT(small["nodes_visited"], facts["nodes"]);
    EXPECT_EQ(cut("cloud.ply --size 24 --pixel-error 0")["drawn"], all);
    EXPECT_TRUE(cut("plain.ply --size 24").is_null());
    EXPECT_EQ(cut("plain.ply --size 24 --pixel-error 4")["drawn"].get<std::size_t>() < all, true);
    // A smaller kappa widens the supports: Gaussians outside the view must still not overlap it.
    const std::string close = " --size 64 --fov 3 --set kappa=0.001 -o ";
    must("render cloud.ply --pixel-error 0" + close + "cut.png");
    must("render plain.ply" + close + "plain.png");
    expect_same_pixels("cut.png", "plain.png");
}

TEST_F(cli, options_of_another_renderer_are_refused) {
    must("sample cloud cloud.vdb --size 64");
    must("convert cloud.vdb -o cloud.ply");
    must_fail(2, "render cloud.ply -o a.png --set anyhit=collect", "--renderer splat");
    must_fail(2, "render cloud.vdb -o a.png --set kappa=0.1", "--renderer reference");
    must_fail(2, "render cloud.ply -o a.png --renderer trace --set stop-transmittance=0.1",
              "it works with --set anyhit=collect");
    must_fail(2,
              "render cloud.ply -o a.png --renderer trace --set anyhit=collect --set "
              "stop-transmittance=0.1",
              "--extinction");
    must_fail(1, "render cloud.vdb -o a.png --renderer trace", "convert it first");
    must_fail(2, "render cloud.vdb -o a.png --renderer optix --set anyhit=collect",
              "not for voxels");
    must_fail(2, "render cloud.ply -o a.png --interpolation linear", "--renderer reference");
    must_fail(2, "render cloud.ply -o a.png --renderer trace --pixel-error 1", "--renderer splat");
    must_fail(2, "render cloud.vdb -o a.png --pixel-error 1", "--renderer reference");
    must_fail(2, "render cloud.ply -o a.png --set aabb-sigma=1 --pixel-error 1",
              "--set aabb-sigma");
    must_fail(2, "render cloud.ply -o a.png --pixel-error -1", "--pixel-error");
}

}  // namespace vog::test
