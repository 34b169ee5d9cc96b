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
    EXPECT_NO_THROW(
        frame_of(orbit_view({{0, 0, 0}, {1, 1, 1}}, 0, std::acos(-1.0) / 2, 3, 40), 8, 8));
    EXPECT_NO_THROW(frame_of(paper_view({{5, 5, 5}, {5, 5, 5}}), 8, 8));
    EXPECT_NO_THROW(frame_of(paper_view(Box{}), 8, 8));
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
    camera.eye.x = NAN;
    EXPECT_NE(error_of([&] { frame_of(camera, 5, 5); }).find("not finite"), std::string::npos);
}

}  // namespace vog::test
