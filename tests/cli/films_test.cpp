// films_test.cpp: turns of the view and time series as numbered pictures and as films.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "support/command.h"
#include "vog/compare.h"
#include "vog/image.h"

namespace vog::test {

class films : public CommandLine {
  protected:
    void SetUp() override {
        CommandLine::SetUp();
        must("sample cloud step_1.vdb --size 64");
        must("sample explosion step_2.vdb --size 64");
        must("convert 'step_*.vdb' -o models/ --block 8");
    }
    nlohmann::json json(const std::string& arguments) const {
        return nlohmann::json::parse(must(arguments + " --json").out);
    }
    /// Skips, aloud, where no ffmpeg is installed.
    static bool has_ffmpeg() {
        return std::system("ffmpeg -version >/dev/null 2>&1 && ffprobe -version >/dev/null 2>&1") ==
               0;
    }
    std::string shell(const std::string& command) const {
        const std::string text =
            "cd '" + (dir_ / "").string() + "' && " + command + " >shell.txt 2>&1 </dev/null";
        EXPECT_EQ(std::system(text.c_str()), 0) << command << "\n" << read_text(dir_ / "shell.txt");
        return read_text(dir_ / "shell.txt");
    }
    /// Files of the test's folder that no test expects: those left of a film.
    std::size_t files() const {
        std::size_t count = 0;
        for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(dir_ / ""))
            ++count;
        return count;
    }
};

TEST_F(films, a_turn_is_the_pictures_of_its_cameras_under_one_extinction) {
    const auto turn = json(
        "render models/step_1.ply -o turn/ --turntable 4 --size 32x24 --view "
        "34.37746770784939,20 --distance 3")["pictures"];
    ASSERT_EQ(turn.size(), 4u);
    for (std::size_t n = 0; n < 4; ++n) {
        EXPECT_EQ(turn[n]["output"], fmt::format("turn/000{}.png", n + 1));
        EXPECT_EQ(turn[n]["extinction"], turn[0]["extinction"]);
        // The y axis is upright: a positive turn about it lowers the azimuth, which goes from x to z.
        must(
            fmt::format("render models/step_1.ply -o one.png --size 32x24 "
                        "--distance 3 --view={:.17g},20 --extinction {}",
                        34.37746770784939 - 90 * double(n), turn[0]["extinction"].dump()));
        // The cameras differ by rounding, in the pictures' records.
        expect_same_pixels("one.png", turn[n]["output"]);
    }
}

TEST_F(films, turns_of_every_quantity_keep_the_scale_of_the_first_view) {
    for (const std::string show : {"column", "mean --field density", "maximum", "volume"}) {
        const auto turn =
            json("render models/step_2.ply -o turn_%02d.png --turntable 3 --size 32 --show " +
                 show)["pictures"];
        ASSERT_EQ(turn.size(), 3u) << show;
        EXPECT_EQ(turn[2]["output"], "turn_03.png");
        for (const auto& picture : turn) {
            EXPECT_EQ(picture["range"], turn[0]["range"]) << show;
            if (show != "volume") continue;
            EXPECT_EQ(picture["unit_distance"], turn[0]["unit_distance"]);
        }
        EXPECT_NE(read_text(dir_ / "turn_01.png"), read_text(dir_ / "turn_02.png")) << show;
    }
}

TEST_F(films, a_fitted_turn_shows_the_box_from_every_side) {
    // Also about a point far behind the middle of the data, as the first view sees it.
    const std::string aside = " --look-at=-0.4,0,-0.4", parallel = " --orthographic";
    for (const std::string& lens : {std::string(), parallel, aside, aside + parallel}) {
        const auto turn =
            json("render models/step_2.ply -o turn/ --turntable 8 --size 64 --depth-out T/" +
                 lens)["pictures"];
        for (std::size_t n = 1; n <= 8; ++n) {
            const DepthImage depth = read_depth(dir_ / fmt::format("T/{:04}.exr", n));
            // A margin of 2.5 % on each side: the rim has the ends of kernels at most.
            const float largest = *std::ranges::max_element(depth.depth);
            for (int k = 0; k < 64; ++k) {
                EXPECT_LT(depth.at(k, 0) + depth.at(k, 63) + depth.at(0, k) + depth.at(63, k),
                          0.03F * largest)
                    << n;
            }
        }
    }
}

TEST_F(films, models_are_turned_together_and_steps_get_a_number_each) {
    const auto both = json("render 'models/*.ply' -o turn/ --turntable 2 --size 16");
    EXPECT_EQ(both["pictures"].size(), 2u);
    EXPECT_EQ(both["pictures"][0]["output"], "turn/0001.png");
    const auto steps = json("render 'models/*.ply' -o s_%d.png --size 16")["pictures"];
    ASSERT_EQ(steps.size(), 2u);
    EXPECT_EQ(steps[1]["output"], "s_2.png");
    EXPECT_EQ(steps[0]["extinction"], steps[1]["extinction"]);
}

