// periodic_test.cpp: particles and meshes of periodic boxes, and kernels that particles state.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "support/level_volumes.h"
#include "support/refusal.h"
#include "vog/convert_points.h"
#include "vog/periodic.h"
#include "vog/picture.h"

namespace vog::test {
namespace {

const Box kBox{{-2, 1, 3}, {6, 9, 11}};  // edge 8

/// Particles anywhere in kBox, denser towards one corner, which lies on its faces.
Points scattered(std::size_t count) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> place(0, 1);
    Points points;
    points.source = "box.xyz";
    for (std::size_t n = 0; n < count; ++n) {
        const auto at = [&](double lower) { return lower + 8 * std::pow(place(random), 2); };
        points.position.push_back({at(-2), at(1), at(3)});
    }
    return points;
}

/// T at extinction 1 along an axis, through the box alone.
DepthImage column_of(const Gaussians& model, int axis, int size) {
    Vec3d along, up;
    along[axis] = 1;
    up[(axis + 1) % 3] = 1;
    Camera camera{kBox.center() + 20.0 * along, kBox.center(), up};
    camera.orthographic_width = 8;
    PictureRenderer renderer(scene_of(model));
    return bare_depth(
        renderer,
        {.camera = camera, .width = size, .height = size, .options = {.clip = {kBox, {}}}});
}
double mass_of(const DepthImage& depth) {
    double sum = 0;
    for (const float t : depth.depth) sum += t;
    return sum * std::pow(8.0 / depth.width, 2);
}

}  // namespace

TEST(periodic, a_particle_at_a_face_is_at_both_and_in_a_corner_at_eight) {
    Points points;
    points.position = {{5.9, 5, 7}};
    Gaussians model = convert_points(points, {.radius = 0.25, .periodic = kBox});
    ASSERT_EQ(model.size(), 2u);
    EXPECT_NEAR(world_mean(model, 1).x, 5.9 - 8, 1e-5);
    EXPECT_EQ(model.density[1], model.density[0]);
    points.position = {{-2, 1, 3}};
    model = convert_points(points, {.radius = 0.25, .periodic = kBox});
    EXPECT_EQ(model.size(), 8u);
    const Gaussians one = without_images(model);
    ASSERT_EQ(one.size(), 1u);
    EXPECT_EQ(world_mean(one, 0).x, -2);
    EXPECT_EQ(without_images(convert_points(points, {.radius = 0.25})).size(), 1u);
    points.position = {{2, 5, 7}};
    model = convert_points(points, {.radius = 0.25, .periodic = kBox});
    EXPECT_EQ(model.size(), 1u);
    EXPECT_EQ(periodic_box(model), kBox) << model.options;
    EXPECT_EQ(model.box, kBox);
}

TEST(periodic, mass_in_the_box_is_that_of_the_particles) {
    const Points points = scattered(4000);
    for (const double radius : {0.0, 0.5}) {
        const Gaussians open = convert_points(points, {.radius = radius});
        const Gaussians model = convert_points(points, {.radius = radius, .periodic = kBox});
        for (int axis = 0; axis < 3; ++axis) {
            // Kernels cut by the faces are sampled at pixel centres.
            EXPECT_NEAR(mass_of(column_of(model, axis, 256)) / 4000, 1, 1e-3);
            EXPECT_NEAR(mass_without_images(model) / 4000, 1, 1e-6);
            EXPECT_LT(mass_of(column_of(open, axis, 256)) / 4000, 0.99) << "what is lost";
        }
    }
}

TEST(periodic, moving_all_particles_by_half_the_box_moves_the_picture) {
    Points points = scattered(3000);
    const DepthImage first = column_of(convert_points(points, {.periodic = kBox}), 2, 128);
    for (Vec3d& at : points.position) at = at + Vec3d{4, 4, 4};  // wrapped by the conversion
    const DepthImage moved = column_of(convert_points(points, {.periodic = kBox}), 2, 128);
    double difference = 0, square = 0;
    for (std::size_t y = 0; y < 128; ++y)
        for (std::size_t x = 0; x < 128; ++x) {
            const double a = first.depth[128 * y + x];
            const double b = moved.depth[128 * ((y + 64) % 128) + (x + 64) % 128];
            difference += (a - b) * (a - b), square += a * a;
        }
    // Rounding of means and scales to floats, of box edge times 2^-24.
    EXPECT_LT(std::sqrt(difference / square), 1e-4);
}

