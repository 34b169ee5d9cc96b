// linear_test.cpp: quaternions, eigenvectors, affine maps and boxes.
#include "vog/linear.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/scenes.h"

namespace vog::test {

namespace {

void expect_near(const Mat3& a, const Mat3& b, double tolerance) {
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(a(r, c), b(r, c), tolerance) << r << "," << c;
}

}  // namespace

TEST(linear, quaternion_and_matrix_round_trip) {
    Random random(1);
    for (int n = 0; n < 200; ++n) {
        const Quat q = random.rotation();
        const Mat3 m = matrix_from_quat(q);
        EXPECT_NEAR(determinant(m), 1, 1e-12);
        expect_near(m * transpose(m), Mat3{}, 1e-12);
        // Float rounding of each component: 6e-8.
        expect_near(matrix_from_quat(quat_from_matrix(m)), m, 4e-7);
        EXPECT_GE(quat_from_matrix(m).w, 0);
    }
}

TEST(linear, half_turns_survive_the_quaternion) {
    for (int axis = 0; axis < 3; ++axis) {
        Mat3 m;
        for (int other = 0; other < 3; ++other) m(other, other) = other == axis ? 1 : -1;
        expect_near(matrix_from_quat(quat_from_matrix(m)), m, 1e-12);
    }
}

TEST(linear, eigenvectors_rebuild_the_matrix) {
    Random random(2);
    for (int n = 0; n < 200; ++n) {
        const Mat3 r = matrix_from_quat(random.rotation());
        const Vec3d values{random(0, 10), n % 3 == 0 ? 2.0 : random(0, 1), n % 3 == 0 ? 2.0 : 1e-6};
        Mat3 diagonal{{Vec3d{values.x, 0, 0}, Vec3d{0, values.y, 0}, Vec3d{0, 0, values.z}}};
        const Mat3 a = r * diagonal * transpose(r);
        const Eigen3 eigen = symmetric_eigen(a);
        EXPECT_GE(eigen.values.x, eigen.values.y);
        EXPECT_GE(eigen.values.y, eigen.values.z);
        EXPECT_NEAR(determinant(eigen.axes), 1, 1e-12);
        for (int k = 0; k < 3; ++k) diagonal(k, k) = eigen.values[k];
        expect_near(eigen.axes * diagonal * transpose(eigen.axes), a, 1e-13 * 30);
    }
}

TEST(linear, affine_inverse_undoes_the_map) {
    const Affine map{{{Vec3d{1, 2, 0}, Vec3d{0, 3, 1}, Vec3d{-1, 0, 2}}}, {5, -6, 7}};
    const Vec3d point{0.3, -0.2, 11};
    const Vec3d back = inverse(map)(map(point));
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(back[axis], point[axis], 1e-13);
}

TEST(linear, mapped_box_holds_all_corners) {
    const Affine turn{{{Vec3d{0, -1, 0}, Vec3d{1, 0, 0}, Vec3d{0, 0, 2}}}, {1, 1, 1}};
    const Box box = transformed(turn, {{0, 0, 0}, {1, 2, 3}});
    EXPECT_EQ(box, (Box{{-1, 1, 1}, {1, 2, 7}}));
    EXPECT_TRUE(transformed(turn, Box{}).empty());
}

}  // namespace vog::test
