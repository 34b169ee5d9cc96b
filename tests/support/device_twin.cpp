// device_twin.cpp: steps of cuda_splat.cu without a GPU: projection, then pixels of its tiles.
#include "support/device_twin.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "render/gpu/cuda_model.h"
#include "render/trace/trace_model.h"

namespace vog::test {

using namespace vog::gpu;
using namespace vog::trace;

DepthImage render_tile_splat_twin(const Gaussians& gaussians, const Camera& camera, int width,
                                  int height) {
    const CudaModel model = cuda_model(gaussians, 0);
    const device::Camera frame =
        scene_camera(relative_to(frame_of(camera, width, height), model.origin), model.unit);
    DepthImage image(width, height);
    const device::Kernel& kernel = model.kernel.kernel;
    std::vector<double> sum(image.depth.size());
    for (const device::SplatGaussian& g : model.gaussians) {
        device::TileSplat splat;
        if (!device::project(device::source_of(g), frame, model.kernel, splat)) continue;
        // As on the GPU, tau is evaluated at every pixel of the overlapped tiles.
        const device::PixelRange tiles = device::tiles_of(splat.pixels);
        constexpr int kTile = device::kSplatTile;
        for (int y = kTile * tiles.y0; y < std::min(kTile * (tiles.y1 + 1), height); ++y)
            for (int x = kTile * tiles.x0; x < std::min(kTile * (tiles.x1 + 1), width); ++x) {
                const device::Double3 d =
                    frame.corner + double(x) * frame.step_x + double(y) * frame.step_y;
                const auto slant = static_cast<float>(std::sqrt(device::dot(d, d)));
                const float tau =
                    splat.near ? device::near_depth(device::whitened(g),
                                                    device::whole_ray(frame, x, y), kernel.cutoff2)
                               : slant * device::far_depth(splat, kernel, x, y);
                sum[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                    static_cast<std::size_t>(x)] += double{tau};
            }
    }
    for (std::size_t n = 0; n < sum.size(); ++n) image.depth[n] = static_cast<float>(sum[n]);
    return image;
}

}  // namespace vog::test
