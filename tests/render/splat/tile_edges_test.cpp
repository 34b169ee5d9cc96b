// tile_edges_test.cpp: Pictures whose width is no multiple of a tile's: what lies beside the right edge is in no
// pixel.
#include <gtest/gtest.h>

#include <algorithm>

#include "render/splat/splat.h"
#include "render/trace/trace.h"

namespace vog::test {

// 15 x 27 tiles, the last column 40 pixels wide: tasks of several tiles go from the end of one row of tiles to the
// start of the next.
TEST(splat_tiles, pass_nothing_from_the_right_edge_to_the_left) {
    Gaussians model;
    // Wide ones across the right edge, faint ones at the left.
    for (int n = 0; n < 80; ++n) {
        const bool right = n % 2 == 0;
        model.mean.push_back({right ? 1.12f + 0.007f * static_cast<float>(n % 9) : -1.0f,
                              -1 + 0.025f * static_cast<float>(n), 0});
        model.scale.push_back({0.1f, 0.1f, 0.1f});
        model.density.push_back(right ? 1.0f : 0.01f);
    }
    Camera camera;
    camera.eye = {0, 0, 3};
    camera.look_at = {0, 0, 0};
    camera.orthographic_width = 2;
    constexpr int kWidth = 936, kHeight = 860;
    const DepthImage splat = render_splat(model, camera, kWidth, kHeight);
    const DepthImage trace = render_trace(trace_scene(model), camera, kWidth, kHeight);
    const float most = *std::ranges::max_element(trace.depth);
    ASSERT_GT(most, 0);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            ASSERT_NEAR(splat.at(x, y), trace.at(x, y), 1e-4f * most) << x << " " << y;
}

}  // namespace vog::test
