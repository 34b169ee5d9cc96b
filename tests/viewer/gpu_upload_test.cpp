// gpu_upload_test.cpp: Pictures of GPU renderers in the window, through a buffer that CUDA and OpenGL share, and through host
// memory: the same bits.
#include <algorithm>
#include <chrono>
#include <thread>

#include "render/gpu/chords/gpu_pictures.h"
#include "render/gpu/gpu.h"
#include "session/picture.h"
#include "session/session.h"
#include "support/gpus.h"
#include "viewer/field_model.h"
#include "viewer/headless.h"

namespace vog::test {

using namespace viewer;

class gpu_upload : public headless {
  protected:
    void SetUp() override {
        headless::SetUp();
        if (IsSkipped()) return;
        if (gpus().empty()) GTEST_SKIP() << "needs a GPU, or a build with VOG_EMULATED_GPU";
        share_gl(true, true);
        if (!GpuUpload().stays_on_gpu()) GTEST_SKIP() << "no OpenGL that the GPU draws";
        key_.model = warm_gaussians();
        PictureRequest request;
        request.camera = orbit_view(view_box(*key_.model), {});
        request.width = 40, request.height = 30;
        key_.picture = sums_of(request, {});
    }
    void TearDown() override { share_gl(true, true); }

    /// Updates a picture until it is complete.
    /// returns  its errors, a line each
    static std::string complete(ProgressivePicture& picture, const PictureKey& key, int subframes,
                                GlRenderers& gl) {
        std::string errors;
        while (true) {
            picture.update(key, subframes, gl);
            if (const std::string error = picture.take_error(); !error.empty())
                errors += error + "\n";
            if (picture.complete()) return errors;
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    }
    std::vector<ResolvedPicture> pictures() const {
        std::vector<ResolvedPicture> all;
        const ValueTransfer transfer = window_transfer(5, 6, 0.5);
        const auto add = [&](Show show, const FieldChoice& field, bool clipped) {
            PictureRequest request = key_.picture.request;
            request.show = show, request.slabs = 8;
            if (clipped) request.options.clip.planes.push_back({{1, 0, 0}, 0});
            all.push_back(sums_of(request, field, &transfer));
        };
        add(Show::depth, {}, false);
        add(Show::volume, {"heat", FieldPart::value}, false);
        add(Show::depth, {}, true);
        add(Show::mean, {"wind", FieldPart::view}, false);
        add(Show::mean, {"wind", FieldPart::magnitude}, true);
        add(Show::maximum, {"heat", FieldPart::value}, false);
        return all;
    }

    PictureKey key_;
};

// One picture and one buffer of OpenGL, through changes of renderer, quantity, size and rays a pixel.
TEST_F(gpu_upload, shared_pictures_are_the_copied_ones_bit_for_bit) {
    GlRenderers sharing, copying;
    ProgressivePicture shared, copied;
    copying.gpu = GpuUpload::by_copies();
    ASSERT_TRUE(sharing.gpu.stays_on_gpu());
    int picture = 0;
    for (const Gpu& gpu : gpus()) {
        if (gpu.name == "optix_strict") continue;
        gpu.prepare();
        key_.renderer =
            gpu.renderer == Renderer::cuda ? WindowRenderer::cuda : WindowRenderer::optix;
        for (const ResolvedPicture& drawn : pictures()) {
            SCOPED_TRACE(gpu.name + " " + std::to_string(picture));
            key_.picture = drawn;
            const PixelSize size =
                std::vector<PixelSize>{{40, 30}, {57, 23}, {16, 16}}[picture % 3];
            key_.picture.request.width = size.width, key_.picture.request.height = size.height;
            const int subframes = picture++ % 2 ? 1 : 4;
            EXPECT_EQ(complete(shared, key_, subframes, sharing), "");
            EXPECT_EQ(complete(copied, key_, subframes, copying), "");
            EXPECT_STREQ(shared.way(), "shared");
            EXPECT_STREQ(copied.way(), "copied");
            EXPECT_EQ(shared.subframes(), subframes);
            const SumImage here = shared.read(), expected = copied.read();
            ASSERT_EQ(here.width, size.width);
            ASSERT_EQ(here.channels, channels_of(drawn));
            ASSERT_GT(std::ranges::max(expected.value), 0);
            // Sums of slabs by OptiX are rounded in the order of traversal, which a real GPU does not repeat.
            if (gpu.name == "optix" && is_by_value(drawn.request.show)) {
                for (std::size_t n = 0; n < here.value.size(); ++n)
                    ASSERT_NEAR(here.value[n], expected.value[n], 1e-4F);
                continue;
            }
            ASSERT_EQ(here.value, expected.value);
        }
    }
    key_.renderer = WindowRenderer::splat;
    complete(shared, key_, 1, sharing);
    EXPECT_STREQ(shared.way(), "");
}

TEST_F(gpu_upload, a_moving_camera_shows_each_picture_whole) {
    // Requests follow one another while the picture before is being uploaded: each has memory of its own.
    GlRenderers sharing;
    ProgressivePicture shared;
    key_.renderer = WindowRenderer::cuda;
    for (int n = 0; n < 30; ++n) {
        key_.picture.request.camera = orbited(key_.picture.camera(), 0.1, 0.02);
        shared.update(key_, 1, sharing);
        std::this_thread::sleep_for(std::chrono::milliseconds(n % 7));
    }
    EXPECT_EQ(complete(shared, key_, 1, sharing), "");
    GlRenderers copying;
    copying.gpu = GpuUpload::by_copies();
    ProgressivePicture copied;
    EXPECT_EQ(complete(copied, key_, 1, copying), "");
    EXPECT_EQ(shared.read().value, copied.read().value);
}

TEST_F(gpu_upload, a_buffer_that_cannot_be_shared_is_reported_once_and_pictures_are_copied) {
    GlRenderers gl;
    ProgressivePicture picture, other;
    ASSERT_TRUE(gl.gpu.stays_on_gpu());
    if (!share_gl(true, false))
        GTEST_SKIP() << "needs a build with VOG_EMULATED_GPU, whose buffers can be refused";
    key_.renderer = WindowRenderer::cuda;
    const std::string errors = complete(picture, key_, 4, gl);
    EXPECT_EQ(errors,
              "pictures come through host memory: cuda: registering a buffer of OpenGL: mapping of "
              "buffer object failed\n");
    EXPECT_STREQ(picture.way(), "copied");
    EXPECT_EQ(complete(other, key_, 4, gl), "");
    EXPECT_STREQ(other.way(), "copied");
    EXPECT_EQ(picture.read().value, other.read().value);
    EXPECT_GT(std::ranges::max(other.read().value), 0);
}

TEST_F(gpu_upload, sums_in_gpu_memory_are_the_pictures_of_the_renderers) {
    const Gaussians& model = *key_.model;
    const Camera& camera = key_.picture.camera();
    GpuSums sums;
    CudaSplat cuda(model);
    cuda.render(camera, {40, 30}, sums);
    EXPECT_EQ(sums.fetch(), cuda.render(camera, 40, 30).depth);
    OptixModel optix(model);
    optix.render(camera, {20, 10, 2}, sums);
    EXPECT_EQ(sums.fetch(), optix.render(camera, 20, 10, {}, nullptr, 2).depth);
    EXPECT_EQ(sums.width(), 20);
    // Without Gaussians nothing is left of the picture before.
    CudaSplat(Gaussians{}).render(camera, {40, 30}, sums);
    EXPECT_EQ(sums.fetch(), std::vector<float>(1200));
    OptixModel(Gaussians{}).render(camera, {4, 3}, sums);
    EXPECT_EQ(sums.fetch(), std::vector<float>(12));
    for (const SumsSize& size : {SumsSize{4, 3, 0}, {4, 3, 65}, {0, 3, 1}}) {
        EXPECT_THROW(cuda.render(camera, size, sums), Error);
        EXPECT_THROW(optix.render(camera, size, sums), Error);
        EXPECT_THROW(GpuPictures(Renderer::cuda, model).depth(camera, size, sums), Error);
    }
}

}  // namespace vog::test
