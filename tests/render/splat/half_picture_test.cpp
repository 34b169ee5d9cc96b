// half_picture_test.cpp: pictures whose pixels lie between those at half the resolution.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "render/splat/pyramid/half_picture.h"
#include "render/splat/volume/slab_picture.h"
#include "render/splat/volume/volume_splat.h"
#include "support/field_models.h"
#include "support/model_psnr.h"

namespace vog {

using namespace splat;
using namespace test;

namespace {

Camera towards(Vec3d eye, bool orthographic) {
    Camera camera;
    camera.eye = eye;
    camera.look_at = {0.5, 0.5, 0.5};
    camera.up = {0, 1, 0};
    camera.fov_degrees = 40;
    if (orthographic) camera.orthographic_width = 1.6;
    return camera;
}

/// A picture at half the resolution of one of f(column, row), and that one filled from it.
template <class F>
VolumeImage filled(int width, int height, const F& f, CellRows& drawn) {
    CameraFrame frame;
    frame.width = width, frame.height = height;
    const CameraFrame half = half_frame(frame);
    VolumeImage samples{half.width, half.height, {}}, picture{width, height, {}};
    for (int y = 0; y < half.height; ++y)
        for (int x = 0; x < half.width; ++x) {
            const double at = f(2 * (x - kHalfMargin), 2 * (y - kHalfMargin));
            const auto v = static_cast<float>(at);
            samples.pixel.push_back({v, 0.5f * v, 1 - v, v});
        }
    picture.pixel.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    drawn = fill_from_half(samples, 0.01, picture);
    return picture;
}

double largest_difference(const VolumeImage& a, const VolumeImage& b) {
    double most = 0;
    for (std::size_t n = 0; n < a.pixel.size(); ++n) {
        const Rgba &p = a.pixel[n], &q = b.pixel[n];
        for (const float d : {p.r - q.r, p.g - q.g, p.b - q.b, p.a - q.a})
            most = std::max(most, std::abs(double{d}));
    }
    return most;
}

}  // namespace

TEST(half_picture, rays_are_those_of_every_second_pixel) {
    for (const bool orthographic : {false, true})
        for (const auto& [width, height] : {std::pair{64, 33}, {17, 40}, {1, 1}}) {
            const CameraFrame frame = frame_of(towards({3, 2, 5}, orthographic), width, height);
            const CameraFrame half = half_frame(frame), quarter = half_frame(half);
            const AxisPixel axis = axis_pixel(frame), of_half = axis_pixel(half);
            EXPECT_EQ(axis.column, 0.5 * (width - 1));
            EXPECT_EQ(axis.row, 0.5 * (height - 1));
            EXPECT_EQ(of_half.column, 0.5 * axis.column + kHalfMargin);
            EXPECT_EQ(of_half.row, 0.5 * axis.row + kHalfMargin);
            EXPECT_EQ(axis_pixel(quarter).row, 0.5 * of_half.row + kHalfMargin);
            const Vec3d moved = half.direction(5, 4) - frame.direction(8, 6);
            const Vec3d shifted = half.origin(5, 4) - frame.origin(8, 6);
            EXPECT_LT(length(moved) + length(shifted), 1e-12);
        }
}

/// Cubics are exact, at the edges, too.
TEST(half_picture, smooth_pixels_are_interpolated) {
    for (const auto& [width, height] : {std::pair{70, 51}, {33, 64}, {2, 3}}) {
        const auto f = [](int x, int y) {
            const double u = 0.012 * x - 0.4, v = 0.013 * y - 0.3;
            return 0.5 + 0.4 * u - 0.3 * v + u * u * v - 0.5 * v * v * v;
        };
        CellRows drawn(width, height);
        const VolumeImage picture = filled(width, height, f, drawn);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                const auto n = static_cast<std::size_t>(y * width + x);
                EXPECT_NEAR(picture.pixel[n].a, f(x, y), 1e-6);
                EXPECT_EQ(drawn.of(x, y), 0u);
            }
    }
}

