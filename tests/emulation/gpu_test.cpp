// gpu_test.cpp: GPU renderers beyond the scenes of renderers_test: reports, lists of near Gaussians, samples,
// volumes, limits, and what is said where memory, drivers or devices fall short.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <set>

#include "emulation/emulation.h"
#include "render/gpu/gpu.h"
#include "render/reference/reference.h"
#include "support/level_volumes.h"
#include "support/refusal.h"
#include "support/scenes.h"
#include "vog/levels.h"
#include "vog/lod.h"
#include "vog/picture.h"
#include "vog/sample.h"

namespace vog::test {

using emulation::Traversal;

namespace {

/// Restores what a test sets of the emulated GPU.
class gpu : public testing::Test {
  protected:
    void TearDown() override {
        emulation::set_memory(memory_);
        emulation::set_most_primitives(most_);
        emulation::set_driver_version(driver_);
        emulation::set_traversal(Traversal::plain);
        EXPECT_EQ(emulation::allocated(), 0u) << "GPU memory that a renderer has kept";
    }

  private:
    std::size_t memory_ = emulation::memory(), most_ = emulation::most_primitives();
    int driver_ = emulation::driver_version();
};

Camera looking(Vec3d eye, Vec3d at, double fov = 60) {
    Camera camera;
    camera.eye = eye;
    camera.look_at = at;
    camera.fov_degrees = fov;
    return camera;
}

double worst(const DepthImage& a, const DepthImage& b) {
    EXPECT_EQ(a.depth.size(), b.depth.size());
    double largest = 0, difference = 0;
    for (std::size_t n = 0; n < a.depth.size(); ++n) {
        if (!std::isfinite(a.depth[n]) || !std::isfinite(b.depth[n])) return HUGE_VAL;
        largest = std::max(largest, double{b.depth[n]});
        difference = std::max(difference, std::abs(double{a.depth[n]} - double{b.depth[n]}));
    }
    EXPECT_GT(largest, 0);
    return difference / largest;
}

}  // namespace

TEST_F(gpu, entries_beyond_32_bits_are_counted_and_refused_in_one_line) {
    // 65,536 Gaussians, each over all 65,536 tiles of the picture: 2^32 entries, 0 in 32 bits.
    Gaussians model;
    for (int n = 0; n < 65536; ++n) add(model, {0, 0, 0}, {1, 1, 1}, 1);
    const Camera camera = looking({0, 0, 100}, {0, 0, 0}, 0.1);
    const std::string line = refusal([&] { (void)CudaSplat(model).render(camera, 4096, 4096); });
    EXPECT_TRUE(line.starts_with("cuda: entries of tiles take 34360 MB of GPU memory")) << line;
}

TEST_F(gpu, near_gaussians_take_one_list_and_not_one_a_tile) {
    // The eye among 100 Gaussians that its plane cuts, at 288 x 288: 324 tiles.
    const Gaussians model = random_gaussians(100, 0.3, 0.4, 5);
    CudaSplat splat(model);
    const std::size_t before = emulation::allocated();
    const Camera camera = looking({0, 0, 0}, {0, 0, -1});
    const DepthImage drawn = splat.render(camera, 288, 288);
    const std::size_t picture = 288 * 288 * sizeof(float);
    const std::size_t listed_in_every_tile = 100 * 324 * 4 * sizeof(std::uint32_t);
    EXPECT_LT(emulation::allocated() - before - picture, listed_in_every_tile / 10);
    // With the eye among them, at least half are cut by its plane: a list of 64 bytes each.
    EXPECT_GT(emulation::allocated() - before - picture, 50 * 64u);
    EXPECT_LT(worst(drawn, render_trace(trace_scene(model), camera, 288, 288)), 1e-5);
}

TEST_F(gpu, near_gaussians_beside_the_view_are_left_out_of_tiles_only_where_no_ray_meets_them) {
    for (const double width : {0.0, 1.5}) {
        const Gaussians model = random_gaussians(700, 0.005, 0.5, 6);
        Camera camera = looking({0.1, 0.2, 0.05}, {1, 0.3, 0.2}, 100);
        camera.orthographic_width = width;
        const DepthImage cuda = CudaSplat(model).render(camera, 100, 60);
        EXPECT_LT(worst(cuda, render_trace(trace_scene(model), camera, 100, 60)), 1e-5) << width;
    }
}

TEST_F(gpu, gaussians_far_below_a_pixel_and_beside_the_eye_plane_are_those_of_the_ray_tracer) {
    Gaussians model;
    // A billionth of a pixel wide, a speck of it, and one that lies a billion pixels beside the view.
    add(model, {0.2f, 0.1f, 0}, {1e-11f, 1e-11f, 1e-11f}, 1e30f);
    add(model, {-0.3f, 0.2f, 0}, {0.2f, 1e-11f, 0.1f}, 1e9f);
    add(model, {5, 0, 4 - 1e-9f}, {1e-12f, 1e-12f, 1e-12f}, 1);
    add(model, {0, -0.5f, 0}, {0.3f, 0.2f, 0.1f}, 1);
    model.origin = {0, 0, 4};
    for (Vec3f& mean : model.mean) mean.z -= 4;
    model.mean[2].z = -1e-9f;
    const Camera camera = looking({0, 0, 4}, {0, 0, 0}, 40);
    const DepthImage expected = render_trace(trace_scene(model), camera, 64, 64);
    EXPECT_LT(worst(CudaSplat(model).render(camera, 64, 64), expected), 3e-5);
    EXPECT_LT(worst(OptixModel(model).render(camera, 64, 64), expected), 1e-5);
}

TEST_F(gpu, reports_are_those_of_the_ray_tracer) {
    const Gaussians model = random_gaussians(500, 0.02, 0.2, 7);
    const Camera camera = looking({0, 0, 4}, {0, 0, 0}, 40);
    for (const Traversal mode : {Traversal::plain, Traversal::strict, Traversal::noisy}) {
        emulation::set_traversal(mode);
        OptixModel optix(model);
        for (const AnyHit anyhit : {AnyHit::accumulate, AnyHit::collect}) {
            TraceOptions options;
            options.anyhit = anyhit;
            options.hits_per_slab = 8;
            TraceReport expected, got;
            (void)render_trace(trace_scene(model), camera, 70, 50, options, &expected);
            (void)optix.render(camera, 70, 50, options, &got);
            EXPECT_EQ(got.hits, expected.hits);
            EXPECT_EQ(got.slabs, expected.slabs);
            EXPECT_EQ(got.most_slabs, expected.most_slabs);
            EXPECT_GT(got.hits, 1000u);
        }
    }
}

TEST_F(gpu, rays_stop_and_boxes_decide_as_in_the_ray_tracer) {
    const Gaussians model = random_gaussians(400, 0.05, 0.3, 8);
    const Camera camera = looking({2, 1, 3}, {0, 0, 0}, 40);
    for (const Traversal mode : {Traversal::plain, Traversal::strict, Traversal::noisy}) {
        emulation::set_traversal(mode);
        for (const double sigma : {0.0, 1.0, 2.0}) {
            const TraceSceneOptions scene{sigma, 0};
            OptixModel optix(model, scene);
            for (const double stop : {0.0, 0.001}) {
                TraceOptions options;
                options.anyhit = AnyHit::collect;
                options.hits_per_slab = 16;
                options.stop_transmittance = stop;
                options.extinction = 20;
                EXPECT_LT(worst(optix.render(camera, 40, 27, options),
                                render_trace(trace_scene(model, scene), camera, 40, 27, options)),
                          1e-6)
                    << sigma << " " << stop;
            }
        }
        OptixModel cut(model, {0, 0.1});
        EXPECT_LT(worst(cut.render(camera, 40, 27),
                        render_trace(trace_scene(model, {0, 0.1}), camera, 40, 27)),
                  1e-6);
    }
}

TEST_F(gpu, pictures_of_other_sizes_follow_each_other) {
    const Gaussians model = random_gaussians(300, 0.02, 0.2, 9);
    CudaSplat splat(model);
    OptixModel optix(model);
    for (const auto& [width, height] : {std::pair{40, 30}, {90, 70}, {17, 5}, {90, 70}}) {
        const Camera camera = looking({0, 1, 4}, {0, 0, 0}, 30 + width / 10.0);
        const DepthImage expected = render_trace(trace_scene(model), camera, width, height);
        EXPECT_LT(worst(splat.render(camera, width, height), expected), 1e-5);
        EXPECT_LT(worst(optix.render(camera, width, height), expected), 1e-6);
    }
}

TEST_F(gpu, samples_are_means_over_the_centres_of_parts_of_pixels) {
    const Gaussians model = random_gaussians(60, 0.3, 0.5, 10);
    for (const double width : {0.0, 2.0}) {
        Camera camera = looking({0, 0, 4}, {0, 0, 0}, 45);
        camera.orthographic_width = width;
        // Rays through the centres of 5 x 5 parts are those of a picture five times as wide.
        const DepthImage fine = render_trace(trace_scene(model), camera, 5 * 40, 5 * 30);
        DepthImage mean(40, 30);
        for (int y = 0; y < 5 * 30; ++y)
            for (int x = 0; x < 5 * 40; ++x) mean.at(x / 5, y / 5) += fine.at(x, y) / 25;
        TraceReport report, once;
        OptixModel optix(model);
        EXPECT_LT(worst(optix.render(camera, 40, 30, {}, &report, 5), mean), 2e-6);
        EXPECT_GT(worst(optix.render(camera, 40, 30, {}, &once), mean), 1e-3);
        EXPECT_NEAR(double(report.hits), 25.0 * double(once.hits), 2.5 * double(once.hits));
        TraceOptions collect;
        collect.anyhit = AnyHit::collect;
        collect.hits_per_slab = 4;
        (void)optix.render(camera, 40, 30, collect, &once);
        (void)optix.render(camera, 40, 30, collect, &report, 3);
        EXPECT_GT(report.slabs, 7 * once.slabs);
        EXPECT_LE(report.most_slabs, once.most_slabs + 2) << "of one ray, not of nine";
    }
    OptixModel optix(model);
    for (const int samples : {0, 65})
        EXPECT_EQ(refusal([&] {
                      (void)optix.render(looking({0, 0, 4}, {0, 0, 0}), 8, 8, {}, nullptr, samples);
                  }),
                  std::to_string(samples) + " x " + std::to_string(samples) +
                      " rays a pixel, expected 1 to 64");
}

TEST_F(gpu, samples_conserve_the_mass_of_gaussians_below_a_pixel) {
    for (const double width : {0.0, 3.0}) {
        Camera camera = looking({0, 0, 4}, {0, 0, 0}, 45);
        camera.orthographic_width = width;
        for (const double deviation : {0.002, 0.01, 0.03}) {  // 0.02 to 0.3 pixels
            const Gaussians model = random_gaussians(9, deviation, 1.01 * deviation, 11);
            const auto sum = [](const DepthImage& image) {
                double total = 0;
                for (const float t : image.depth) total += double{t};
                return total;
            };
            // The same Gaussians wider than pixels: a deviation is 1, 2.5 and 7.5.
            const int finer = deviation < 0.005 ? 50 : 25;
            const double exact =
                sum(render_trace(trace_scene(model), camera, 40 * finer, 30 * finer)) /
                (finer * finer);
            OptixModel optix(model);
            for (const int samples : {1, 2, 3, 5})
                EXPECT_NEAR(sum(optix.render(camera, 40, 30, {}, nullptr, samples)), exact,
                            0.01 * exact)
                    << deviation << " " << samples << " " << width;
        }
    }
}

TEST_F(gpu, cuts_of_a_hierarchy_are_those_of_the_splat) {
    Gaussians sorted = random_gaussians(2000, 0.002, 0.02, 72);
    const auto hierarchy = std::make_shared<const Hierarchy>(build_hierarchy(sorted));
    const auto model = std::make_shared<const Gaussians>(std::move(sorted));
    const Camera camera = looking({0, 0, 5}, {0.1, 0, 0}, 35);
    PictureRenderer renderer(scene_of(model, hierarchy));
    const DrawReport& report = renderer.report();
    PictureRequest request{.camera = camera, .width = 40, .height = 30};
    for (const double error : {0.0, 5.0}) {
        request.options = {.pixel_error = error};
        request.renderer = Renderer::splat;
        const DepthImage expected = bare_depth(renderer, request);
        const std::size_t drawn = report.cut->drawn();
        for (const Renderer by : {Renderer::cuda, Renderer::optix}) {
            request.renderer = by;
            request.options = {.pixel_error = error};
            EXPECT_LT(worst(bare_depth(renderer, request), expected), 1e-4) << error;
            ASSERT_TRUE(report.cut && report.gpu_ms);
            EXPECT_EQ(report.cut->drawn(), drawn);
            EXPECT_EQ(report.traced.has_value(), by == Renderer::optix);
            if (error > 0) {
                EXPECT_LT(report.cut->drawn(), model->size() / 2);
            }
            request.options.pixel_error = 0;
            request.options.samples = by == Renderer::optix ? 2 : 1;
            (void)bare_depth(renderer, request);
            EXPECT_EQ(report.cut->drawn(), model->size());
            // Without a largest error all Gaussians are drawn.
            request.options = {};
            (void)bare_depth(renderer, request);
            EXPECT_FALSE(report.cut);
        }
    }
}

TEST_F(gpu, volumes_have_the_references_depth) {
    Volume volume = sample_cloud({.size = 64});
    Mat3 skewed;
    skewed.row = {Vec3d{0.3, 0.1, 0}, Vec3d{-0.1, 0.5, 0.05}, Vec3d{0, 0.02, 0.2}};
    for (const bool skew : {false, true}) {
        if (skew) volume.world_from_index = {skewed, {100, -7, 3}};
        const VoxelGrid grid = voxel_grid(volume);
        const Box box = world_box(volume);
        for (const Traversal mode : {Traversal::plain, Traversal::strict, Traversal::noisy}) {
            emulation::set_traversal(mode);
            OptixVolume optix(grid.bytes());
            for (const Camera& camera :
                 {paper_view(box), looking(box.center(), box.center() + Vec3d{1, 0.2, 0.1})}) {
                const DepthImage expected = render_reference({&grid, 1}, camera, 64, 48);
                EXPECT_LT(worst(optix.render(camera, 64, 48), expected), 1e-5) << skew;
            }
            const DepthImage mean =
                render_reference({&grid, 1}, paper_view(box), 32, 32, {.samples = 3});
            EXPECT_LT(worst(optix.render(paper_view(box), 32, 32, 3), mean), 1e-5);
        }
    }
}

/// Finer levels hide coarser ones, within their masks.
TEST_F(gpu, levels_of_a_mesh_have_the_references_depth) {
    const Affine fine{{{Vec3d{0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 0.5}}}, {1.75, 1.75, 1.75}};
    Levels levels{{cube_of(8, 3, {}), cube_of(8, 0.5f, fine)}, {}};
    for (const bool masked : {false, true}) {
        if (masked) levels.masks = {cube_of(7, 1, {}), cube_of(5, 1, fine)};
        const Camera camera = paper_view(world_box(levels.volumes.front()));
        const DepthImage expected = render_reference(level_grids(levels), camera, 48, 32);
        PictureRequest request{
            .camera = camera, .width = 48, .height = 32, .renderer = Renderer::optix};
        const auto optix = [&](Overlap overlap) {
            PictureRenderer renderer(
                scene_of(std::make_shared<const VolumeSet>(VolumeSet{levels, overlap})));
            return bare_depth(renderer, request);
        };
        EXPECT_LT(worst(optix(Overlap::hide), expected), 1e-5) << masked;
        EXPECT_GT(worst(optix(Overlap::add), expected), 0.05);  // hidden voxels count there
        request.width = request.height = 16;
        request.options.samples = 3;
        const DepthImage mean =
            render_reference(level_grids(levels), camera, 16, 16, {.samples = 3});
        EXPECT_LT(worst(optix(Overlap::hide), mean), 1e-5) << masked;
    }
}

TEST_F(gpu, short_memory_is_said_in_one_line_with_the_bytes) {
    const Gaussians model = random_gaussians(1000, 0.02, 0.2, 11);
    emulation::set_memory(50'000);
    EXPECT_EQ(refusal([&] { CudaSplat splat(model); }),
              "cuda: projected Gaussians take 0 MB of GPU memory, 0 of 0 MB are free");
    EXPECT_NE(refusal([&] { OptixModel optix(model); }).find("GPU memory"), std::string::npos);
    emulation::set_memory(20'000'000);
    CudaSplat splat(model);
    EXPECT_EQ(refusal([&] {
                  (void)splat.render(looking({0, 0, 4}, {0, 0, 0}), 4000, 4000);
              }),
              "cuda: the picture take 64 MB of GPU memory, 20 of 20 MB are free");
    // After the refusal the renderer draws what fits.
    EXPECT_GT(splat.render(looking({0, 0, 4}, {0, 0, 0}), 40, 40).at(20, 20), 0);
}

TEST_F(gpu, more_primitives_than_a_hierarchy_takes_are_refused) {
    emulation::set_most_primitives(99);
    EXPECT_EQ(refusal([] { OptixModel optix(random_gaussians(100, 0.1, 0.2, 1)); }),
              "optix: 100 Gaussians, expected at most 99");
    EXPECT_EQ(refusal([] { OptixModel optix(random_gaussians(99, 0.1, 0.2, 1)); }), "no error");
}

TEST_F(gpu, drivers_that_are_missing_or_old_are_named_with_versions) {
    const Gaussians model = random_gaussians(3, 0.1, 0.2, 1);
    emulation::set_driver_version(0);
    EXPECT_EQ(refusal([&] { CudaSplat splat(model); }),
              "cuda: no NVIDIA driver (libcuda.so.1 cannot be loaded), expected a GPU and its "
              "driver");
    emulation::set_driver_version(12040);
    EXPECT_EQ(refusal([&] { OptixModel optix(model); }),
              "cuda: the NVIDIA driver is for CUDA 12.4, this build needs one for CUDA 13.0 or "
              "newer");
}

TEST_F(gpu, contexts_and_modules_are_shared_by_models_and_volumes) {
    if (!emulation::has_function_table()) GTEST_SKIP() << "built without OptiX's headers";
    const int contexts = emulation::contexts_made(), modules = emulation::modules_made();
    const VoxelGrid grid = voxel_grid(sample_cloud({.size = 64}));
    {
        OptixModel first(random_gaussians(9, 0.1, 0.2, 1)),
            second(random_gaussians(9, 0.1, 0.2, 2));
        OptixVolume volume(grid.bytes());
        EXPECT_EQ(emulation::contexts_made(), contexts + 1);
        EXPECT_EQ(emulation::modules_made(), modules + 1);
    }
    OptixModel later(random_gaussians(9, 0.1, 0.2, 3));
    EXPECT_EQ(emulation::modules_made(), modules + 2) << "ended with the last of them";
}

TEST_F(gpu, hierarchies_stay_as_they_are_where_there_is_no_memory_to_compact_them) {
    if (!emulation::has_function_table()) GTEST_SKIP() << "built without OptiX's headers";
    const Gaussians model = random_gaussians(1000, 0.02, 0.1, 4);
    const Camera camera = looking({0, 0, 4}, {0, 0, 0}, 40);
    const DepthImage expected = OptixModel(model).render(camera, 40, 30);
    std::set<std::size_t> sizes;
    for (std::size_t limit = 100'000; limit < 700'000; limit += 10'000) {
        emulation::set_memory(limit);
        std::unique_ptr<OptixModel> optix;
        if (refusal([&] { optix = std::make_unique<OptixModel>(model); }) != "no error") continue;
        sizes.insert(emulation::allocated());
        emulation::set_memory(10'000'000);
        EXPECT_EQ(optix->render(camera, 40, 30).depth, expected.depth) << limit;
    }
    EXPECT_EQ(sizes.size(), 2u) << "with and without compaction";
}

TEST_F(gpu, debugging_asks_optix_for_validation_and_messages) {
    if (!emulation::has_function_table()) GTEST_SKIP() << "built without OptiX's headers";
    const auto messages = [] {
        testing::internal::CaptureStderr();
        OptixModel optix(random_gaussians(9, 0.1, 0.2, 1));
        return testing::internal::GetCapturedStderr();
    };
    EXPECT_EQ(messages(), "");
    setenv("VOG_OPTIX_DEBUG", "1", 1);
    EXPECT_EQ(messages(), "optix: [4] EMULATION: context with validation\n");
    unsetenv("VOG_OPTIX_DEBUG");
}

}  // namespace vog::test
