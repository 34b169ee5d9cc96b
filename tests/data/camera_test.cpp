// camera_test.cpp: rays of pixels, the paper view, refused cameras.
#include "vog/camera.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/refused_files.h"
#include "vog/error.h"

namespace vog::test {

namespace {

void expect_near(Vec3d a, Vec3d b, double tolerance = 1e-12) {
    for (int axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(a[axis], b[axis], tolerance) << "axis " << axis;
}

}  // namespace

TEST(camera, rays_pass_through_pixel_centres_rows_from_the_top) {
    Camera camera;  // at z = 1, looking along -z, y up
    camera.fov_degrees = 90;
    const CameraFrame frame = frame_of(camera, 4, 2);
    // Half the height has slope 1, so a pixel has slope 1; x increases to the right.
    expect_near(frame.direction(0, 0), {-1.5, 0.5, -1});
    expect_near(frame.direction(3, 1), {1.5, -0.5, -1});
    EXPECT_NEAR(frame.pixels_per_unit, 1, 1e-12);
}

TEST(camera, paper_view_stands_where_the_design_says) {
    const Box box{{-1, -2, -2}, {1, 2, 2}};  // radius 3
    const Camera camera = paper_view(box);
    expect_near(camera.eye, 9.0 * Vec3d{std::cos(0.35) * std::cos(0.6), std::sin(0.35),
                                        std::cos(0.35) * std::sin(0.6)});
    expect_near(camera.look_at, {0, 0, 0});
    EXPECT_NEAR(std::tan(camera.fov_degrees * std::acos(-1.0) / 360), 0.35, 1e-8);
}

TEST(camera, straight_down_and_a_point_still_have_a_view) {
    EXPECT_NO_THROW(frame_of(orbit_view(Box{{0, 0, 0}, {1, 1, 1}}, {0, 90, 3, 40}), 8, 8));
    EXPECT_NO_THROW(frame_of(paper_view({{5, 5, 5}, {5, 5, 5}}), 8, 8));
    EXPECT_NO_THROW(frame_of(paper_view(Box{}), 8, 8));
}

TEST(camera, an_orthographic_cameras_rays_are_parallel) {
    Camera camera;  // at z = 1, looking along -z, y up
    camera.orthographic_width = 8;
    const CameraFrame frame = frame_of(camera, 4, 2);
    expect_near(frame.direction(0, 0), {0, 0, -1});
    expect_near(frame.direction(3, 1), {0, 0, -1});
    expect_near(frame.origin(0, 0), {-3, 1, 1});
    expect_near(frame.origin(3, 1), {3, -1, 1});
    EXPECT_NEAR(frame.pixels_per_unit, 0.5, 1e-12);
    EXPECT_EQ(frame.pixels_at(7), frame.pixels_per_unit);
}

TEST(camera, orbits_are_measured_in_degrees_about_up) {
    const Box box{{-1, -2, -2}, {1, 2, 2}};  // radius 3
    const auto eye = [&](double azimuth, double elevation, Vec3d up) {
        return orbit_view(box, {azimuth, elevation, 1, 40, up}).eye;
    };
    expect_near(eye(0, 0, {0, 1, 0}), {3, 0, 0});
    expect_near(eye(90, 0, {0, 1, 0}), {0, 0, 3});
    expect_near(eye(0, 90, {0, 1, 0}), {0, 3, 0});
    expect_near(eye(0, 0, {0, 0, 2}), {3, 0, 0});
    expect_near(eye(90, 0, {0, 0, 2}), {0, -3, 0});
    expect_near(eye(10, 90, {0, 0, 2}), {0, 0, 3});
    expect_near(eye(90, 0, {0, -1, 0}), {0, 0, -3});
    // Turning data and up together leaves the picture: the frames are rotations of each other.
    for (const Vec3d up : {Vec3d{1, 0, 0}, Vec3d{0, 0, 1}, Vec3d{1, 2, -0.5}}) {
        const CameraFrame y = frame_of(orbit_view(box, {25, 35, 1, 40}), 8, 8);
        const CameraFrame turned = frame_of(orbit_view(box, {25, 35, 1, 40, up}), 8, 8);
        EXPECT_NEAR(dot(turned.forward, normalized(up)), y.forward.y, 1e-12);
        EXPECT_NEAR(dot(turned.up, normalized(up)), y.up.y, 1e-12);
        EXPECT_NEAR(dot(turned.right, normalized(up)), 0, 1e-12);
    }
}

TEST(camera, named_views_look_from_their_axis) {
    const Box box{{-1, -2, -2}, {1, 2, 2}};
    for (const Vec3d up : {Vec3d{0, 1, 0}, Vec3d{0, 0, 1}, Vec3d{1, 1, 0}})
        for (const char* name : view_names()) {
            if (name[0] == 'p') continue;
            Orbit orbit;
            orbit.up = up;
            set_view(orbit, name);
            const Vec3d eye = normalized(orbit_view(box, orbit).eye);
            Vec3d axis;
            axis[name[1] - 'x'] = name[0] == '+' ? 1 : -1;
            expect_near(eye, axis);
        }
    // z up from above: a map, x to the right and y upwards.
    Orbit above;
    above.up = {0, 0, 1};
    set_view(above, "+z");
    const CameraFrame frame = frame_of(orbit_view(box, above), 8, 8);
    expect_near(frame.right, {1, 0, 0});
    expect_near(frame.up, {0, 1, 0});
    EXPECT_NE(error_of([&] { set_view(above, "x"); }).find("expected one of paper, +x"),
              std::string::npos);
}

TEST(camera, straight_views_are_limits_and_roll_turns_the_camera_clockwise) {
    const Box box{{-1, -2, -2}, {1, 2, 2}};
    const CameraFrame almost = frame_of(orbit_view(box, {30, 90 - 1e-5, 3, 40}), 8, 8);
    const CameraFrame straight = frame_of(orbit_view(box, {30, 90, 3, 40}), 8, 8);
    expect_near(straight.up, almost.up, 1e-6);
    Orbit orbit{0, 0, 3, 40};
    const CameraFrame level = frame_of(orbit_view(box, orbit), 8, 8);
    orbit.roll_degrees = 90;
    expect_near(frame_of(orbit_view(box, orbit), 8, 8).up, level.right);
}

TEST(camera, a_fitted_box_fills_the_image_and_no_more) {
    const Box box{{10, -2, 3}, {14, 7, 5}};
    for (const double aspect : {0.4, 1.0, 2.5})
        for (const bool orthographic : {false, true})
            for (const double azimuth : {0.0, 33.0, 145.0})
                for (const double elevation : {-90.0, -20.0, 60.0}) {
                    Orbit orbit{azimuth, elevation, 0, 35};
                    orbit.orthographic = orthographic;
                    orbit.roll_degrees = 17;
                    const int width = static_cast<int>(400 * aspect), height = 400;
                    const CameraFrame f = frame_of(orbit_view(box, orbit, aspect), width, height);
                    double share = 0;
                    for (int n = 0; n < 8; ++n) {
                        const Vec3d p =
                            Vec3d{n & 1 ? 10.0 : 14.0, n & 2 ? -2.0 : 7.0, n & 4 ? 3.0 : 5.0} -
                            f.eye;
                        const double pixels = f.pixels_at(dot(p, f.forward));
                        EXPECT_GT(pixels, 0);
                        share = std::max({share, 2 * pixels * std::abs(dot(p, f.right)) / width,
                                          2 * pixels * std::abs(dot(p, f.up)) / height});
                    }
                    EXPECT_NEAR(share, kFitShare, 1e-6);
                }
}

TEST(camera, a_fitted_hull_lies_in_the_middle_of_the_image) {
    Subject subject(Box{{0, 0, 0}, {10, 10, 10}});
    subject.content.hull = {{1, 1, 1}, {2, 1, 1}, {1, 4, 1}, {1, 1, 7}, {3, 2, 2}};
    for (const bool orthographic : {false, true})
        for (const double azimuth : {0.0, 33.0, 145.0, 260.0})
            for (const double elevation : {-90.0, -20.0, 60.0}) {
                Orbit orbit{azimuth, elevation, 0, 35};
                orbit.orthographic = orthographic;
                const Camera camera = orbit_view(subject, orbit, 1.5);
                const CameraFrame f = frame_of(camera, 600, 400);
                Box image;  // [-1, 1] to the edges
                for (const Vec3d& point : subject.content.hull) {
                    const Vec3d at = point - f.eye;
                    const double pixels = f.pixels_at(dot(at, f.forward));
                    EXPECT_GT(pixels, 0);
                    image.include(
                        Vec3d{pixels * dot(at, f.right) / 300, pixels * dot(at, f.up) / 200, 0});
                }
                const double x = image.upper.x, y = image.upper.y;
                EXPECT_NEAR(std::max(x, y), kFitShare, 1e-6);
                EXPECT_NEAR(image.lower.x, -x, 1e-6);
                EXPECT_NEAR(image.lower.y, -y, 1e-6);
                // Without moving, it fits as well.
                const CameraFrame g = frame_of(
                    fitted(Camera{camera.eye, {2, 2, 2}, camera.up, 35, camera.orthographic_width},
                           subject, 1.5, false),
                    600, 400);
                for (const Vec3d& point : subject.content.hull) {
                    const Vec3d at = point - g.eye;
                    EXPECT_LE(g.pixels_at(dot(at, g.forward)) * std::abs(dot(at, g.right)),
                              300 * kFitShare + 1e-9);
                    EXPECT_LE(g.pixels_at(dot(at, g.forward)) * std::abs(dot(at, g.up)),
                              200 * kFitShare + 1e-9);
                }
            }
}

/// The eye is near a part of the hull then, and far from others.
TEST(camera, a_fitted_hull_is_held_by_wide_views) {
    Subject subject(Box{{0, 0, 0}, {10, 10, 10}});
    subject.content.hull = {{0, 0, 0},   {0.1, 0, 0},  {0, 0.1, 0},
                            {10, 10, 9}, {10, 9.9, 9}, {3, 2, 8}};
    for (const double fov : {90.0, 120.0, 150.0, 175.0})
        for (const double azimuth : {0.0, 33.0, 145.0, 260.0}) {
            const Camera camera = orbit_view(subject, Orbit{azimuth, 20, 0, fov}, 1.5);
            const CameraFrame f = frame_of(camera, 600, 400);
            EXPECT_LT(length(f.eye - subject.box.center()), 40) << fov;
            for (const Vec3d& point : subject.content.hull) {
                const Vec3d at = point - f.eye;
                const double pixels = f.pixels_at(dot(at, f.forward));
                EXPECT_GT(pixels, 0);
                EXPECT_LT(pixels * std::abs(dot(at, f.right)), 330) << fov << ' ' << azimuth;
                EXPECT_LT(pixels * std::abs(dot(at, f.up)), 220) << fov << ' ' << azimuth;
            }
        }
}

TEST(camera, views_respect_how_the_data_stand) {
    Subject patient(Box{{-1, -2, -2}, {1, 2, 2}});
    EXPECT_EQ(first_orbit(patient).azimuth_degrees, kPaperAzimuthDegrees);
    EXPECT_EQ(orbit_view(patient).up, (Vec3d{0, 1, 0}));
    patient.content.standing = {{0, 0, 1}, {0, 1, 0}};
    const Camera camera = orbit_view(patient, first_orbit(patient));
    EXPECT_EQ(camera.up, (Vec3d{0, 0, 1}));
    expect_near(normalized(camera.eye - camera.look_at), {0, 1, 0});
    Orbit stated;
    stated.up = {1, 0, 0};
    EXPECT_EQ(orbit_view(patient, stated).up, (Vec3d{1, 0, 0}));
}

TEST(camera, orbits_out_of_range_are_refused) {
    const Box box{{-1, -2, -2}, {1, 2, 2}};
    EXPECT_NE(error_of([&] {
                  (void)orbit_view(box, {0, 91});
              }).find("elevation 91 degrees"),
              std::string::npos);
    EXPECT_THROW((void)orbit_view(box, {0, 0, -1}), Error);
    EXPECT_THROW((void)orbit_view(box, {0, 0, 3, 40, {0, NAN, 0}}), Error);
    EXPECT_THROW((void)orbit_view(box, {NAN}), Error);
}

TEST(camera, unusable_cameras_are_refused) {
    Camera camera;
    EXPECT_NE(error_of([&] { frame_of(camera, 0, 5); }).find("image size 0x5"), std::string::npos);
    EXPECT_THROW(frame_of(camera, 1 << 20, 1 << 20), Error);
    camera.look_at = camera.eye;
    EXPECT_NE(error_of([&] { frame_of(camera, 5, 5); }).find("eye and look_at"), std::string::npos);
    camera = {};
    camera.up = {0, 0, 1};
    EXPECT_NE(error_of([&] { frame_of(camera, 5, 5); }).find("parallel"), std::string::npos);
    camera = {};
    camera.fov_degrees = 180;
    EXPECT_NE(error_of([&] { frame_of(camera, 5, 5); }).find("field of view"), std::string::npos);
    camera = {};
    camera.orthographic_width = -1;
    EXPECT_NE(error_of([&] { frame_of(camera, 5, 5); }).find("orthographic width -1"),
              std::string::npos);
    camera = {};
    camera.eye.x = NAN;
    EXPECT_NE(error_of([&] { frame_of(camera, 5, 5); }).find("not finite"), std::string::npos);
}

}  // namespace vog::test
