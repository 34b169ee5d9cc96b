// value_options_test.cpp: options of volume rendering by value.
#include "options/value_options.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "options/option_effects.h"
#include "pictures/drawing_options.h"

namespace vog::cli {
namespace {

std::string refusal(const std::function<void()>& call) {
    try {
        call();
    } catch (const CLI::ValidationError& error) {
        return error.what();
    }
    return "accepted";
}
void expect_in(const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
}

std::string bands_refused(const std::vector<std::string>& bands,
                          const std::vector<std::string>& isos = {}) {
    ValueArguments given;
    given.bands = bands, given.isos = isos;
    return refusal([&] { (void)bands_of(given); });
}

/// Checks of a whole command line.
std::string line_refused(const std::string& line, bool volume = true) {
    CLI::App app;
    ValueArguments given;
    std::string tf, range;
    app.add_option("--tf", tf);
    app.add_option("--range", range);
    add_value_options(app, given);
    app.parse(line);
    return refusal([&] {
        require_effects(app, {{"show", volume ? "volume" : "T"}});
        check_value_options(given);
    });
}

TEST(value_options, bands_and_surfaces_are_sorted) {
    ValueArguments given;
    given.bands = {"-3,-1,#ff8000,0.5", "7,8,blue,1"};
    given.isos = {"9,white", "2,red"};
    const std::vector<ValueBand> bands = bands_of(given);
    ASSERT_EQ(bands.size(), 4u);
    EXPECT_EQ(bands[0].lower, -3);
    EXPECT_EQ(bands[0].r, 1);
    EXPECT_EQ(bands[0].g, 128.0f / 255);
    EXPECT_EQ(bands[1].upper, 7);  // a surface ends where the next band begins
    EXPECT_EQ(bands[1].opacity, kMostOpacity);
    EXPECT_TRUE(std::isinf(bands[3].upper));
}

TEST(value_options, texts_that_are_none_are_refused) {
    expect_in(bands_refused({"3,2,red,0.5"}), "expected the first value below the second");
    expect_in(bands_refused({"1,3,red,0.5", "2,4,red,1"}), "overlaps");
    expect_in(bands_refused({"1,3,red,0.5"}, {"2,red"}), "overlaps");
    expect_in(bands_refused({}, {"2,red", "2,blue"}), "overlaps");
    expect_in(bands_refused({"1,3,sky,0.5"}), "colour 'sky', expected #rrggbb or one of black");
    expect_in(bands_refused({"1,3,#12345g,0.5"}), "colour '#12345g'");
    expect_in(bands_refused({"1,3,red,2"}), "opacity 2, expected in [0, 1]");
    expect_in(bands_refused({"1,3,red"}), "expected LO,HI,COLOUR,OPACITY");
    expect_in(bands_refused({"1,nan,red,1"}), "'nan', expected a number");
    expect_in(bands_refused({}, {"red,2"}), "'red', expected a number");
    expect_in(line_refused("--window 3,0"), "expected C,W, a centre and a width above 0");
    expect_in(line_refused("--unit-distance -1"), "--unit-distance -1: expected a finite length");
    expect_in(line_refused("--unit-distance inf"), "expected a finite length");
    expect_in(line_refused("--light up"), "--light up: expected head or a direction X,Y,Z");
    expect_in(line_refused("--light 0,0,0"), "expected head or a direction X,Y,Z");
    expect_in(line_refused("--light head --light-weights 1,-1,0,1"), "diffuse -1");
    expect_in(line_refused("--light head --light-weights 1,1"), "AMBIENT,DIFFUSE,SPECULAR,POWER");
    EXPECT_EQ(line_refused("--band 1,2,red,1 --band 2,3,blue,0.5 --light -1,2,0"), "accepted");
}

TEST(value_options, that_exclude_each_other_are_refused) {
    expect_in(line_refused("--window 3,1 --iso 3,red"), "--window and --iso exclude each other");
    expect_in(line_refused("--window 3,1 --tf gray"), "--tf and --window exclude each other");
    expect_in(line_refused("--band 1,2,red,1 --range 1,2"),
              "--range and --band exclude each other");
    expect_in(line_refused("--light-weights 1,1,1,1"), "--light-weights needs --light");
    expect_in(line_refused("--threshold 2", false), "--threshold has no effect with --show T");
    EXPECT_EQ(line_refused("--threshold 2 --tf gray --range 1,2"), "accepted");
}

TEST(value_options, clips_are_a_box_and_planes) {
    DrawingArguments given;
    given.clip_box = "-1,0,0,1,2,3";
    given.clip_planes = {"0,0,1,-5"};
    const Clipping clip = clip_of(given);
    EXPECT_EQ(clip.box->upper.z, 3);
    EXPECT_EQ(clip.planes[0].offset, -5);
    const auto refused = [](const std::string& box, const std::string& plane) {
        DrawingArguments wrong;
        wrong.clip_box = box;
        if (!plane.empty()) wrong.clip_planes = {plane};
        return refusal([&] { (void)clip_of(wrong); });
    };
    expect_in(refused("0,0,0,1,1", ""), "expected x0,y0,z0,x1,y1,z1");
    expect_in(refused("0,0,0,1,-1,1", ""), "y from 0 to -1, expected the first below the second");
    expect_in(refused("", "0,0,0,1"), "a normal that is not 0");
    expect_in(refused("", "0,0,1"), "expected nx,ny,nz,d");
}

}  // namespace
}  // namespace vog::cli
