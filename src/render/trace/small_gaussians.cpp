// small_gaussians.cpp: Projection of a whole model by the device code, and splats row by row.
#include "render/trace/small_gaussians.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace vog::trace {

namespace {

constexpr std::size_t kChunk = 4096;  ///< Gaussians a task
constexpr int kBandRows = 16;         ///< rows of the image a task

struct Chunk {
    std::vector<device::TileSplat> splats;
    bool all_whole = true;  ///< every share is 1
};

}  // namespace

SmallGaussians small_gaussians(const TraceModel& model, const device::Camera& camera) {
    SmallGaussians small;
    if (model.boxed) return small;
    const std::size_t size = model.gaussians.size();
    small.shares.resize(size);
    std::vector<Chunk> chunks((size + kChunk - 1) / kChunk);
    vog::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t n) {
        Chunk& chunk = chunks[n];
        for (std::size_t i = n * kChunk; i < std::min(size, (n + 1) * kChunk); ++i) {
            device::TileSplat splat;
            const device::SplatSource source = device::source_of(model.gaussians[i]);
            const bool drawn = device::project(source, camera, model.kernel, splat);
            small.shares[i] = splat.widened ? 0.0f : splat.share;
            if (drawn && splat.widened) chunk.splats.push_back(splat);
            chunk.all_whole = chunk.all_whole && small.shares[i] == 1;
        }
    });
    bool all_whole = true;
    for (const Chunk& chunk : chunks) {
        small.splats.insert(small.splats.end(), chunk.splats.begin(), chunk.splats.end());
        all_whole = all_whole && chunk.all_whole;
    }
    if (all_whole) small.shares.clear();
    return small;
}

void draw_splats(const std::vector<device::TileSplat>& splats, const device::Kernel& kernel,
                 const device::Camera& camera, DepthImage& image) {
    if (splats.empty()) return;
    // Splats by band, in order.
    const int bands = (image.height + kBandRows - 1) / kBandRows;
    std::vector<std::vector<std::uint32_t>> of_band(static_cast<std::size_t>(bands));
    for (std::size_t n = 0; n < splats.size(); ++n)
        for (int band = splats[n].pixels.y0 / kBandRows; band <= splats[n].pixels.y1 / kBandRows;
             ++band)
            of_band[static_cast<std::size_t>(band)].push_back(static_cast<std::uint32_t>(n));
    vog::parallel_for(0, bands, [&](int band) {
        const int top = band * kBandRows, bottom = std::min(top + kBandRows, image.height) - 1;
        std::vector<double> sums(static_cast<std::size_t>(image.width) * kBandRows);
        for (const std::uint32_t n : of_band[static_cast<std::size_t>(band)]) {
            const device::TileSplat& splat = splats[n];
            for (int y = std::max(splat.pixels.y0, top); y <= std::min(splat.pixels.y1, bottom);
                 ++y) {
                double* row = sums.data() + static_cast<std::ptrdiff_t>(y - top) * image.width;
                for (int x = splat.pixels.x0; x <= splat.pixels.x1; ++x)
                    row[x] += double{device::far_depth(splat, kernel, x, y)};
            }
        }
        for (int y = top; y <= bottom; ++y)
            for (int x = 0; x < image.width; ++x) {
                const double sum =
                    sums[static_cast<std::size_t>(y - top) * static_cast<std::size_t>(image.width) +
                         static_cast<std::size_t>(x)];
                if (sum == 0) continue;
                const device::Double3 d =
                    camera.corner + double(x) * camera.step_x + double(y) * camera.step_y;
                image.at(x, y) += static_cast<float>(sum * std::sqrt(device::dot(d, d)));
            }
    });
}

}  // namespace vog::trace
