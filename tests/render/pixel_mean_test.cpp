// pixel_mean_test.cpp: Gaussians smaller than a pixel: every renderer shows their mass at every size
// and place, and leaves larger ones as they are.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>

#include "render/ray_gaussian.h"
#include "render/splat/splat.h"
#include "render/trace/trace.h"
#include "support/device_twin.h"
#include "support/scenes.h"
#include "support/screen_mass.h"

namespace vog::test {

namespace {

DepthImage splatted(const Gaussians& model, const Camera& camera, int width, int height) {
    return render_splat(model, camera, width, height);
}
DepthImage traced(const Gaussians& model, const Camera& camera, int width, int height) {
    return render_trace(trace_scene(model), camera, width, height);
}
DepthImage collected(const Gaussians& model, const Camera& camera, int width, int height) {
    return render_trace(trace_scene(model), camera, width, height, {.anyhit = AnyHit::collect});
}

struct Drawing {
    const char* name;
    PictureOf render;

    friend std::ostream& operator<<(std::ostream& out, const Drawing& drawing) {
        return out << drawing.name;
    }
};
class pixel_mean_of : public testing::TestWithParam<Drawing> {};

std::vector<Drawing> drawings() {
    return {{"splat", splatted},
            {"trace", traced},
            {"collect", collected},
            {"device", render_tile_splat_twin}};
}

TEST_P(pixel_mean_of, particles_keep_their_mass_at_every_size) {
    for (const int size : {64, 300}) expect_mass_of_particles(GetParam().render, size);
}

TEST_P(pixel_mean_of, one_gaussian_keeps_its_mass_wherever_it_is) {
    expect_mass_of_one(GetParam().render);
}

TEST_P(pixel_mean_of, needles_and_discs_keep_their_mass) {
    expect_mass_of_thin_ones(GetParam().render);
}

/// Two pixels and more, rotated, from outside and inside: every pixel is the ray's through its centre.
TEST_P(pixel_mean_of, wider_ones_are_exact_at_pixel_centres) {
    const Gaussians model = random_gaussians(40, 0.2, 0.5, 63);
    for (const double distance : {0.8, 4.0}) {
        const Camera camera =
            orbit_view(Box{{-1, -1, -1}, {1, 1, 1}},
                       {.azimuth_degrees = 20, .distance_radii = distance, .fov_degrees = 40});
        constexpr int kSize = 80;
        const CameraFrame frame = frame_of(camera, kSize, kSize);
        const DepthImage image = GetParam().render(model, camera, kSize, kSize);
        const double largest = *std::max_element(image.depth.begin(), image.depth.end());
        for (int row = 0; row < kSize; ++row)
            for (int column = 0; column < kSize; ++column) {
                double exact = 0;
                for (std::size_t i = 0; i < model.size(); ++i)
                    exact += optical_depth(model, i, frame.origin(column, row),
                                           frame.direction(column, row));
                ASSERT_NEAR(image.at(column, row), exact, 1e-5 * largest);
            }
    }
}

INSTANTIATE_TEST_SUITE_P(renderers, pixel_mean_of, testing::ValuesIn(drawings()),
                         [](const auto& each) { return std::string(each.param.name); });

TEST(pixel_mean, other_sizes_show_the_mass_too) {
    for (const int size : {128, 512, 1024, 2048}) expect_mass_of_particles(splatted, size);
}

/// A Gaussian that approaches the camera from 0.1 to 4 pixels: no step of its middle pixel is larger
/// than the steps around it allow.
TEST(pixel_mean, a_picture_changes_continuously_with_the_distance) {
    Gaussians model;
    add(model, {0, 0, 0}, {0.5f, 0.3f, 0.4f}, 1, {0.8f, 0.3f, -0.4f, 0.33f});
    Camera camera;
    camera.fov_degrees = 20;
    const auto middle = [&](double distance) {
        camera.eye = {0, 0, distance};
        return double{render_splat(model, camera, 33, 33).at(16, 16)};
    };
    // T grows from distance^-2 to a constant: steps of 0.3 % change it by 1 % at most.
    for (double distance = 12; distance < 400; distance *= 1.003) {
        const double before = middle(distance), after = middle(distance * 1.003);
        ASSERT_NEAR(after / before, 1, 0.01) << distance;
    }
}

}  // namespace

}  // namespace vog::test
