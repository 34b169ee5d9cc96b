// web_codec_test.cpp: errors of a page's encoding, with a decoder of the format of web_codec.h.
#include "web/web_codec.h"

#include <gtest/gtest.h>
#include <cmath>

#include "support/scenes.h"
#include "support/web_decoder.h"
#include "vog/compare.h"
#include "vog/splat.h"

namespace vog::test {

using namespace vog::web;

namespace {

/// Index of the Gaussian nearest to `mean`.
std::size_t nearest(const Gaussians& model, Vec3f mean) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < model.size(); ++i)
        if (length(model.mean[i] - mean) < length(model.mean[best] - mean)) best = i;
    return best;
}

Mat3 shape(const Gaussians& model, std::size_t i) {
    const Mat3 r = model.axis_aligned() ? Mat3{} : matrix_from_quat(model.rotation[i]);
    Mat3 scaled = r;
    for (int row = 0; row < 3; ++row)
        for (int c = 0; c < 3; ++c) scaled(row, c) *= double{model.scale[i][c]};
    return scaled * transpose(scaled);
}

/// finer  factor on the bounds of the usual words
void expect_within_bounds(const Gaussians& model, const WebPrecision& precision = {},
                          double finer = 1) {
    const WebFrame frame = web_frame(model);
    const WebLevel level = web_level(model, frame, precision);
    const Gaussians back = decoded(level, frame, model.cutoff);
    ASSERT_EQ(back.size(), model.size());
    // Half a step, which a wide range of densities makes coarser than 1 / steps_per_unit, and roundings of floats.
    const double density_bound = std::exp2(0.5 * level.density.step) - 1 + 1e-6;
    EXPECT_LT(density_bound, 1.0 / 2000);
    for (std::size_t i = 0; i < back.size(); ++i) {
        const std::size_t j = nearest(model, back.mean[i]);
        const Vec3f s = model.scale[j];
        const double smallest = std::min({s.x, s.y, s.z}), largest = std::max({s.x, s.y, s.z});
        // Half a step of 1/256, and float rounding of both means.
        const double rounding = 2e-7 * (frame.unit + length(frame.center));
        for (int axis = 0; axis < 3; ++axis)
            EXPECT_NEAR(back.mean[i][axis], model.mean[j][axis],
                        smallest / (500 * finer) + rounding);
        EXPECT_NEAR(mass(back, i), mass(model, j), mass(model, j) * density_bound);
        // Relative errors of 1/2048 in scales and 0.0005 rad in axes: twice that in variances.
        const Mat3 a = shape(back, i), b = shape(model, j);
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(a(r, c), b(r, c), (0.0022 / finer + 1e-6) * largest * largest)
                    << i << " " << r << c;
    }
}

}  // namespace

TEST(web_codec, every_part_is_within_its_bound) {
    expect_within_bounds(random_gaussians(700, 0.005, 0.3, 1));
    expect_within_bounds(random_gaussians(700, 0.005, 0.3, 1), kPreciseWords, 8);
    Gaussians aligned = random_gaussians(700, 0.005, 0.3, 2);
    aligned.rotation.clear();
    expect_within_bounds(aligned);
    expect_within_bounds(aligned, kPreciseWords, 8);
    for (const float unit : {1e-12f, 1e-3f, 1e7f}) {
        Gaussians model = random_gaussians(100, 0.01, 0.2, 3);
        for (std::size_t i = 0; i < model.size(); ++i) {
            model.mean[i] = unit * (model.mean[i] + Vec3f{20, -3, 7});
            model.scale[i] = unit * model.scale[i];
        }
        expect_within_bounds(model);
    }
}

/// The page's numbers are relative to the centre, which alone is far away.
TEST(web_codec, far_from_the_origin_it_is_the_same) {
    const Gaussians near = random_gaussians(300, 0.01, 0.2, 5);
    Gaussians far = near;
    far.origin = {1 << 30, -4096, 0};  // no rounding
    const WebFrame frame = web_frame(near), far_frame = web_frame(far);
    EXPECT_LT(length(far_frame.center - (far.origin + frame.center)), 1e-6);
    EXPECT_EQ(far_frame.unit, frame.unit);
    // Centres at 1e9 are rounded to 1e-7, 1e-3 of the finest step.
    const WebLevel level = web_level(near, frame), far_level = web_level(far, far_frame);
    ASSERT_EQ(far_level.words.size(), level.words.size());
    for (std::size_t n = 0; n < level.words.size(); ++n)
        ASSERT_NEAR(far_level.words[n], level.words[n], 1) << n;
}

