// shade_gl_test.cpp: shading in OpenGL against vog::shade.
#include "gl/shade_gl.h"

#include <algorithm>
#include <cmath>

#include "support/scenes.h"
#include "viewer/headless.h"
#include "vog/compare.h"
#include "vog/error.h"

namespace vog::test {

using namespace viewer;

namespace {

/// Depths for V from 0 to 1, empty pixels, and depths so large that V is 1 in 8 bits.
DepthImage all_depths() {
    DepthImage depth(256, 64);
    for (std::size_t i = 0; i < depth.depth.size(); ++i)
        depth.depth[i] = i % 256 == 0 ? 0.0f : 1e-4f * std::exp(static_cast<float>(i) * 7e-4f);
    return depth;
}

Image draw(const DepthImage& depth, const Look& look, ShadeView view = {}) {
    const GlTarget t(GL_R32F, depth.width, depth.height);
    t.upload(depth.depth);
    GlShade shade;
    shade.set_look(look);
    const GlTarget picture(GL_RGBA8, depth.width, depth.height);
    picture.bind();
    view.checker = false;
    shade.draw({&t, 1}, {&t, 1}, view, {0, 0, depth.width, depth.height});
    return read_picture(depth.width, depth.height);
}

}  // namespace

class shade_gl : public headless {
  protected:
    void expect_like_shade(const Look& look) {
        const DepthImage depth = all_depths();
        DepthImage scaled = depth;
        set_extinction(scaled, look.extinction);
        const Image expected = vog::shade(scaled, transfer_function(look), look.shading);
        const Image drawn = draw(depth, look);
        for (std::size_t i = 0; i < drawn.pixel.size(); ++i) {
            const Rgba &a = expected.pixel[i], &b = drawn.pixel[i];
            // Half a step of the rounding to 8 bits, plus half a step of the sampled map.
            for (const float difference : {a.r - b.r, a.g - b.g, a.b - b.b, a.a - b.a})
                ASSERT_LE(std::abs(difference), 1.01f / 255)
                    << "pixel " << i << ", T " << scaled.depth[i];
        }
    }
};

TEST_F(shade_gl, every_map_is_within_a_step_of_the_cpus) {
    for (const std::string& name : transfer_function_names()) {
        SCOPED_TRACE(name);
        Look look;
        load_map(look, name);
        expect_like_shade(look);
    }
}

TEST_F(shade_gl, opacity_range_gamma_inversion_blend_and_background_are_the_cpus) {
    Look look;
    load_map(look, "viridis");
    look.opacity = {{0, 0}, {0.3f, 0.8f}, {1, 1}};
    look.shading.background = {0.2f, 0.4f, 0.9f, 1};
    expect_like_shade(look);
    look.low = 0.2f, look.high = 0.7f;
    expect_like_shade(look);
    look.gamma = 2.5f;
    expect_like_shade(look);
    look.invert = true;
    expect_like_shade(look);
    look.shading.blend = true;
    expect_like_shade(look);
    look.extinction = 3.7;
    expect_like_shade(look);
    look.shading.background = {0, 0, 0, 0};  // straight alpha
    expect_like_shade(look);
}

TEST_F(shade_gl, a_look_without_changes_is_the_map_itself) {
    const Look look;
    const TransferFunction tf = transfer_function(look), map = named_transfer_function(kDefaultMap);
    for (int i = 0; i <= 1000; ++i) {
        const float v = static_cast<float>(i) / 1000;
        EXPECT_EQ(color_at(tf, v), color_at(map, v)) << v;
    }
}

TEST_F(shade_gl, gamma_follows_its_curve) {
    Look look;
    load_map(look, "gray");
    for (const float gamma : {0.3f, 0.5f, 2.0f, 5.0f}) {
        look.gamma = gamma;
        const TransferFunction tf = transfer_function(look);
        for (int i = 0; i <= 1000; ++i) {
            const float v = static_cast<float>(i) / 1000;
            EXPECT_NEAR(color_at(tf, v).r, std::pow(v, gamma), 1.0 / 255) << gamma << " at " << v;
        }
    }
}

TEST_F(shade_gl, steps_are_kept) {
    Look look;
    look.base = {"steps", {{0, 1, 0, 0}, {0.5f, 1, 0, 0}, {0.5f, 0, 0, 1}, {1, 0, 0, 1}}, {}};
    for (const bool invert : {false, true}) {
        look.invert = invert;
        const TransferFunction tf = transfer_function(look);
        EXPECT_EQ(color_at(tf, 0.49f).r, invert ? 0 : 1);
        EXPECT_EQ(color_at(tf, 0.51f).r, invert ? 1 : 0);
    }
}

TEST_F(shade_gl, the_split_line_divides_two_images) {
    DepthImage thick(64, 16), thin(64, 16);
    std::fill(thick.depth.begin(), thick.depth.end(), 30.0f);
    const GlTarget a(GL_R32F, 64, 16), b(GL_R32F, 64, 16), picture(GL_RGBA8, 64, 16);
    a.upload(thick.depth);
    b.upload(thin.depth);
    GlShade shade;
    Look look;
    load_map(look, "gray");
    shade.set_look(look);
    picture.bind();
    ShadeView view;
    view.split = 0.25f;
    shade.draw({&a, 1}, {&b, 1}, view, {0, 0, 64, 16});
    const Image drawn = read_picture(64, 16);
    for (int column = 0; column < 64; ++column)
        EXPECT_EQ(drawn.at(column, 8).r, column < 16 ? 1 : 0) << column;
}

TEST_F(shade_gl, equal_images_differ_in_nothing) {
    ShadeView view;
    view.difference = true;
    const Image drawn = draw(all_depths(), {}, view);
    for (const Rgba& pixel : drawn.pixel) ASSERT_NEAR(pixel.r, 0.8667f, 1.0 / 255);
}

}  // namespace vog::test