TEST_F(films, time_runs_once_during_a_turn_of_steps) {
    const auto turn = json(
        "render 'models/*.ply' -o turn/ --turntable 4 --steps --size 32x24 --eye 90,0,0 --look-at "
        "0,0,0 --show mean --field density")["pictures"];
    ASSERT_EQ(turn.size(), 4u);
    // A quarter a picture, about the y axis; the first two of the first step.
    const char* const eyes[] = {"90,0,0", "0,0,-90", "-90,0,0", "0,0,90"};
    for (std::size_t n = 0; n < 4; ++n) {
        EXPECT_EQ(turn[n]["range"], turn[0]["range"]);
        const auto range = turn[0]["range"];
        must(
            fmt::format("render models/step_{}.ply -o one.png --size 32x24 --eye={} --look-at "
                        "0,0,0 --show mean --field density --range={},{}",
                        n < 2 ? 1 : 2, eyes[n], range[0].dump(), range[1].dump()));
        const PictureDifference difference = compare(
            read_image(dir_ / "one.png"), read_image(dir_ / fmt::format("turn/{:04}.png", n + 1)));
        EXPECT_LE(difference.largest, 1) << n;
    }
    // Fewer pictures than steps: some steps are left out.
    EXPECT_EQ(json("render 'models/*.ply' -o s_%d.png --turntable 1 --steps --size 16")["pictures"]
                  .size(),
              1u);
    must_fail(2, "render 'models/*.ply' -o s/ --steps", "--steps needs --turntable");
}

TEST_F(films, bad_requests_say_what_would_be_valid) {
    must_fail(2, "render models/step_1.ply -o one.png --turntable 4",
              "a numbered name (t_%04d.png) or a film");
    must_fail(2, "render models/step_1.ply -o t/ --turntable 0", "--turntable");
    must_fail(2, "render models/step_1.ply -o t/ --turntable 2 --set fps=10",
              "--set fps has no effect");
    must_fail(2, "render models/step_1.ply -o film.mp4", "a film needs several pictures");
    must_fail(1, "render models/step_1.ply -o none/%d.png --turntable 2", "no folder 'none'");
    must_fail(1, "render models/step_1.ply -o %d.jpg --turntable 2",
              "this command writes .png, .exr");
    must_fail(1, "render models/step_1.ply -o film.mp4 --turntable 2",
              "-o FOLDER/ writes the pictures as PNG files", "PATH=/nonexistent");
    EXPECT_FALSE(std::filesystem::exists(dir_ / "t"));
    EXPECT_FALSE(std::filesystem::exists(dir_ / "film.mp4"));
}

TEST_F(films, a_film_is_its_pictures) {
    if (!has_ffmpeg()) GTEST_SKIP() << "no ffmpeg here";
    // An odd width, as films have not, and a name that a shell or ffmpeg could take for more.
    const std::string view = "render models/step_2.ply --turntable 5 --size 97x64 --tf gray ";
    must(view + "-o turn/");
    for (const std::string name : {"-a %d;$(touch x):b.mp4", "film.webm"}) {
        const auto film = json(view + "--set fps=10 '--output=" + name + "'");
        EXPECT_EQ(film["film"]["pictures"], 5);
        EXPECT_EQ(film["film"]["seconds"], 0.5);
        EXPECT_EQ(film["film"]["bytes"], std::filesystem::file_size(dir_ / name));
        const std::string probe = shell(
            "ffprobe -v error -count_frames -show_entries "
            "stream=width,height,nb_read_frames,r_frame_rate,color_space -of csv=p=0 'file:" +
            name + "'");
        EXPECT_EQ(probe.substr(0, probe.find('\n')), "98,64,bt709,10/1,5");
        // Quality: the decoded pictures against those of the folder; grey, as chroma has half the resolution.
        shell("ffmpeg -y -v error -i 'file:" + name +
              "' -vf scale=in_color_matrix=bt709,crop=97:64:0:0 back_%04d.png");
        for (int n = 1; n <= 5; ++n) {
            const std::string number = fmt::format("{:04}.png", n);
            EXPECT_GT(json("compare turn/" + number + " back_" + number)["psnr_rgb_db"], 36)
                << name << n;
        }
    }
    EXPECT_FALSE(std::filesystem::exists(dir_ / "x"));
    // Time steps.
    EXPECT_EQ(json("render 'models/*.ply' -o film.mp4 --size 32")["film"]["pictures"], 2);
}

TEST_F(films, a_film_that_fails_leaves_the_one_before) {
    std::filesystem::create_directories(dir_ / "bin");
    std::ofstream(dir_ / "bin/ffmpeg") << "#!/bin/sh\necho 'no such encoder' >&2\nexit 1\n";
    std::filesystem::permissions(dir_ / "bin/ffmpeg", std::filesystem::perms::owner_all);
    std::ofstream(dir_ / "film.mp4") << "before";
    const std::size_t before = files();
    must_fail(1, "render models/step_1.ply -o film.mp4 --turntable 3 --size 512",
              "film.mp4: ffmpeg failed: no such encoder", "PATH=\"$PWD/bin:/bin:/usr/bin\"");
    EXPECT_EQ(read_text(dir_ / "film.mp4"), "before");
    EXPECT_EQ(files(), before);
    must_fail(1, "render models/step_1.ply -o film.mp4 --turntable 3 --background transparent",
              "films have no transparency", "PATH=\"$PWD/bin:/bin:/usr/bin\"");
}

}  // namespace vog::test