TEST(half_picture, rows_beside_an_edge_are_drawn) {
    const auto f = [](int x, int y) { return x > 60 && y > 45 ? 0.9 : 0.2; };
    CellRows drawn(128, 96);
    const VolumeImage picture = filled(128, 96, f, drawn);
    int rows = 0;
    for (int y = 0; y < 96; ++y)
        for (int x = 0; x < 128; ++x) {
            const bool is_drawn = (drawn.of(x, y) >> (y % kCellHeight) & 1) != 0;
            rows += is_drawn && x % kCellWidth == 0;
            const auto n = static_cast<std::size_t>(y * 128 + x);
            if (is_drawn) continue;
            EXPECT_NEAR(picture.pixel[n].a, f(x, y), 0.01) << x << " " << y;
        }
    EXPECT_GT(rows, 50);
    EXPECT_LT(rows, 300);  // of 768
}

TEST(half_picture, volumes_are_as_near_as_is_asked) {
    const Gaussians model = cloud_of_values();
    const ScalarField& field = model.fields.scalar.front();
    VolumeLook lit, cut;
    lit.light = true;
    cut.clip.planes.push_back({{1, 0.2, 0.1}, 0.6});
    for (const VolumeLook& look : {VolumeLook{}, lit, cut})
        for (const Camera& camera : {towards({3, 2, 1.5}, false), towards({0.9, 0.6, 0.5}, false),
                                     towards({3, 2, 1.5}, true)}) {
            SlabOptions options;
            options.look = look;
            const auto drawn = [&](double precision) {
                options.precision = precision;
                return render_volume_splat(model, field.name, rainbow(field), camera, 301, 200,
                                           options);
            };
            const VolumeImage exact = drawn(0), fine = drawn(1 / 1024.0), usual = drawn(1 / 200.0);
            EXPECT_GT(psnr(usual, exact), 58);  // of fields at random; of smoke 62 dB
            EXPECT_LT(largest_difference(usual, exact), 0.05);
            EXPECT_GT(psnr(fine, exact), 70);
            EXPECT_LT(largest_difference(fine, exact), 0.01);
            // Some are interpolated, not only hidden.
            EXPECT_GT(largest_difference(usual, exact), 1 / 1600.0);
        }
}

/// Where most pixels would be drawn again, a picture of half the resolution only adds to the work.
TEST(half_picture, half_the_resolution_is_for_gaussians_of_many_pixels) {
    const auto halves = [](float half_axis) {
        FarSplat splat;
        splat.f0 = 1, splat.ax = splat.by = 1 / half_axis;
        splat.ay = 0;
        splat.bounds = {0, 99, 0, 99};
        SplatExtent extent;
        extent.add(splat);
        return extent.halves();
    };
    EXPECT_EQ(halves(1), 0);
    EXPECT_EQ(halves(7.9f), 0);
    EXPECT_EQ(halves(8.1f), 1);
    EXPECT_EQ(halves(15.9f), 1);
    EXPECT_EQ(halves(16.1f), 2);
}

/// Small Gaussians may lie between the pixels at half the resolution.
TEST(half_picture, narrow_gaussians_are_drawn) {
    Gaussians model = cloud_of_values();
    ScalarField& field = model.fields.scalar.front();
    const ValueTransfer transfer = rainbow(field);
    for (std::size_t n = 0; n < model.size(); ++n)
        if (n % 2 == 1) model.scale[n] = {0.004f, 0.004f, 0.004f}, model.density[n] *= 20;
    const Camera camera = towards({3, 2, 1.5}, false);
    SlabOptions options;
    const VolumeImage exact =
        render_volume_splat(model, field.name, transfer, camera, 240, 240, options);
    options.precision = 1 / 200.0;
    EXPECT_LT(
        largest_difference(
            render_volume_splat(model, field.name, transfer, camera, 240, 240, options), exact),
        0.05);
}

TEST(half_picture, edits_and_views_leave_no_trace) {
    const Gaussians model = cloud_of_values();
    const ScalarField& field = model.fields.scalar.front();
    ValueTransfer transfers[] = {rainbow(field), rainbow(field)};
    transfers[1].unit_distance *= 0.3;
    SlabOptions options;
    options.precision = 1 / 200.0;
    SlabRenderer renderer(model, field.name, transfers[0], options);
    for (int edit = 0; edit < 8; ++edit) {
        const Camera camera = towards({edit == 5 ? 4.0 : 3.0, 2, 1.5}, false);
        const int width = edit == 6 ? 400 : 300;
        renderer.set_transfer(transfers[edit % 2]);
        const VolumeImage expected = render_volume_splat(model, field.name, transfers[edit % 2],
                                                         camera, width, width, options);
        EXPECT_LT(largest_difference(renderer.render(camera, width, width), expected), 1e-4)
            << edit;
    }
}

}  // namespace vog
