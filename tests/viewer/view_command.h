// view_command.h: vog view driven by scripts, and its pictures beside those of vog render.
#pragma once

#include <string>

#include "screen/screen.h"
#include "support/command.h"
#include "vog/compare.h"
#include "vog/error.h"

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

}  // namespace vog::test
