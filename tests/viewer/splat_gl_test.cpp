// splat_gl_test.cpp: the OpenGL renderer against the closed form for every scene, and against the
// CPU splat for typical models.
#include "gl/splat_gl.h"

#include <algorithm>
#include <cmath>

#include "render/splat/splat.h"
#include "support/data.h"
#include "support/scenes.h"
#include "support/screen_mass.h"
#include "viewer/headless.h"
#include "vog/compare.h"
#include "vog/convert_moments.h"
#include "vog/sample.h"
#include "vog/volume_io.h"

namespace vog::test {

using viewer::render_gl;

class splat_gl : public headless {
  protected:
    /// Largest allowed difference between window and command line.
    static void expect_like_the_cpu(const Gaussians& model, const Camera& camera, int size) {
        DepthImage cpu = render_splat(model, camera, size, size);
        set_extinction(cpu, auto_extinction(cpu));
        const DepthDifference difference = compare(cpu, render_gl(model, camera, size, size));
        EXPECT_GE(difference.grey.psnr_db, 55);
        EXPECT_LE(difference.grey.largest, 2);
        EXPECT_LE(difference.relative_l2, 1e-4);
    }
    /// Views from outside, from the centre, and close to a side.
    static void expect_like_the_cpu_from_everywhere(const Gaussians& model, int size) {
        expect_like_the_cpu(model, paper_view(view_box(model)), size);
        Camera inside = paper_view(view_box(model));
        inside.eye = inside.look_at;
        inside.look_at = inside.eye + Vec3d{0.3, 0.1, -1};
        inside.fov_degrees = 75;
        expect_like_the_cpu(model, inside, size);
        expect_like_the_cpu(model, orbit_view(view_box(model), {-69, 6, 0.6, 90}), size);
    }
};

TEST_F(splat_gl, agrees_with_the_closed_form_in_every_scene) {
    for (const Scene& scene : scenes()) {
        SCOPED_TRACE(scene.name);
        const std::vector<double> exact = exact_depth(scene);
        const double largest = *std::max_element(exact.begin(), exact.end());
        const DepthImage image = render_gl(scene.model, scene.camera, scene.width, scene.height);
        double worst = 0;
        for (std::size_t n = 0; n < exact.size(); ++n) {
            ASSERT_TRUE(std::isfinite(image.depth[n])) << "pixel " << n;
            worst = std::max(worst, std::abs(image.depth[n] - exact[n]));
        }
        // Projection in single precision, where the CPU has double: twice its tolerance.
        EXPECT_LE(worst, 2 * scene.tolerance * largest);
    }
}

TEST_F(splat_gl, cloud_is_the_cpus_picture) {
    const Volume volume = sample_cloud({.size = 64});
    expect_like_the_cpu_from_everywhere(convert_moments(volume, {.block_voxels = 4}), 192);
}

TEST_F(splat_gl, real_data_have_the_cpus_picture) {
    VOG_NEEDS_DATA("smoke.vdb");
    const Volume volume = read_vdb(data_dir() / "smoke.vdb");
    expect_like_the_cpu_from_everywhere(convert_moments(volume, {.block_voxels = 8}), 192);
}

TEST_F(splat_gl, rotated_and_tiny_models_are_the_cpus_picture) {
    Gaussians model = random_gaussians(2000, 0.01, 0.15, 31);
    expect_like_the_cpu_from_everywhere(model, 160);
    for (Vec3f& scale : model.scale) scale = 0.01f * scale;  // far below a pixel
    for (float& density : model.density) density *= 100;
    expect_like_the_cpu(model, paper_view(view_box(model)), 160);
}

TEST_F(splat_gl, a_shifted_ray_sees_what_a_shifted_pixel_sees) {
    // 3x as many pixels: the ray of pixel (3c+2, 3r) passes a third of a pixel right of, and above,
    // the centre of (c, r).
    // Gaussians of two pixels and more: a pixel is the value at its centre.
    const Gaussians model = random_gaussians(300, 0.3, 0.5, 32);
    const Camera camera = paper_view(view_box(model));
    const DepthImage fine = render_gl(model, camera, 96, 96);
    const viewer::GlModel on_device(model);
    const viewer::GlSplat splat;
    const viewer::GlTarget target(GL_R32F, 32, 32);
    target.bind();
    glClearColor(0, 0, 0, 0);
    glClear(GL_COLOR_BUFFER_BIT);
    splat.add(on_device, camera, {1.0 / 3, -1.0 / 3}, target);
    const std::vector<float> shifted = target.read_floats();
    const float largest = *std::max_element(fine.depth.begin(), fine.depth.end());
    for (int row = 0; row < 32; ++row)
        for (int column = 0; column < 32; ++column)
            ASSERT_NEAR(shifted[static_cast<std::size_t>(32 * row + column)],
                        fine.at(3 * column + 2, 3 * row), 1e-4 * largest);
}

TEST_F(splat_gl, accumulating_removes_aliasing) {
    // Gaussians narrower than a pixel: one picture widens them to half a pixel, sub-frames to less.
    const Gaussians model = random_gaussians(400, 0.004, 0.012, 33);
    const Camera camera = paper_view(view_box(model));
    constexpr int kSize = 64, kFactor = 16;
    const DepthImage fine = render_splat(model, camera, kSize * kFactor, kSize * kFactor);
    DepthImage mean(kSize, kSize);
    for (int row = 0; row < kSize * kFactor; ++row)
        for (int column = 0; column < kSize * kFactor; ++column)
            mean.at(column / kFactor, row / kFactor) +=
                fine.at(column, row) / float(kFactor * kFactor);
    const double one = compare(mean, render_gl(model, camera, kSize, kSize)).relative_l2;
    const double many = compare(mean, render_gl(model, camera, kSize, kSize, 64)).relative_l2;
    EXPECT_LT(many, 0.4 * one) << "one frame " << one << ", 64 sub-frames " << many;
}

TEST_F(splat_gl, particles_keep_their_mass_at_every_size) {
    for (const int size : {64, 512})
        expect_mass_of_particles([](const auto&... scene) { return render_gl(scene...); }, size);
}

TEST_F(splat_gl, one_gaussian_keeps_its_mass_wherever_it_is) {
    expect_mass_of_one([](const auto&... scene) { return render_gl(scene...); });
}

}  // namespace vog::test
