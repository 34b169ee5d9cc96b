// exposure_test.cpp: default pictures of T and of volumes are neither dark nor burnt out.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>

#include "render/reference/reference.h"
#include "support/data.h"
#include "vog/exposure.h"
#include "vog/picture.h"
#include "vog/sample.h"
#include "vog/volume_io.h"

namespace vog::test {

namespace {

/// Share of pixels that show anything, and their mean luminance on black, [0, 1].
struct Exposure {
    double coverage = 0, luminance = 0;
};

Exposure exposure_of(const VolumeImage& image) {
    constexpr float kVisible = 0.02f;
    double covered = 0, sum = 0;
    for (const Rgba& c : image.pixel)
        if (c.a > kVisible) ++covered, sum += double{0.2126f * c.r + 0.7152f * c.g + 0.0722f * c.b};
    return {covered / double(image.pixel.size()), sum / covered};
}

/// The same of T at its default extinction, drawn without a background.
Exposure exposure_of_depth(const Volume& volume, const Camera& camera, int size) {
    PictureRequest request;
    request.camera = camera;
    request.width = request.height = size;
    request.shading.background = {0, 0, 0, 0};
    VolumeImage light{size, size, {}};
    light.pixel = render(scene_of(volume), request).image.pixel;
    for (Rgba& c : light.pixel) c = {c.a * c.r, c.a * c.g, c.a * c.b, c.a};
    return exposure_of(light);
}

/// Draws volumes by default from three sides, and checks the mean luminance.
void expect_exposed(const std::string& name, std::span<const Volume> volumes) {
    std::vector<VoxelField> own;
    Box box;
    for (const Volume& volume : volumes) {
        own.push_back(measure_field(volume, "density"));
        box.include(world_box(volume));
    }
    TransferRequest request;
    request.points = transfer_points(kDefaultMap);
    const ChosenTransfer chosen = choose_transfer(request, value_data(volumes, own, box));
    for (const char* view : {"paper", "+x", "-y"}) {
        constexpr int kSize = 96;
        Orbit orbit;
        set_view(orbit, view);
        const Exposure exposure = exposure_of(render_volume_reference(
            volumes, own, chosen.transfer, orbit_view(box, orbit, 1), kSize, kSize));
        std::cout << fmt::format(
            "{} {}: {} from {:.3g} to {:.3g}, coverage {:.3f}, luminance {:.3f}\n", name, view,
            chosen.scale.kind == ColorScale::Kind::log ? "log" : "linear", chosen.scale.low,
            chosen.scale.high, exposure.coverage, exposure.luminance);
        EXPECT_GT(exposure.luminance, 0.35) << name << " " << view;
        EXPECT_LT(exposure.luminance, 0.65) << name << " " << view;
        const Exposure depth = exposure_of_depth(volumes.front(), orbit_view(box, orbit, 1), kSize);
        std::cout << fmt::format("{} {}: T, luminance {:.3f}\n", name, view, depth.luminance);
        EXPECT_GT(depth.luminance, 0.37) << name << " " << view;
        EXPECT_LT(depth.luminance, 0.6) << name << " " << view;
    }
}

/// Depths from 0 to 4 in rows, whose 99th percentile is 4; a power above 1: most of them are faint.
DepthImage powers(double power) {
    DepthImage image(32, 32);
    for (std::size_t n = 0; n < image.depth.size(); ++n)
        image.depth[n] = 4 * static_cast<float>(std::pow(static_cast<double>(n % 32) / 31, power));
    return image;
}

}  // namespace

TEST(exposure, extinctions_are_the_nearest_in_the_middle) {
    // One depth is bright at a quarter of the usual extinction, too. The image's own extinction does not count.
    for (const float own : {1.0f, 2.0f}) {
        DepthImage image(4, 4);
        std::ranges::fill(image.depth, own);
        image.extinction = double{own};
        EXPECT_NEAR(picture_extinction(image), 1, 1e-6);
    }
    EXPECT_EQ(picture_extinction(DepthImage(4, 4)), 1);
    const double bright = picture_extinction(powers(1)), faint = picture_extinction(powers(16));
    EXPECT_GT(bright, 0.25);
    EXPECT_LT(bright, 0.6);
    EXPECT_GT(faint, 1.1);
    EXPECT_LE(faint, 4);
    EXPECT_EQ(picture_extinction(powers(3)), 1) << "in the middle already";
    DepthImage wrong(2, 2);
    wrong.depth[1] = -1;
    EXPECT_THROW((void)picture_extinction(wrong), Error);
}

TEST(exposure, samples_have_a_luminance_in_the_middle) {
    const SampleOptions options{.size = 64};
    const Volume cloud = sample_cloud(options), explosion = sample_explosion(options),
                 head = sample_head(options);
    expect_exposed("cloud", {&cloud, 1});
    expect_exposed("explosion", {&explosion, 1});
    expect_exposed("head", {&head, 1});
}

TEST(exposure, real_data_have_a_luminance_in_the_middle) {
    for (const auto& [file, grid] : {std::pair{"smoke.vdb", "density"},
                                     {"cloud.vdb", "density"},
                                     {"fire.vdb", "temperature"},
                                     {"aquarius.vdb", "density"},
                                     {"beetle.vdb", "density"},
                                     {"plume/plume_0030.vdb", "density"}}) {
        VOG_NEEDS_DATA(file);
        VdbOptions options;
        options.grid = grid;
        const Volume volume = read_volume(data_dir() / file, options);
        expect_exposed(file, {&volume, 1});
    }
}

}  // namespace vog::test
