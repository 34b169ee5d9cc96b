// maximum_picture_test.cpp: maximum intensity projections of voxels and models against closed forms.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "render/reference/reference.h"
#include "render/splat/volume/volume_splat.h"
#include "render/trace/trace.h"
#include "support/made_fields.h"
#include "vog/error.h"

namespace vog::test {

namespace {

Camera along_z(double width, Vec3d middle = {}) {
    Camera camera;
    camera.eye = middle + Vec3d{0, 0, 50}, camera.look_at = middle;
    camera.orthographic_width = width;
    return camera;
}

/// One leaf, voxels of edge 1 about their indices; value(x, y, z), 0 and active where it is 0.
template <class Value>
Volume leaf_volume(const Value& value) {
    Volume volume;
    Leaf& leaf = volume.leaves.emplace_back();
    for (int n = 0; n < kLeafVoxels; ++n)
        leaf.set(n, static_cast<float>(value(n >> 6, n >> 3 & 7, n & 7)));
    return volume;
}

/// Round Gaussians on the z axis, with a field of slope 2 along z.
Gaussians row_of_planes(int count, double spacing, bool measure = false) {
    Gaussians model;
    ScalarField field;
    field.name = "heat";
    field.is_measure = measure;
    field.lower = -40, field.upper = 40;
    for (int n = 0; n < count; ++n) {
        const double z = spacing * (n - 0.5 * (count - 1));
        model.mean.push_back({0, 0, static_cast<float>(z)});
        model.scale.push_back({1, 1, 1});
        model.density.push_back(1);
        field.value.push_back(static_cast<float>(2 * z));
        field.gradient.push_back({0, 0, 2});
        field.deviation.push_back(0.5f);
        field.skewness.push_back(0);
    }
    model.fields.scalar.push_back(field);
    return model;
}

}  // namespace

TEST(maximum_picture, of_voxels_is_the_largest_on_each_ray) {
    // Largest along z in the middle, negative values and zeros among the voxels.
    const Volume volume = leaf_volume([](int x, int y, int z) { return x + 10 * y * (z == 4); });
    const Camera camera = along_z(10, {3.5, 3.5, 3.5});
    const VoxelField field = own();
    const ValueMap map = render_maximum_reference({&volume, 1}, {&field, 1}, camera, 10, 10);
    for (int row = 0; row < 10; ++row)
        for (int column = 0; column < 10; ++column) {
            const int x = column - 1, y = 8 - row;
            const float value = map.value[static_cast<std::size_t>(10 * row + column)];
            if (x < 0 || x > 7 || y < 0 || y > 7)
                EXPECT_TRUE(std::isnan(value));
            else
                EXPECT_EQ(value, static_cast<float>(x + 10 * y)) << x << ", " << y;
        }
    // Another field counts where the density is 0, too; the clip leaves z below 3.5.
    VoxelField signed_field = own();
    signed_field.component[0].leaf.resize(1);
    for (std::size_t n = 0; n < kLeafVoxels; ++n)
        signed_field.component[0].leaf[0][n] = static_cast<float>(n & 7) - 9;
    ReferenceOptions options;
    const Volume empty = leaf_volume([](int, int, int) { return 0; });
    const auto largest = [&] {
        return render_maximum_reference({&empty, 1}, {&signed_field, 1}, camera, 10, 10, options)
            .value[55];
    };
    EXPECT_EQ(largest(), -2);
    options.clip.planes.push_back({{0, 0, -1}, -3.5});
    EXPECT_EQ(largest(), -6);
    options.samples = 2;
    EXPECT_EQ(largest(), -6);
    options.clip.planes.push_back({{0, 0, 1}, 100});
    EXPECT_TRUE(std::isnan(largest()));
}

TEST(maximum_picture, of_a_plane_is_its_end) {
    // All planes are 2 z: the largest mean is at the end of the last support, and a clip sets another.
    const Gaussians model = row_of_planes(9, 1);
    const double end = 4 + double{model.cutoff};  // of the last support
    for (const bool pinhole : {false, true}) {
        Camera camera = along_z(4);
        if (pinhole) camera.orthographic_width = 0, camera.fov_degrees = 4;
        SlabOptions slabs{.slabs = 512};
        Clipping clip;
        for (const bool clipped : {false, true}) {
            if (clipped) clip.planes.push_back({{0, 0, -1}, -2.25});
            slabs.look.clip = clip;
            const ValueMap splat = render_maximum_splat(model, "heat", camera, 9, 9, slabs);
            const ValueMap trace = render_maximum_trace(model, "heat", camera, 9, 9, {}, {}, clip);
            EXPECT_NEAR(trace.value[40], clipped ? 4.5 : 2 * end, 0.2);
            for (std::size_t n = 0; n < splat.value.size(); ++n) {
                ASSERT_EQ(std::isnan(splat.value[n]), std::isnan(trace.value[n])) << n;
                // Half a step of either.
                if (std::isnan(splat.value[n])) continue;
                EXPECT_NEAR(splat.value[n], trace.value[n], 0.2);
            }
        }
    }
}

TEST(maximum_picture, of_one_value_is_that_value_for_every_target) {
    Gaussians model = row_of_planes(5, 0.7);
    std::ranges::fill(model.fields.scalar[0].gradient, Vec3f{0, 0, 0});
    std::ranges::fill(model.fields.scalar[0].value, -7.25f);
    for (const std::string& target : splat_targets()) {
        const ValueMap map = render_maximum_splat(model, "heat", along_z(9), 70, 40,
                                                  {.slabs = 8, .simd_target = target});
        int covered = 0;
        for (const float value : map.value) {
            if (std::isnan(value)) continue;
            ++covered;
            EXPECT_NEAR(value, -7.25, 1e-4) << target;
        }
        EXPECT_GT(covered, 500);
        EXPECT_TRUE(std::isnan(map.value[0]));
    }
}

TEST(maximum_picture, of_the_density_itself_is_at_most_three_times_it) {
    // A thin tail does not show the values within; the field says 30, the density at most 1.
    Gaussians model = row_of_planes(1, 1, true);
    model.fields.scalar[0].value[0] = 30;
    model.fields.scalar[0].gradient[0] = {0, 0, 0};
    model.fields.scalar[0].lower = 0;
    const Camera camera = along_z(4);
    const float splat = render_maximum_splat(model, "heat", camera, 15, 15).value[112];
    const float trace = render_maximum_trace(model, "heat", camera, 15, 15).value[112];
    EXPECT_NEAR(splat, 3, 0.05);
    EXPECT_NEAR(trace, 3, 0.05);
    model.fields.scalar[0].is_measure = false;
    EXPECT_NEAR(render_maximum_splat(model, "heat", camera, 15, 15).value[112], 30, 1e-3);
}

TEST(maximum_picture, wrong_input_throws) {
    const Gaussians model = row_of_planes(1, 1);
    EXPECT_THROW((void)render_maximum_splat(model, "none", along_z(4), 3, 3), Error);
    EXPECT_THROW((void)render_maximum_splat(model, "heat", along_z(4), 3, 3, {.slabs = 0}), Error);
    EXPECT_THROW((void)render_maximum_trace(model, "heat", along_z(4), -1, 3), Error);
    const Volume volume = leaf_volume([](int, int, int) { return 1; });
    EXPECT_THROW((void)render_maximum_reference({&volume, 1}, {}, along_z(4), 3, 3), Error);
}

}  // namespace vog::test
