// request_options_test.cpp: members of requests as options of a command line.
#include "options/request_options.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "options/option_effects.h"
#include "options/parser/command_line.h"
#include "options/parser/settings.h"
#include "support/refusal.h"

namespace vog::cli {
namespace {

void expect_in(const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
}

/// The request of a command line.
PictureRequest request_of(const std::string& line) {
    CLI::App app;
    RequestWords words;
    add_request_options(app, words);
    run_command(app, CLI::detail::split_up(line));
    require_effects(GivenOptions(app), {{"show", word_of(words.show())}});
    return words.over();
}
std::string refused(const std::string& line) {
    try {
        (void)request_of(line);
    } catch (const UsageError& error) {
        return as_typed(error.what());
    } catch (const Error& error) {
        return error.what();
    }
    return "accepted";
}
std::string volume_refused(const std::string& line) { return refused("--show volume " + line); }

TEST(request_options, of_every_member_set_it) {
    const PictureRequest request = request_of(
        "--show mean --field velocity.x --range=-1,2.5 --scale symmetric --units km/s --size 40x30 "
        "--background 0.1,0.2,0.3 --color-bar --title 12 --clip=-1,0,0,1,2,3 --clip 0,0,1,-5 "
        "--clip 1,0,0,2 --renderer trace --set kappa=0.1 --tf viridis --set least-column=0.01");
    EXPECT_EQ(request.show, Show::mean);
    EXPECT_EQ(request.field, "velocity.x");
    EXPECT_EQ(request.transfer.range, std::pair(-1.0, 2.5));
    EXPECT_EQ(request.fit, ScaleFit::symmetric);
    EXPECT_EQ(request.unit, "km/s");
    EXPECT_EQ(request.width, 40);
    EXPECT_EQ(request.height, 30);
    EXPECT_EQ(request.shading.background.b, 0.3f);
    EXPECT_TRUE(request.marks.color_bar);
    EXPECT_EQ(request.marks.title, "12");
    EXPECT_EQ(request.options.clip.box->upper.z, 3);
    ASSERT_EQ(request.options.clip.planes.size(), 2u);
    EXPECT_EQ(request.options.clip.planes[0].offset, -5);
    EXPECT_EQ(request.renderer, Renderer::trace);
    EXPECT_EQ(request.options.kappa, 0.1);
    EXPECT_FALSE(request.transfer.points.points.color.empty());
    EXPECT_EQ(request.least_column, 0.01);
    EXPECT_EQ(request_of("--size 7").height, 7);
    EXPECT_FALSE(request_of("--extinction auto").extinction);
    EXPECT_EQ(*request_of("--extinction 2.5").extinction, 2.5);
}

TEST(request_options, bands_and_surfaces_are_sorted) {
    const std::vector<ValueBand> bands =
        request_of(
            "--show volume --band=-3,-1,#ff8000,0.5 --band 7,8,blue,1 --iso 9,white --iso "
            "2,red")
            .transfer.bands;
    ASSERT_EQ(bands.size(), 4u);
    EXPECT_EQ(bands[0].lower, -3);
    EXPECT_EQ(bands[0].r, 1);
    EXPECT_EQ(bands[0].g, 128.0f / 255);
    EXPECT_EQ(bands[1].upper, 7);  // a surface ends where the next band begins
    EXPECT_EQ(bands[1].opacity, kMostOpacity);
    EXPECT_TRUE(std::isinf(bands[3].upper));
    EXPECT_EQ(request_json(request_of("--show volume --iso 2")),
              request_json(request_of("--show volume --iso 2,ivory")));
}

TEST(request_options, words_that_are_none_are_refused) {
    expect_in(volume_refused("--band 3,2,red,0.5"), "3");
    expect_in(volume_refused("--band 1,3,red,0.5 --band 2,4,red,1"), "overlap");
    expect_in(volume_refused("--band 1,3,red,0.5 --iso 2,red"), "overlap");
    expect_in(volume_refused("--band 1,3,sky,0.5"),
              "--band sky: expected a colour, #rrggbb or one of black");
    expect_in(volume_refused("--band 1,3,#12345g,0.5"), "#12345g");
    expect_in(volume_refused("--band 1,3,red,2"), "opacity 2");
    expect_in(volume_refused("--band 1,3,red"), "--band 1,3,red: expected");
    expect_in(volume_refused("--iso high"), "or the value of a surface");
    expect_in(volume_refused("--band 1,nan,red,1"), "--band nan: expected a number");
    expect_in(volume_refused("--iso red,2"), "--band red: expected a number");
    expect_in(volume_refused("--window 3,0"), "--window 3,0: expected CENTRE,WIDTH");
    expect_in(volume_refused("--unit-distance=-1"), "--unit-distance -1: expected a finite length");
    expect_in(volume_refused("--unit-distance inf"), "expected a finite length");
    expect_in(volume_refused("--light up"),
              "--light up: expected studio, head, x,y,z or camera:x,y,z");
    expect_in(volume_refused("--light 0,0,0"), "expected a direction of a length above 0");
    expect_in(volume_refused("--light 1,2,1=-1"), "expected a finite strength");
    EXPECT_TRUE(request_of("--show volume --light camera:0,1,1=0.4").look.lights.at(0).of_camera);
    expect_in(volume_refused("--light head --set light-weights=1,-1,0,1"), "diffuse -1");
    expect_in(volume_refused("--light head --set light-weights=1,1"), "ambient, diffuse");
    EXPECT_EQ(volume_refused("--band 1,2,red,1 --band 2,3,blue,0.5 --light=-1,2,0"), "accepted");
    expect_in(refused("--show column --range 2,1"), "--range 2,1: expected LO,HI");
    expect_in(refused("--size 0x4"), "--size 0x4: expected pixels");
    expect_in(refused("--background 1,2,3"), "--background 1,2,3: expected black");
    expect_in(refused("--extinction none"), "--extinction none: expected auto or a number above 0");
    expect_in(refused("--clip 0,0,0,1,1"), "--clip 0,0,0,1,1: expected a box X0,Y0,Z0,X1,Y1,Z1");
    expect_in(refused("--clip 0,0,0,1,-1,1"), "expected the first below the second");
    expect_in(refused("--clip 0,0,0,1"), "a normal that is not 0");
    expect_in(refused("--clip 0,0,1"), "or a plane NX,NY,NZ,D");
}

TEST(request_options, that_exclude_each_other_are_refused) {
    expect_in(volume_refused("--window 3,1 --iso 3,red"), "--window and --iso exclude each other");
    expect_in(volume_refused("--window 3,1 --tf gray"), "--tf and --window exclude each other");
    expect_in(volume_refused("--band 1,2,red,1 --range 1,2"),
              "--range and --band exclude each other");
    expect_in(volume_refused("--set light-weights=1,1,1,1"),
              "--set light-weights needs --light, --shadows or --ambient-occlusion");
    EXPECT_EQ(volume_refused("--shadows --set light-weights=1,1,1,1"), "accepted");
    expect_in(refused("--threshold 2"), "--threshold has no effect with --show T");
    EXPECT_EQ(volume_refused("--threshold 2 --tf gray --range 1,2"), "accepted");
}

}  // namespace
}  // namespace vog::cli
