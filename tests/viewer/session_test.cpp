// session_test.cpp: vog view driven by scripts, its pictures against vog render's, and its errors.
#include <nlohmann/json.hpp>

#include "quantity/look.h"
#include "quantity/probe.h"
#include "screen/screen.h"
#include "support/command.h"
#include "vog/compare.h"
#include "vog/error.h"
#include "vog/gaussians.h"
#include "vog/picture_record.h"
#include "vog/ply.h"

namespace vog::test {

class view_command : public CommandLine {
  protected:
    void SetUp() override {
        try {
            viewer::open_headless({8, 8});
        } catch (const Error& error) {
            GTEST_SKIP() << "no OpenGL 3.3 on this machine: " << error.what();
        }
    }
    void play(const std::string& inputs, const std::string& script,
              const std::string& options = "") const {
        write("play.vog", script);
        must("view " + inputs + " --headless --script play.vog " + options);
    }
    /// Expects an error with the script's line.
    void refuses(const std::string& script, const std::string& text) const {
        write("play.vog", script);
        must_fail(1, "view cloud.ply --headless --script play.vog --size 64x48", text);
    }
    void make_cloud() const {
        must("sample cloud cloud.vdb --size 64");
        must("convert cloud.vdb -o cloud.ply --block 4");
    }
    /// Expects no channel of any pixel to differ by more than 2 of 255.
    void expect_same_picture(const std::string& expected, const std::string& drawn) const {
        const Image a = read_image(dir_ / expected), b = read_image(dir_ / drawn);
        const PictureDifference difference = compare(a, b);
        EXPECT_LE(difference.largest, 2)
            << drawn << " at " << difference.largest_column << ", " << difference.largest_row;
        EXPECT_GE(difference.psnr_db, 55) << drawn;
    }
};

TEST_F(view_command, a_sites_pictures_are_those_of_its_view_and_damage_leaves_the_parent) {
    must("sample cloud cloud.vdb --size 128");
    must("convert cloud.vdb -o cloud.ply --block 2 --set soft-steps=0");
    must("page cloud.ply -o site/");
    const std::string script =
        "size 240 180\nsubframes 1\npanels off\noverlay off\ncolorbar off\ntf viridis\nexposure "
        "300\n"
        "wait\ndrag left 30% 40% 60% 55%\nwheel 6 60% 40%\nwait\nsave-camera camera.json\n"
        "picture picture.png\n";
    play("site", script);
    must(
        "render site -o expected.png --camera camera.json --size 240x180 --extinction 300 --tf "
        "viridis");
    expect_same_picture("expected.png", "picture.png");
    // The largest chunk is of leaves.
    std::filesystem::path largest;
    std::uintmax_t bytes = 0;
    for (const auto& entry : std::filesystem::directory_iterator(dir_ / "site/chunks"))
        if (entry.path().extension() == ".vogz" && entry.file_size() > bytes)
            bytes = entry.file_size(), largest = entry.path();
    std::filesystem::resize_file(largest, bytes / 2);
    play("site", script + "picture damaged.png\n");
    const PictureDifference difference =
        compare(read_image(dir_ / "expected.png"), read_image(dir_ / "damaged.png"));
    EXPECT_GT(difference.psnr_db, 25);
    EXPECT_LT(difference.psnr_db, 60);
}

TEST_F(view_command, steps_of_a_site_play_as_views_need_them) {
    for (const char* seed : {"1", "2", "3"}) {
        must(std::string("sample explosion e.vdb --size 64 --set seed=") + seed);
        must(std::string("convert e.vdb --block 1 --set soft-steps=0 -o s") + seed + ".ply");
    }
    must("page 's*.ply' -o site/ --site");
    play("site",
         "size 120 90\npanels off\noverlay off\ncolorbar off\ntf gray\nsave-camera "
         "camera.json\nexposure 2\n"
         "wait\nstep 2\nwait\npicture two.png\nsteps all\n");
    must("render site/ -o all2/ --camera camera.json --size 120x90 --extinction 2 --tf gray");
    for (const std::string n : {"1", "2", "3"})
        expect_same_picture("all2/s" + n + ".png", "all/000" + n + ".png");
    must("render site/s2 -o r2.png --camera camera.json --size 120x90 --extinction 2 --tf gray");
    expect_same_picture("r2.png", "two.png");
    play("site/s2",
         "size 120 90\npanels off\noverlay off\ncolorbar off\ntf gray\nexposure 2\nwait\n"
         "picture one.png\n",
         "--camera camera.json");
    expect_same_picture("r2.png", "one.png");
    write("play.vog", "step 4\n");
    must_fail(1, "view site --headless --script play.vog",
              "play.vog:1: no step 4, expected 1 to 3");
}

TEST_F(view_command, a_sessions_picture_is_the_command_lines) {
    must("sample cloud cloud.vdb --size 64");
    must("convert cloud.vdb -o cloud.ply --block 4");
    play("cloud.vdb",
         "size 500 400\n"
         "subframes 1\n"
         "wait                          # for all levels\n"
         "drag left 30% 40% 60% 55%     # orbit\n"
         "drag shift+left 50% 50% 55% 45%\n"
         "wheel 3 60% 40%               # zoom in\n"
         "roll 20\n"
         "tf viridis\n"
         "split 0.5\n"
         "drag left 50% 70% 30% 70%     # the split line\n"
         "slide level 0.0\n"
         "slide level 1.0\n"
         "level blocks of 4\n"
         "split off\n"
         "panels off\n"
         "overlay off\n"
         "colorbar off\n"
         "size 240 180\n"
         "exposure 3.5\n"
         "wait\n"
         "save-camera camera.json\n"
         "depth T.exr\n"
         "picture picture.png\n"
         "screenshot window.png\n");
    must(
        "render cloud.ply -o expected.png --depth-out expected-T.exr --camera camera.json --size "
        "240x180 "
        "--extinction 3.5 --tf viridis");
    expect_same_picture("expected.png", "picture.png");
    expect_same_picture("expected.png", "window.png");
    const DepthDifference depth =
        compare(read_depth(dir_ / "expected-T.exr"), read_depth(dir_ / "T.exr"));
    EXPECT_LE(depth.relative_l2, 1e-5);
    // The drags did move the camera: the paper view is another picture.
    must("render cloud.ply -o paper.png --size 240x180 --extinction 3.5 --tf viridis");
    EXPECT_LT(compare(read_image(dir_ / "paper.png"), read_image(dir_ / "picture.png")).psnr_db,
              40);
}

TEST_F(view_command, the_split_shows_gaussians_and_voxels) {
    make_cloud();
    play("cloud.vdb",
         "renderer gl\npanels off\noverlay off\ncolorbar off\nlevel finest\nexposure 5\n"
         "split 0.25\nwait\npicture split.png\n"
         "split off\nrenderer reference\nwait\npicture voxels.png\n"
         "renderer splat\nwait\npicture splat.png\n"
         "renderer gl\nwait\npicture gl.png\n",
         "--size 200x160");
    expect_same_picture("splat.png", "gl.png");
    const Image split = read_image(dir_ / "split.png"), gl = read_image(dir_ / "gl.png"),
                voxels = read_image(dir_ / "voxels.png");
    for (int row = 0; row < split.height; ++row)
        for (int column = 0; column < split.width; ++column)
            ASSERT_EQ(split.at(column, row), (column < 50 ? gl : voxels).at(column, row));
    must("render cloud.vdb -o expected.png --size 200x160 --extinction 5");
    expect_same_picture("expected.png", "voxels.png");
}

TEST_F(view_command, automatic_exposure_is_the_command_lines) {
    make_cloud();
    play("cloud.ply",
         "panels off\noverlay off\ncolorbar off\nsubframes 1\nwait\nexposure auto\npicture "
         "auto.png\n",
         "--size 200x160 --tf plasma --background 0.2,0.4,0.6 --blend --view 2,20 --fov 30");
    must(
        "render cloud.ply -o expected.png --size 200x160 --tf plasma --background 0.2,0.4,0.6 "
        "--blend "
        "--view 2,20 --fov 30");
    expect_same_picture("expected.png", "auto.png");
}

TEST_F(view_command, a_look_saved_is_the_look_shown) {
    make_cloud();
    play("cloud.ply",
         "panels off\noverlay off\ncolorbar off\nsubframes 1\nexposure 4\ntf hot\nrange 0.1 "
         "0.8\ngamma 0.5\n"
         "invert on\nopacity 0:0.2 0.5:1\nbackground 0.2,0.4,0.6\nwait\nsave-tf look.json\n"
         "save-camera camera.json\npicture look.png\n",
         "--size 160x120");
    must(
        "render cloud.ply -o expected.png --size 160x120 --camera camera.json --extinction 4 --tf "
        "look.json "
        "--background 0.2,0.4,0.6");
    expect_same_picture("expected.png", "look.png");
}

TEST_F(view_command, meshes_and_particles_match_the_other_commands) {
    must("sample amr mesh.vdb --size 64");
    const std::string bare = "panels off\noverlay off\ncolorbar off\nsubframes 1\nexposure 3\n";
    play("mesh.vdb", bare + "renderer reference\nwait\npicture mesh.png\n",
         "--size 120x90 --grid 'density_L*'");
    must("render mesh.vdb --grid 'density_L*' -o expected.png --size 120x90 --extinction 3");
    expect_same_picture("expected.png", "mesh.png");

    std::string text;
    for (int n = 0; n < 200; ++n)
        text += std::to_string(n % 7) + " " + std::to_string(n % 11) + " " +
                std::to_string(n % 13) + "\n";
    write("dust.xyz", text);
    for (const char* renderer : {"gl", "trace"}) {
        play("dust.xyz", bare + "renderer " + renderer + "\nlevel one a\nwait\npicture dust.png\n",
             "--size 120x90");
        must("render dust.xyz -o expected.png --size 120x90 --extinction 3");
        expect_same_picture("expected.png", "dust.png");
    }
}

TEST_F(view_command, files_of_every_kind_can_be_opened_later) {
    make_cloud();
    write("camera.json", must("render cloud.ply -o expected.png --size 100x80 --tf plasma --fov 20 "
                              "--extinction 3 --json")
                             .out);
    write("look.json", R"({"name": "p", "colors": "plasma"})");
    write("other.json", "{}");
    play("",
         "panels off\noverlay off\ncolorbar off\nsubframes 1\nwait\nopen cloud.ply\nexposure 3\n"
         "open look.json\nopen camera.json\nwait\npicture opened.png\n",
         "--size 100x80");
    expect_same_picture("expected.png", "opened.png");
    refuses("open other.json\n", "play.vog:1: neither a transfer function");
}

TEST_F(view_command, keys_and_buttons_do_what_they_say) {
    make_cloud();
    play("cloud.vdb",
         "subframes 1\nwait\nkey 3\nsave-camera axis.json\nkey home\nkey tab\nkey o\nkey l\nwait\n"
         "screenshot bare.png\npicture picture.png\nkey tab\npress -z\nsave-camera back.json\n",
         "--size 900x800");
    EXPECT_EQ(read_image(dir_ / "bare.png").pixel, read_image(dir_ / "picture.png").pixel);
    const auto eye = [&](const std::string& file) {
        const auto camera = nlohmann::json::parse(read_text(dir_ / file));
        return camera["eye"][2].get<double>() - camera["look_at"][2].get<double>();
    };
    EXPECT_GT(eye("axis.json"), 0);
    EXPECT_LT(eye("back.json"), 0);
}

TEST_F(view_command, a_turntable_ends_where_it_began) {
    make_cloud();
    play("cloud.ply", "subframes 1\npanels off\nwait\npicture first.png\nturntable turn 4\n",
         "--size 100x80");
    EXPECT_EQ(read_image(dir_ / "turn" / "0001.png").pixel, read_image(dir_ / "first.png").pixel);
    EXPECT_NE(read_image(dir_ / "turn" / "0003.png").pixel, read_image(dir_ / "first.png").pixel);
    EXPECT_TRUE(std::filesystem::exists(dir_ / "turn" / "0004.png"));
    EXPECT_FALSE(std::filesystem::exists(dir_ / "turn" / "0005.png"));
}

TEST_F(view_command, a_turntable_turns_about_the_up_axis_of_the_data) {
    make_cloud();
    play("cloud.ply", "panels off\nexposure 4\nwait\nsave-camera start.json\nturntable turn 4\n",
         "--size 100x80");
    // Half a turn: the eye on the other side of the vertical through look_at, at the same height.
    auto camera = nlohmann::json::parse(read_text(dir_ / "start.json"));
    for (const int axis : {0, 2}) {
        const auto n = static_cast<std::size_t>(axis);
        camera["eye"][n] = 2 * camera["look_at"][n].get<double>() - camera["eye"][n].get<double>();
    }
    write("opposite.json", camera.dump());
    must("render cloud.ply -o expected.png --camera opposite.json --size 100x80 --extinction 4");
    expect_same_picture("expected.png", (dir_ / "turn" / "0003.png").string());
}

TEST_F(view_command, scripts_accumulate_sub_frames_where_they_say_so) {
    must("sample cloud cloud.vdb --size 64");
    must("convert cloud.vdb -o cloud.ply --block 1");
    // Gaussians narrower than a pixel: sub-frames change the picture.
    must("render cloud.ply --depth-out expected.exr --pixel-error 0 --size 24x20 --extinction 4");
    play("cloud.ply",
         "panels off\nparts 0\nexposure 4\nwait\ndepth one.exr\nsubframes 16\nwait\n"
         "depth many.exr\n",
         "--size 24x20");
    const DepthImage expected = read_depth(dir_ / "expected.exr");
    EXPECT_LE(compare(expected, read_depth(dir_ / "one.exr")).relative_l2, 1e-4);
    EXPECT_GT(compare(expected, read_depth(dir_ / "many.exr")).relative_l2, 1e-2);
}

TEST_F(view_command, two_pixels_a_pixel_are_averaged) {
    make_cloud();
    play("cloud.ply",
         "panels off\noverlay off\ncolorbar off\nsubframes 1\nexposure 4\ntf gray\nscale 2\nwait\n"
         "depth fine.exr\nscreenshot shown.png\n",
         "--size 100x80");
    const DepthImage fine = read_depth(dir_ / "fine.exr");
    const Image shown = read_image(dir_ / "shown.png");
    ASSERT_EQ(fine.width, 200);
    for (int row = 0; row < 80; ++row)
        for (int column = 0; column < 100; ++column) {
            const float t =
                (fine.at(2 * column, 2 * row) + fine.at(2 * column + 1, 2 * row) +
                 fine.at(2 * column, 2 * row + 1) + fine.at(2 * column + 1, 2 * row + 1)) /
                4;
            const float v = 1 - std::exp(-t);
            ASSERT_NEAR(shown.at(column, row).r, v * std::min(v / kRim, 1.0f), 1.5 / 255);
        }
}

TEST_F(view_command, quantities_are_the_command_lines) {
    make_cloud();
    for (const char* renderer : {"gl", "splat"}) {
        SCOPED_TRACE(renderer);
        play("cloud.ply",
             "size 200 160\npanels off\noverlay off\ncolorbar off\naxes off\n"
             "renderer " +
                 std::string(renderer) +
                 "\n"
                 "orbit 25 10\nsave-camera camera.json\nwait\n"
                 "show column\nvalues 0.1 30 log\nwait\npicture column.png\n"
                 "show mean density\nvalues 0.1 0.9\ntf viridis\nwait\npicture mean.png\n"
                 "depth mean.exr\n"
                 "show deviation\nvalues 0 0.3\nwait\npicture deviation.png\n"
                 "show maximum\nvalues 0.1 1\nwait\npicture maximum.png\ndepth maximum.exr\n"
                 "show volume\nwait\n"
                 "points 0.1:0 0.5:0.2 0.9:0.7\nundo\nredo\nunit-distance 5\ntf hot\n"
                 "save-tf look.json\nlight on\nshadows on\nocclusion on\nclip -20 -20 -20 8 20 "
                 "20\nwait\n"
                 "picture volume.png\n"
                 "show T\ntf inferno\nexposure 0.05\nwait\npicture clipped.png\n");
        const auto render = [&](const std::string& options, const std::string& file) {
            SCOPED_TRACE(file);
            must("render cloud.ply --camera camera.json --size 200x160 " + options + " -o r_" +
                 file);
            expect_same_picture("r_" + file, file);
        };
        render("--show column --range 0.1,30 --scale log", "column.png");
        render("--show mean --field density --range 0.1,0.9 --tf viridis", "mean.png");
        render("--show deviation --field density --range 0,0.3 --tf viridis", "deviation.png");
        render("--show maximum --range 0.1,1 --tf viridis", "maximum.png");
        render(
            "--show volume --tf look.json --light head --shadows --ambient-occlusion "
            "--clip=-20,-20,-20,8,20,20",
            "volume.png");
        render("--extinction 0.05 --tf inferno --clip=-20,-20,-20,8,20,20", "clipped.png");
    }
}

TEST_F(view_command, root_mean_squares_of_vectors_are_the_command_lines) {
    make_cloud();
    Gaussians model = read_ply(dir_ / "cloud.ply");
    VectorField flow;
    flow.name = "flow";
    flow.unit = "m/s";
    flow.upper = 3;
    for (const Vec3f& at : model.mean) {
        flow.value.push_back({std::sin(0.1f * at.y), std::cos(0.1f * at.x), 0.1f * at.z});
        flow.covariance.push_back({0.04f, 0.01f, 0, 0.09f, -0.01f, 0.02f});
    }
    for (auto& gradient : flow.gradient) gradient.assign(model.size(), Vec3f{0.02f, -0.03f, 0.01f});
    model.fields.vector.push_back(std::move(flow));
    write_ply(dir_ / "cloud.ply", model);
    for (const char* renderer : {"gl", "splat", "trace"}) {
        SCOPED_TRACE(renderer);
        // The first quantity by options, and the others' fields after it.
        play("cloud.ply",
             "size 120 100\npanels off\noverlay off\ncolorbar off\naxes off\nrenderer " +
                 std::string(renderer) +
                 "\nsave-camera camera.json\nwait\npicture rms.png\ndepth rms.exr\n"
                 "show deviation flow.x\nwait\nshow mean flow.magnitude\nvalues 0.5 2\nwait\n"
                 "picture again.png\n",
             "--show mean --field flow.magnitude --range 0.5,2");
        must(
            "render cloud.ply --camera camera.json --size 120x100 --show mean --field "
            "flow.magnitude --range 0.5,2 -o r.png");
        expect_same_picture("r.png", "rms.png");
        expect_same_picture("r.png", "again.png");
    }
    refuses("show deviation flow.magnitude\n", "deviation on rays is not of rms of flow");
    refuses("show maximum flow\n", "maximum on rays is not of flow along the view");
    must_fail(2, "view cloud.ply --headless --script play.vog --show maximum --light head",
              "it works with --show volume");
}

TEST_F(view_command, voxels_show_quantities_and_options_choose_the_first) {
    must("sample cloud cloud.vdb --size 64");
    play("cloud.vdb",
         "size 120 100\npanels off\noverlay off\ncolorbar off\naxes off\nrenderer reference\n"
         "save-camera camera.json\nwait\npicture mean.png\n"
         "show volume\nwait\npoints 0.2:0 0.9:0.5\nunit-distance 4\nsave-tf look.json\nwait\n"
         "picture volume.png\ndepth volume.exr\n"
         "show maximum\nvalues 0.1 1\ntf viridis\nwait\npicture maximum.png\n"
         "against gl\nsplit 0.5\nwait\nsplit off\ndifference 0.1\nwait\npicture difference.png\n",
         "--show mean --range 0.1,0.8 --tf viridis");
    must(
        "render cloud.vdb --camera camera.json --size 120x100 --show maximum --range 0.1,1 --tf "
        "viridis -o r_maximum.png");
    expect_same_picture("r_maximum.png", "maximum.png");
    must(
        "render cloud.vdb --camera camera.json --size 120x100 --show mean --field density --range "
        "0.1,0.8 --tf "
        "viridis -o r_mean.png");
    expect_same_picture("r_mean.png", "mean.png");
    must(
        "render cloud.vdb --camera camera.json --size 120x100 --show volume --tf look.json -o "
        "r_volume.png");
    expect_same_picture("r_volume.png", "volume.png");
    must_fail(1, "view cloud.vdb --headless --script play.vog --show mean --field nothing",
              "nothing");
}

TEST_F(view_command, clip_planes_are_the_command_lines) {
    make_cloud();
    const std::string planes = " --clip=1,0.5,0,2 --clip=0,0,-1,-3";
    for (const char* renderer : {"gl", "splat"}) {
        play("cloud.ply",
             "size 120 100\npanels off\noverlay off\ncolorbar off\nrenderer " +
                 std::string(renderer) +
                 "\nsave-camera camera.json\nvalues 0.1 0.9\nwait\npicture mean.png\n",
             "--show mean --field density" + planes);
        must(
            "render cloud.ply --camera camera.json --size 120x100 --show mean --field density "
            "--range 0.1,0.9 -o r.png" +
            planes);
        expect_same_picture("r.png", "mean.png");
    }
    must_fail(2, "view cloud.ply --headless --script play.vog --clip=1,0,0", "a plane NX,NY,NZ,D");
}

TEST_F(view_command, pictures_keep_their_request) {
    make_cloud();
    for (const char* show :
         {"T", "column", "mean --field density", "volume --light head", "maximum"}) {
        play("cloud.ply",
             "size 120 100\npanels off\noverlay off\ncolorbar off\nrenderer splat\nwait\npicture "
             "shown.png\n",
             std::string("--clip=1,0.5,0,2 --view +x --show ") + show);
        must("render --request shown.png -o again.png");
        expect_same_picture("again.png", "shown.png");
    }
    // As the shell has it from the clipboard.
    const std::string record = record_json(read_record(dir_ / "shown.png"));
    must("render --request '" + record + "' -o pasted.png");
    EXPECT_EQ(read_text(dir_ / "pasted.png"), read_text(dir_ / "again.png"));
}

TEST_F(view_command, layers_are_the_command_lines) {
    make_cloud();
    must("sample explosion other.vdb --size 64");
    must("export other.vdb --iso 0.5 -o other.stl");
    const std::string layers =
        " --show volume --layer tf=hot --layer other.vdb,tf=viridis --layer other.stl,color=white";
    play("cloud.ply",
         "size 500 700\noverlay off\ncolorbar off\nwait\npicture all.png\npress layer 2\nwait\n"
         "picture two.png\npress layer 2\npress layer 3\npress layer 1\nwait\npicture one.png\n",
         layers);
    must("render --request all.png -o again.png");
    expect_same_picture("again.png", "all.png");
    const PictureRecord record = read_record(dir_ / "all.png");
    ASSERT_EQ(record.request.layers.size(), 3u);
    EXPECT_EQ(record.inputs, (std::vector<std::string>{"cloud.ply", "other.vdb", "other.stl"}));
    // Hidden ones are empty.
    for (const char* picture : {"two.png", "one.png"}) {
        must(std::string("render --request ") + picture + " -o again.png");
        expect_same_picture("again.png", picture);
        EXPECT_LT(compare(read_image(dir_ / picture), read_image(dir_ / "all.png")).psnr_db, 40);
    }
    must_fail(2,
              "view cloud.vdb other.vdb --headless --script play.vog --show volume --layer tf=hot",
              "other.vdb is in no layer");
    must_fail(1, "view cloud.ply --headless --script play.vog --show volume --layer field=none",
              "none");
}

TEST_F(view_command, mouse_and_keys_reach_quantities) {
    make_cloud();
    const auto values = [&](const std::string& file) {
        return nlohmann::json::parse(read_text(dir_ / file)).at("opacity");
    };
    play("cloud.ply",
         "size 900 700\nrenderer splat\nwait\nkey g\nkey g\nkey g\nkey g\nwait\nsave-tf "
         "before.json\n"
         "drag right 40% 50% 60% 40%\nsave-tf window.json\nkey ctrl+z\nsave-tf undone.json\n"
         "press step\nsave-tf step.json\nkey k\nwait\ndrag left 50% 50% 52% 50%\nkey u\n"
         "move 50% 50%\nscreenshot window.png\n");
    const auto before = values("before.json"), window = values("window.json");
    EXPECT_EQ(values("undone.json"), before);
    // To the right wider, up higher.
    EXPECT_GT(window.back()[0].get<double>() - window.front()[0].get<double>(),
              before.back()[0].get<double>() - before.front()[0].get<double>());
    EXPECT_GT(window.front()[0].get<double>() + window.back()[0].get<double>(),
              before.front()[0].get<double>() + before.back()[0].get<double>());
    EXPECT_EQ(values("step.json").size(), 4u);
}

TEST_F(view_command, steps_in_time_play_and_are_saved) {
    for (const char* seed : {"1", "2", "3"}) {
        must(std::string("sample explosion e.vdb --size 64 --set seed=") + seed);
        must(std::string("convert e.vdb --block 8 -o s") + seed + ".ply");
    }
    play("'s*.ply'",
         "size 120 90\npanels off\noverlay off\ncolorbar off\nsave-camera camera.json\nexposure 2\n"
         "wait\nstep 2\nwait\npicture two.png\nsteps all\nspeed 100\nloop off\nstep 1\nwait\n"
         "play on\nwait\npicture last.png\nturntable turn 2\n"
         "step 2\nwait\nturntable half 2\nturntable both 6 time\nwait\npicture after.png\n");
    for (const char* n : {"1", "2", "3"}) {
        const std::string name = n;
        must("render s" + name + ".ply -o r" + name +
             ".png --camera camera.json --size 120x90 --extinction 2");
        expect_same_picture("r" + name + ".png", "all/000" + name + ".png");
    }
    expect_same_picture("r2.png", "two.png");
    expect_same_picture("r3.png", "last.png");
    expect_same_picture("r3.png", "turn/0001.png");
    // Time runs once during the turn: two pictures a step, the fourth half way round.
    expect_same_picture("r1.png", "both/0001.png");
    expect_same_picture("half/0002.png", "both/0004.png");
    expect_same_picture("r2.png", "after.png");
    EXPECT_TRUE(std::filesystem::exists(dir_ / "both" / "0006.png"));
    EXPECT_FALSE(std::filesystem::exists(dir_ / "all" / "0004.png"));
    write("play.vog", "step 4\n");
    must_fail(1, "view 's*.ply' --headless --script play.vog",
              "play.vog:1: no step 4, expected 1 to 3");
    write("play.vog", "wait\nturntable t 2 time\n");
    must_fail(1, "view s1.ply --headless --script play.vog",
              "play.vog:2: no steps in time are open");
    write("play.vog", "wait\nturntable t 2 twice\n");
    must_fail(1, "view s1.ply --headless --script play.vog",
              "expected FOLDER|FILM PICTURES [time]");
    write("play.vog", "wait\nsteps all\n");
    must_fail(1, "view s1.ply --headless --script play.vog",
              "play.vog:2: no steps in time are open");
    must_fail(2, "view e.vdb --steps --headless --script play.vog",
              "--steps has no effect with volumes");
    // A step that cannot be read: one line, as for a file that is opened.
    write("s2.ply", "ply\nformat");
    write("play.vog", "wait\nstep 2\nwait\n");
    must_fail(1, "view 's*.ply' --steps --headless --script play.vog", "s2.ply");
    // No picture of another step is saved in its place.
    write("play.vog", "size 60 40\nwait\nturntable broken 6 time\nwait\n");
    must_fail(1, "view 's*.ply' --steps --headless --script play.vog", "s2.ply");
    EXPECT_TRUE(std::filesystem::exists(dir_ / "broken" / "0002.png"));
    EXPECT_FALSE(std::filesystem::exists(dir_ / "broken" / "0003.png"));
}

TEST_F(view_command, bad_scripts_are_refused_by_line) {
    make_cloud();
    refuses("wait\n\nfrobnicate 3\n", "play.vog:3: no action 'frobnicate'");
    refuses("orbit 3\n", "play.vog:1: 'orbit 3', expected more words: orbit RIGHT UP");
    refuses("wait\ngamma much\n",
            "play.vog:2: 'gamma much', expected numbers from 0.1 to 10: gamma EXPONENT");
    refuses("wait\ntf nosuchmap\n", "play.vog:2: nosuchmap");
    refuses("wait\nlevel 77\n", "play.vog:2: no level '77'");
    refuses("size 0 100\n", "play.vog:1: 'size 0 100', expected whole numbers from 1 to 16384");
    refuses("size 64.5 48\n", "expected whole numbers from 1 to 16384");
    refuses("scale 0\n", "play.vog:1: 'scale 0', expected numbers from 0.1 to 4");
    refuses("split 9\n", "play.vog:1: 'split 9', expected numbers from 0 to 1");
    refuses("difference 0\n", "expected numbers from 0.001 to 1");
    refuses("wait -1\n", "play.vog:1: 'wait -1', expected numbers from 0 to 1000000");
    refuses("slide parts 2\n", "expected numbers from 0 to 1");
    refuses("zoom 0\n", "expected numbers from 1e-06");
    refuses("fov 180\n", "expected numbers from 0.001 to 179.999");
    refuses("range 0.5 2\n", "expected numbers from 0 to 1");
    refuses("wait\nrange 0.5 0.5\n", "expected 0 <= LOW < HIGH <= 1");
    refuses("exposure -1\n", "expected numbers from 1e-30");
    refuses("parts -1\n", "expected numbers from 0");
    refuses("subframes 1.5\n", "expected whole numbers from 1 to 4096");
    refuses("turntable t 0\n", "expected whole numbers from 1 to 9999");
    refuses("orbit 1e300 0\n", "expected numbers from -1000000 to 1000000");
    refuses("background 0,0,0,1\n", "expected R,G,B");
    refuses("background 0,7,0,0\n", "expected R,G,B");
    refuses("picture cloud.ply\n", "expected a name in .png");
    refuses("wait now please\n", "play.vog:1: 'wait now please'");
    refuses("renderer raster\n", "play.vog:1: no renderer 'raster'");
    refuses("show colour\n", "play.vog:1: show 'colour', expected 'T'");
    refuses("wait\nshow mean heat\n", "play.vog:2: ");
    refuses("values 2 1\n", "play.vog:1: ");
    refuses("clip 0 0 0 1\n", "play.vog:1: ");
    refuses("clip 1 1 1 0 0 0\n", "play.vog:1: clip box");
    refuses("unit-distance 0\n", "play.vog:1: 'unit-distance 0', expected numbers from 1e-300");
    refuses("wait\npoints 1:1\n", "play.vog:2: points: is of volumes by value");
    refuses("wait\npress nothing\n", "play.vog:2: no widget 'nothing'");
    refuses("key hyper\n", "play.vog:1: no key 'hyper'");
    refuses("open nosuch.vdb\nwait\n", "play.vog:");
    refuses("wait\npicture nofolder/a.png\n", "play.vog:2: nofolder/a.png");
    must_fail(1, "view cloud.ply --headless --script nosuch.vog",
              "nosuch.vog: cannot read this script");
    must_fail(2, "view cloud.ply --headless", "--headless needs --script");
}

TEST_F(view_command, unreadable_inputs_fail_with_one_line) {
    write("play.vog", "wait\n");
    must_fail(1, "view nosuch.vdb --headless --script play.vog", "nosuch.vdb: no such file");
    write("broken.vdb", "not a volume");
    must_fail(1, "view broken.vdb --headless --script play.vog", "broken.vdb");
    write_ply(dir_ / "empty.ply", {});
    must_fail(1, "view empty.ply --headless --script play.vog",
              "empty.ply: a model without Gaussians");
    make_cloud();
    must_fail(1, "view cloud.ply cloud.vdb --headless --script play.vog",
              "another kind than cloud.ply");
    must_fail(1, "view cloud.ply", "no display to open a window on",
              "env -u DISPLAY -u WAYLAND_DISPLAY");
    must_fail(1, "view cloud.ply --headless --script play.vog", "no headless OpenGL 3.3",
              "env MESA_GL_VERSION_OVERRIDE=2.1");
}

TEST_F(view_command, the_window_shows_what_memory_does) {
    if (std::system("command -v xvfb-run >/dev/null 2>&1") != 0)
        GTEST_SKIP() << "no xvfb-run on this machine";
    make_cloud();
    const std::string script =
        "subframes 1\nwait\ndrag left 40% 40% 55% 50%\nwheel 2 50% 50%\nkey tab\nkey o\nkey "
        "l\nwait\n"
        "size 320 240\nwait\nsave-camera camera.json\n";
    // Leaks of the window system's drivers are not tested.
    const std::string xvfb =
        "env ASAN_OPTIONS=detect_leaks=0 xvfb-run -a -s '-screen 0 1280x1024x24'";
    write("play.vog", script + "screenshot window.png\n");
    must("view cloud.ply --script play.vog --size 400x300 --extinction 4", xvfb);
    must("render cloud.ply -o expected.png --camera camera.json --size 320x240 --extinction 4");
    expect_same_picture("expected.png", "window.png");
    // xvfb-run adds lines of its own where the command fails.
    const Result old = run("view cloud.ply", "env MESA_GL_VERSION_OVERRIDE=2.1 " + xvfb);
    EXPECT_NE(old.exit_code, 0);
    EXPECT_NE(old.error.find("vog: no window with OpenGL 3.3"), std::string::npos) << old.error;
}

}  // namespace vog::test
