// gpu_upload_test.cpp: Pictures of GPU renderers in the window, through a buffer that CUDA and OpenGL share, and through host
// memory: the same bits.
#include <chrono>
#include <thread>

#include "render/gpu/chords/gpu_pictures.h"
#include "render/gpu/gpu.h"
#include "session/picture.h"
#include "session/session.h"
#include "support/emulated_gpu.h"
#include "viewer/field_model.h"
#include "viewer/headless.h"

namespace vog::test {

using namespace viewer;

class gpu_upload : public headless {
  protected:
    void SetUp() override {
        headless::SetUp();
        if (IsSkipped()) return;
        if (emulated_gpus().empty())
            GTEST_SKIP() << "needs a GPU, or a build with VOG_EMULATED_GPU";
        share_gl(true, true);
        key_.model = warm_gaussians();
        key_.camera = orbit_view(view_box(*key_.model), {});
        key_.size = {40, 30};
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
    static std::vector<Drawn> all_drawn() {
        using Kind = Drawn::Kind;
        std::vector<Drawn> all;
        const auto add = [&](Kind kind, const FieldChoice& field, bool clipped) {
            Drawn& drawn = all.emplace_back();
            drawn.kind = kind, drawn.field = field, drawn.slabs = 8;
            if (kind == Kind::light)
                drawn.transfer = std::make_shared<ValueTransfer>(window_transfer(5, 6, 0.5));
            if (clipped) drawn.look.clip.planes.push_back({{1, 0, 0}, 0});
        };
        add(Kind::depth, {}, false);
        add(Kind::light, {"heat", FieldPart::value}, false);
        add(Kind::depth, {}, true);
        add(Kind::field, {"wind", FieldPart::view}, false);
        add(Kind::field, {"wind", FieldPart::magnitude}, true);
        add(Kind::maximum, {"heat", FieldPart::value}, false);
        return all;
    }

    PictureKey key_;
};

// One picture and one buffer of OpenGL, through changes of renderer, quantity, size and rays a pixel.
TEST_F(gpu_upload, shared_pictures_are_the_copied_ones_bit_for_bit) {
    GlRenderers sharing, copying;
    ProgressivePicture shared, copied;
    share_gl(false, true);
    ASSERT_FALSE(copying.gpu.stays_on_gpu());
    share_gl(true, true);
    ASSERT_TRUE(sharing.gpu.stays_on_gpu());
    int picture = 0;
    for (const EmulatedGpu& gpu : emulated_gpus()) {
        if (gpu.name == "optix_strict") continue;
        gpu.prepare();
        key_.renderer =
            gpu.renderer == Renderer::cuda ? WindowRenderer::cuda : WindowRenderer::optix;
        for (const Drawn& drawn : all_drawn()) {
            SCOPED_TRACE(gpu.name + " " + std::to_string(picture));
            key_.drawn = drawn;
            key_.size = std::vector<PixelSize>{{40, 30}, {57, 23}, {16, 16}}[picture % 3];
            const int subframes = picture++ % 2 ? 1 : 4;
            EXPECT_EQ(complete(shared, key_, subframes, sharing), "");
            EXPECT_EQ(complete(copied, key_, subframes, copying), "");
            EXPECT_STREQ(shared.way(), "shared");
            EXPECT_STREQ(copied.way(), "copied");
            EXPECT_EQ(shared.subframes(), subframes);
            const SumImage here = shared.read(), expected = copied.read();
            ASSERT_EQ(here.width, key_.size.width);
            ASSERT_EQ(here.channels, drawn.channels());
            ASSERT_GT(largest_column(expected), 0);
            // Sums of slabs by OptiX are rounded in the order of traversal.
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
        key_.camera = orbited(key_.camera, 0.1, 0.02);
        shared.update(key_, 1, sharing);
        std::this_thread::sleep_for(std::chrono::milliseconds(n % 7));
    }
    EXPECT_EQ(complete(shared, key_, 1, sharing), "");
    share_gl(false, true);
    GlRenderers copying;
    ProgressivePicture copied;
    EXPECT_EQ(complete(copied, key_, 1, copying), "");
    EXPECT_EQ(shared.read().value, copied.read().value);
}

TEST_F(gpu_upload, a_buffer_that_cannot_be_shared_is_reported_once_and_pictures_are_copied) {
    GlRenderers gl;
    ProgressivePicture picture, other;
    ASSERT_TRUE(gl.gpu.stays_on_gpu());
    share_gl(true, false);
    key_.renderer = WindowRenderer::cuda;
    const std::string errors = complete(picture, key_, 4, gl);
    EXPECT_EQ(errors,
              "pictures come through host memory: cuda: registering a buffer of OpenGL: mapping of "
              "buffer object failed\n");
    EXPECT_STREQ(picture.way(), "copied");
    EXPECT_EQ(complete(other, key_, 4, gl), "");
    EXPECT_STREQ(other.way(), "copied");
    EXPECT_EQ(picture.read().value, other.read().value);
    EXPECT_GT(largest_column(other.read()), 0);
}

TEST_F(gpu_upload, sums_in_gpu_memory_are_the_pictures_of_the_renderers) {
    const Gaussians& model = *key_.model;
    GpuSums sums;
    CudaSplat cuda(model);
    cuda.render(key_.camera, {40, 30}, sums);
    EXPECT_EQ(sums.fetch(), cuda.render(key_.camera, 40, 30).depth);
    OptixModel optix(model);
    optix.render(key_.camera, {20, 10, 2}, sums);
    EXPECT_EQ(sums.fetch(), optix.render(key_.camera, 20, 10, {}, nullptr, 2).depth);
    EXPECT_EQ(sums.width(), 20);
    // Without Gaussians nothing is left of the picture before.
    CudaSplat(Gaussians{}).render(key_.camera, {40, 30}, sums);
    EXPECT_EQ(sums.fetch(), std::vector<float>(1200));
    OptixModel(Gaussians{}).render(key_.camera, {4, 3}, sums);
    EXPECT_EQ(sums.fetch(), std::vector<float>(12));
    for (const SumsSize& size : {SumsSize{4, 3, 0}, {4, 3, 65}, {0, 3, 1}}) {
        EXPECT_THROW(cuda.render(key_.camera, size, sums), Error);
        EXPECT_THROW(optix.render(key_.camera, size, sums), Error);
        EXPECT_THROW(GpuPictures(Renderer::cuda, model).depth(key_.camera, size, sums), Error);
    }
}

}  // namespace vog::test
