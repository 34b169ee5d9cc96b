// trackball_test.cpp: invariants and effects of the camera motions.
#include "ui/trackball.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "vog/error.h"

namespace vog::test {

using namespace viewer;

namespace {

const Box kBox{{-1, -2, -3}, {4, 5, 6}};

Camera some_camera() {
    Camera camera = orbit_view(kBox, {40, 23, 2.5, 40});
    camera.look_at = camera.look_at + Vec3d{0.3, -0.2, 0.5};
    return camera;
}

double distance(const Camera& camera) { return length(camera.look_at - camera.eye); }

/// Projection of a world point: right and up of the centre, in half heights.
ScreenPoint projected(const Camera& camera, Vec3d point) {
    const CameraFrame f = frame_of(camera, 100, 100);
    const Vec3d p = point - f.eye;
    const double scale = f.pixels_per_unit / (50 * dot(p, f.forward));
    return {dot(p, f.right) * scale, dot(p, f.up) * scale};
}

void expect_near(Vec3d a, Vec3d b, double tolerance) {
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(a[axis], b[axis], tolerance);
}

}  // namespace

TEST(trackball, turning_keeps_the_centre_and_the_distance) {
    const Camera camera = some_camera();
    for (const Camera& turned : {rotated(camera, {0.1, 0.2}, {-0.4, 0.6}),
                                 rotated(camera, {1.5, 0}, {0, 1.5}), orbited(camera, 1, 0.5)}) {
        EXPECT_EQ(turned.look_at, camera.look_at);
        EXPECT_NEAR(distance(turned), distance(camera), 1e-12 * distance(camera));
        EXPECT_GT(length(turned.eye - camera.eye), 0.1);
        EXPECT_NO_THROW(frame_of(turned, 10, 10));
    }
}

TEST(trackball, a_drag_to_the_right_brings_the_left_side_to_the_front) {
    const Camera camera = some_camera();
    const CameraFrame frame = frame_of(camera, 10, 10);
    const Camera turned = rotated(camera, {0, 0}, {0.3, 0});
    EXPECT_LT(dot(turned.eye - camera.eye, frame.right), 0);
    const Camera up = rotated(camera, {0, 0}, {0, 0.3});
    EXPECT_LT(dot(up.eye - camera.eye, frame.up), 0);
}

TEST(trackball, a_drag_and_back_is_nothing) {
    const Camera camera = some_camera();
    const Camera back = rotated(rotated(camera, {0.1, 0.2}, {-0.3, 0.5}), {-0.3, 0.5}, {0.1, 0.2});
    expect_near(back.eye, camera.eye, 1e-9);
}

TEST(trackball, panning_follows_the_pointer) {
    const Camera camera = some_camera();
    const Camera moved = panned(camera, {0.1, -0.2}, {0.5, 0.3}, 1);
    const ScreenPoint at = projected(moved, camera.look_at);
    EXPECT_NEAR(at.x, 0.4, 1e-9);
    EXPECT_NEAR(at.y, 0.5, 1e-9);
}

TEST(trackball, zooming_keeps_what_is_under_the_pointer) {
    const Camera camera = some_camera();
    const CameraFrame f = frame_of(camera, 100, 100);
    const ScreenPoint pointer{0.6, -0.3};
    const double scale = 50 / f.pixels_per_unit;
    const Vec3d under = f.eye + distance(camera) * (f.forward + (pointer.x * scale) * f.right +
                                                    (pointer.y * scale) * f.up);
    for (const double factor : {0.5, 0.9, 1.7}) {
        const Camera closer = zoomed(camera, pointer, factor, 1e-6, 1);
        EXPECT_NEAR(projected(closer, under).x, pointer.x, 1e-9);
        EXPECT_NEAR(projected(closer, under).y, pointer.y, 1e-9);
        EXPECT_NEAR(distance(closer), factor * distance(camera), 1e-9);
    }
}

TEST(trackball, zooming_goes_through_the_volume_and_out_behind) {
    Camera camera = some_camera();
    const Vec3d forward = normalized(camera.look_at - camera.eye);
    for (int n = 0; n < 400; ++n) camera = zoomed(camera, {}, 0.85, 0.2, 1);
    EXPECT_GT(dot(camera.eye - kBox.center(), forward), kBox.radius());
    EXPECT_NO_THROW(frame_of(camera, 10, 10));
}

TEST(trackball, rolling_turns_the_picture_clockwise) {
    const Camera camera = some_camera();
    const CameraFrame f = frame_of(camera, 10, 10);
    const Vec3d above = camera.look_at + 0.1 * f.up;
    const Camera turned = rolled(camera, std::numbers::pi / 2);
    EXPECT_GT(projected(turned, above).x, 0);  // what was above is right
    EXPECT_NEAR(projected(turned, above).y, 0, 1e-9);
    EXPECT_EQ(turned.eye, camera.eye);
}

TEST(trackball, looking_around_keeps_the_eye) {
    const Camera camera = some_camera();
    const Camera right = looked_around(camera, 0.3, 0);
    EXPECT_EQ(right.eye, camera.eye);
    EXPECT_LT(projected(right, camera.look_at).x, 0);  // what was ahead is left
    EXPECT_LT(projected(looked_around(camera, 0, 0.3), camera.look_at).y, 0);
}

TEST(trackball, fitting_shows_all_corners_and_fills_the_picture) {
    for (const double aspect : {0.5, 1.0, 1.6}) {
        const Camera camera = fitted(some_camera(), kBox, aspect);
        double reach = 0;
        for (int corner = 0; corner < 8; ++corner) {
            const ScreenPoint p = projected(camera, {corner & 1 ? kBox.lower.x : kBox.upper.x,
                                                     corner & 2 ? kBox.lower.y : kBox.upper.y,
                                                     corner & 4 ? kBox.lower.z : kBox.upper.z});
            reach = std::max({reach, std::abs(p.x) / aspect, std::abs(p.y)});
        }
        EXPECT_NEAR(reach, kFitShare, 1e-9);
    }
}

TEST(trackball, named_views_look_from_their_side) {
    const Camera now = some_camera();
    const Camera y = named_view(now, "-y", kBox, 1, {0, 1, 0});
    EXPECT_LT(y.eye.y, kBox.lower.y);
    EXPECT_NEAR(y.eye.x, kBox.center().x, 1e-9);
    EXPECT_EQ(y.fov_degrees, now.fov_degrees);
    const Camera paper = named_view(now, "paper", kBox, 1, {0, 1, 0});
    expect_near(paper.eye, paper_view(kBox).eye, 1e-12);
    EXPECT_THROW(named_view(now, "+w", kBox, 1, {0, 1, 0}), Error);
}

TEST(trackball, parallel_rays_keep_the_size_of_what_is_looked_at) {
    constexpr double kAspect = 1.5;
    const Camera camera = some_camera();
    const Camera parallel = with_projection(camera, true, kAspect);
    const double pixels = frame_of(camera, 150, 100).pixels_at(distance(camera));
    EXPECT_NEAR(frame_of(parallel, 150, 100).pixels_per_unit, pixels, 1e-9);
    const Camera back = with_projection(parallel, false, kAspect);
    expect_near(back.eye, camera.eye, 1e-9);
    EXPECT_FALSE(back.orthographic());
}

TEST(trackball, an_orthographic_camera_zooms_about_the_pointer_and_pans) {
    constexpr double kAspect = 1.5;
    const Camera camera = with_projection(some_camera(), true, kAspect);
    const CameraFrame f = frame_of(camera, 150, 100);
    const double half = 0.5 * camera.orthographic_width / kAspect;
    const ScreenPoint pointer{0.6, -0.3};
    const Vec3d under = camera.eye + half * (pointer.x * f.right + pointer.y * f.up);
    const Camera closer = zoomed(camera, pointer, 0.5, 1e-6, kAspect);
    EXPECT_EQ(closer.orthographic_width, 0.5 * camera.orthographic_width);
    expect_near(closer.eye + 0.5 * half * (pointer.x * f.right + pointer.y * f.up), under, 1e-9);
    const Camera moved = panned(camera, {0, 0}, {0.5, 0}, kAspect);
    EXPECT_NEAR(dot(moved.eye - camera.eye, f.right), -0.5 * half, 1e-9);
}

TEST(trackball, a_dragged_light_lies_where_the_pointer_is) {
    const Camera camera = some_camera();
    const CameraFrame frame = frame_of(camera, 1, 1);
    for (const bool of_camera : {false, true}) {
        DirectionalLight light{{}, of_camera, 0.5};
        EXPECT_EQ(light_place(light, camera).x, 0);
        ScreenPoint at{0, 0};
        for (const ScreenPoint by : {ScreenPoint{0.3, 0.1}, {-0.6, 0.2}, {0.1, -0.7}}) {
            light = dragged(light, camera, by);
            at = {at.x + by.x, at.y + by.y};
            EXPECT_NEAR(light_place(light, camera).x, at.x, 1e-9);
            EXPECT_NEAR(light_place(light, camera).y, at.y, 1e-9);
            EXPECT_NEAR(length(light.towards), 1, 1e-12);
        }
        // Half of the way to the rim is beside the data; the rim is behind.
        light = dragged(light, camera, {0.5 * kLightRim - at.x, -at.y});
        expect_near(light.towards, of_camera ? Vec3d{1, 0, 0} : frame.right, 1e-9);
        light = dragged(light, camera, {2, 0});
        expect_near(light.towards, of_camera ? Vec3d{0, 0, -1} : frame.forward, 1e-9);
        EXPECT_EQ(light.strength, 0.5);
    }
}

}  // namespace vog::test
