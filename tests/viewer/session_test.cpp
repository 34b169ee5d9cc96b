// session_test.cpp: vog view driven by scripts, its pictures against vog render's, and its errors.
#include <nlohmann/json.hpp>

#include "quantity/look.h"
#include "quantity/probe.h"
#include "viewer/view_command.h"
#include "vog/compare.h"
#include "vog/error.h"
#include "vog/gaussians.h"
#include "vog/picture_record.h"
#include "vog/ply.h"

namespace vog::test {

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
    refuses("wait\npoints 1:1\n", "play.vog:2: points needs `show volume`");
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
              "cloud.ply are different kinds of data");
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