TEST(periodic, neighbours_are_found_across_faces) {
    Points points;
    for (int n = 0; n < 512; ++n)
        points.position.push_back(kBox.lower +
                                  Vec3d{n % 8 + 0.25, n / 8 % 8 + 0.25, n / 64 + 0.25});
    const Gaussians model = convert_points(points, {.neighbours = 6, .periodic = kBox});
    for (std::size_t i = 0; i < model.size(); ++i)
        EXPECT_NEAR(model.scale[i].x / model.scale[0].x, 1, 1e-5) << i;
    const Gaussians open = convert_points(points, {.neighbours = 6});
    EXPECT_NEAR(open.scale[0].x / model.scale[0].x, std::sqrt(2.0), 1e-5)
        << "a corner of the lattice has three neighbours at its edge";
}

TEST(periodic, the_stated_box_counts_and_none_is_refused) {
    Points points = scattered(100);
    EXPECT_NE(refusal([&] {
                  (void)convert_points(points, {.periodic = Box{}});
              }).find("box.xyz: the file states no periodic box, expected --periodic EDGE"),
              std::string::npos);
    points.box = kBox;
    EXPECT_EQ(convert_points(points, {.periodic = Box{}}).box, kBox);
    const double edge[] = {8}, inside_out[] = {0, 0, 0, 1, -1, 1}, corners[] = {-2, 1, 3, 6, 9, 11};
    EXPECT_EQ(box_of_numbers(edge), (Box{{}, {8, 8, 8}}));
    EXPECT_EQ(box_of_numbers(corners), kBox);
    EXPECT_THROW((void)box_of_numbers(inside_out), Error);
    EXPECT_THROW((void)convert_points(points, {.radius = 20, .periodic = kBox}), Error);
}

TEST(periodic, a_mesh_states_its_domain_where_its_coarsest_cells_fill_it) {
    Volume cube = cube_of(16, 0.5f, {});
    EXPECT_EQ(domain_box({&cube, 1}), world_box(cube));
    cube.leaves.back().mask[0] &= ~std::uint64_t{1};
    EXPECT_TRUE(domain_box({&cube, 1}).empty());
}

TEST(smoothing, radii_in_another_unit_than_the_positions_are_converted) {
    Points points;
    points.position = {{0, 0, 0}, {40, 0, 0}};
    points.length_unit = "kpc";
    points.attributes = {{"hsml", {2, 3}, 1, "kpc"}};
    const Gaussians in_kpc = convert_points(points, {.smoothing = "hsml"});
    points.attributes[0] = {"hsml", {2000, 3000}, 1, "pc"};
    EXPECT_FLOAT_EQ(convert_points(points, {.smoothing = "hsml"}).scale[1].x, in_kpc.scale[1].x);
    points.attributes[0].unit_name = "s";
    EXPECT_THROW((void)convert_points(points, {.smoothing = "hsml"}), Error);
}

TEST(smoothing, stated_radii_have_the_variance_of_cubic_splines) {
    Points points = scattered(3);
    points.attributes = {{"SmoothingLength", {1, 2, 3}}};
    const Gaussians model = convert_points(points);
    EXPECT_EQ(model.cutoff, kSplineCutoff);
    for (std::size_t i = 0; i < 3; ++i) {
        const double h = points.attributes[0].value[i];
        EXPECT_NEAR(std::pow(model.scale[i].y, 2) * variance_within(model.cutoff), 3.0 / 40 * h * h,
                    1e-6 * h * h);
        EXPECT_NEAR(mass(model, i), 1, 1e-6);
    }
    EXPECT_NE(model.options.find("--radius SmoothingLength"), std::string::npos);
    points.attributes[0].name = "SmoothingLengths";  // SWIFT's are 1.825742 times smaller
    EXPECT_NEAR(convert_points(points).scale[2].x / model.scale[2].x, 1.825742, 1e-5);
    points.attributes[0].name = "h";
    EXPECT_EQ(convert_points(points).cutoff, kMomentCutoff) << "adaptive";
    EXPECT_EQ(convert_points(points, {.smoothing = "h"}).scale[2], model.scale[2]);
    points.attributes[0].value[1] = 0;
    EXPECT_NE(refusal([&] {
                  (void)convert_points(points, {.smoothing = "h"});
              }).find("'h' of particle 1 is 0, expected a radius above 0"),
              std::string::npos);
    EXPECT_THROW((void)convert_points(points, {.smoothing = "k"}), Error);
}

}  // namespace vog::test