/// A scale may be smaller than the page's unit by more than the range of floats.
TEST(web_codec, scales_of_any_range_are_encoded) {
    Gaussians model;
    add(model, {0, 0, 0}, {1e-30f, 1e-30f, 1e-30f}, 1);
    add(model, {0, 0, 0}, {1e20f, 1e20f, 1e20f}, 1);
    const WebFrame frame = web_frame(model);
    const Gaussians again = decoded(web_level(model, frame), frame, model.cutoff);
    ASSERT_EQ(again.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(again.mean[i], model.mean[i]);
    EXPECT_NEAR(mass(again), mass(model), mass(model) / 2000);
}

/// Two clusters of narrow Gaussians, each quantised far more finely than 1/65536 of their distance.
TEST(web_codec, narrow_gaussians_far_apart_keep_their_places) {
    Random random(4);
    Gaussians model;
    for (int n = 0; n < 300; ++n) {
        const auto s = static_cast<float>(random(2e-5, 4e-5));
        const Vec3f place = vec_cast<float>(random.in_cube(0.003));
        add(model, place + Vec3f{n % 2 ? 1.0f : -1.0f, 0, 0}, {s, s, 2 * s}, 1, random.rotation());
    }
    expect_within_bounds(model);
    expect_within_bounds(model, kPreciseWords, 8);
}

TEST(web_codec, eight_decades_of_scale_and_density) {
    Random random(5);
    Gaussians model;
    for (int n = 0; n < 300; ++n) {
        const double s = std::pow(10, random(-5, 3));
        const Vec3d p = random.in_cube(50);
        add(model, vec_cast<float>(p), vec_cast<float>(s * Vec3d{1, 0.5, 0.1}),
            static_cast<float>(std::pow(10, random(-20, 20))), random.rotation());
    }
    const WebFrame frame = web_frame(model);
    const Gaussians back = decoded(web_level(model, frame), frame, model.cutoff);
    EXPECT_NEAR(mass(back), mass(model), mass(model) / 1000);
}

/// Permuting axes reduces every rotation to at most 62.8 degrees, within the range of the words.
TEST(web_codec, rotations_never_need_more_than_their_words) {
    Random random(6);
    Gaussians model;
    for (int n = 0; n < 20000; ++n)
        add(model, vec_cast<float>(random.in_cube(1)), {0.02f, 0.03f, 0.05f}, 1, random.rotation());
    const WebLevel level = web_level(model, web_frame(model));
    std::uint16_t smallest = 65535, largest = 0;
    for (std::size_t n = 6 * level.count; n < 9 * level.count; ++n) {
        smallest = std::min(smallest, level.words[n]);
        largest = std::max(largest, level.words[n]);
    }
    EXPECT_GT(smallest, 0);
    EXPECT_LT(largest, level.rotation_words);
    EXPECT_LT(smallest, 100);  // the range is used
    EXPECT_GT(largest, level.rotation_words - 100);
}

TEST(web_codec, empty_single_and_massless_models) {
    EXPECT_EQ(web_level({}, web_frame({})).count, 0u);
    Gaussians one;
    add(one, {3, 4, 5}, {1, 2, 3}, 7);
    expect_within_bounds(one);
    add(one, {4, 4, 4}, {1, 1, 1}, 0);
    EXPECT_EQ(web_level(one, web_frame(one)).count, 1u);
}

TEST(web_codec, pictures_do_not_change) {
    const Gaussians model = random_gaussians(2000, 0.02, 0.2, 8);
    const WebFrame frame = web_frame(model);
    const Gaussians back = decoded(web_level(model, frame), frame, model.cutoff);
    const Camera camera = paper_view(view_box(model));
    DepthImage reference = render_splat(model, camera, 128, 128);
    set_extinction(reference, auto_extinction(reference));
    const DepthDifference difference = compare(reference, render_splat(back, camera, 128, 128));
    EXPECT_GT(difference.grey.psnr_db, 60);
    EXPECT_NEAR(difference.bias, 1, 1e-4);
}

}  // namespace vog::test
