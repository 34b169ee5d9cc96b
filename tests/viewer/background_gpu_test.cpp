// background_gpu_test.cpp: The window's pictures by GPU renderers, beside those of the CPU.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <memory>
#include <thread>

#include "session/background_renderer.h"
#include "support/gpus.h"
#include "viewer/field_model.h"

namespace vog::test {

using namespace viewer;
namespace {

RenderedPicture picture_of(BackgroundRenderer& background, const RenderRequest& request) {
    background.request(request);
    while (true) {
        if (std::optional<RenderedPicture> picture = background.take()) return std::move(*picture);
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
}

TEST(background_renderer, quantities_on_a_gpu_are_the_cpus) {
    if (gpus().empty()) GTEST_SKIP() << "needs a GPU, or a build with VOG_EMULATED_GPU";
    BackgroundRenderer background;
    RenderRequest request;
    PictureKey& what = request.what;
    what.model = warm_gaussians();
    const std::pair<Show, FieldChoice> pictures[] = {{Show::depth, {}},
                                                     {Show::mean, {"heat", FieldPart::value}},
                                                     {Show::mean, {"wind", FieldPart::view}},
                                                     {Show::mean, {"wind", FieldPart::y}},
                                                     {Show::mean, {"wind", FieldPart::magnitude}},
                                                     {Show::volume, {"heat", FieldPart::value}},
                                                     {Show::maximum, {"heat", FieldPart::value}}};
    for (const auto& [show, field] : pictures)
        for (const bool clipped : {false, true})
            for (const int rays : {1, 2}) {
                // Means over rays are the same code for all kinds.
                if (rays > 1 && (show == Show::volume || field.part == FieldPart::y)) continue;
                SCOPED_TRACE(std::string(word_of(show)) + (clipped ? " clipped " : " ") +
                             std::to_string(rays));
                request.rays = rays;
                PictureRequest made;
                made.show = show;
                made.camera = orbit_view(view_box(*what.model), {});
                made.width = 40, made.height = 30;
                made.slabs = 16, made.precision = 0;
                made.options.pixel_error = 0;
                if (clipped) made.options.clip.planes.push_back({{1, 0, 0}, 0});
                const ValueTransfer transfer = window_transfer(5, 6, 0.5);
                what.picture = sums_of(made, field, &transfer);
                what.renderer = WindowRenderer::splat;
                const RenderedPicture expected = picture_of(background, request);
                ASSERT_EQ(expected.error, "");
                double norm2 = 0;
                for (const float value : expected.sums.value)
                    norm2 += double{value} * double{value};
                ASSERT_GT(norm2, 0);
                for (const Gpu& gpu : gpus()) {
                    gpu.prepare();
                    what.renderer = gpu.renderer == Renderer::cuda ? WindowRenderer::cuda
                                                                   : WindowRenderer::optix;
                    const RenderedPicture shown = picture_of(background, request);
                    ASSERT_EQ(shown.error, "") << gpu.name;
                    EXPECT_EQ(shown.drawn, what.model->size());
                    ASSERT_EQ(shown.sums.width, 40);
                    ASSERT_EQ(shown.sums.value.size(), expected.sums.value.size());
                    double error2 = 0;
                    for (std::size_t n = 0; n < expected.sums.value.size(); ++n)
                        error2 += std::pow(double{shown.sums.value[n]} - expected.sums.value[n], 2);
                    // Several rays by OptiX: narrow Gaussians are as wide as the whole pixel, not a ray's part of it.
                    const bool added = rays > 1 && gpu.renderer == Renderer::optix && !clipped;
                    EXPECT_LT(std::sqrt(error2 / norm2), added ? 1e-3 : 1e-4) << gpu.name;
                }
            }
}

}  // namespace
}  // namespace vog::test
