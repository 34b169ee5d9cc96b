// splat.cpp: object order. Project every Gaussian, bin the splats to tiles, then tile by tile add
// their line integrals row by row. No sorting by depth: T is a sum.
#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "render/kernel_polynomial.h"
#include "render/ray_gaussian.h"
#include "render/splat_boxes.h"
#include "render/splat_tiles.h"
#include "vog/error.h"
#include "vog/render.h"

namespace vog {

namespace {

/// Adds one near splat: the eye may be inside it, the segment is clipped at the eye.
void add_near(const NearSplat& s, double cutoff, TilePixels& tile) {
    const int y0 = std::max(s.bounds.y0 - tile.row, 0), x0 = std::max(s.bounds.x0 - tile.column, 0);
    const int y1 = std::min(s.bounds.y1 - tile.row, kTileHeight - 1);
    const int x1 = std::min(s.bounds.x1 - tile.column, kTileWidth - 1);
    for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x) {
            const Vec3d d =
                s.corner + double(tile.column + x) * s.step_x + double(tile.row + y) * s.step_y;
            const double tau = s.density * segment_integral(s.e, d, cutoff);
            tile.depth[y][x] += static_cast<float>(tau * std::sqrt(double{tile.slant2[y][x]}));
        }
}

/// The splats of one batch of Gaussians, in the order of the Gaussians.
Splats project_range(const SplatKernels& kernels, const Gaussians& gaussians,
                     const CameraFrame& frame, std::size_t first, std::size_t last) {
    constexpr std::size_t kChunk = 4096;
    const std::size_t chunks = (last - first + kChunk - 1) / kChunk;
    std::vector<Splats> parts(chunks);
    tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t n) {
        const std::size_t begin = first + n * kChunk;
        kernels.project(gaussians, begin, std::min(begin + kChunk, last), frame, parts[n]);
    });
    Splats all;
    for (const Splats& part : parts) {
        all.far.insert(all.far.end(), part.far.begin(), part.far.end());
        all.near.insert(all.near.end(), part.near.begin(), part.near.end());
    }
    return all;
}

}  // namespace

DepthImage render_splat(const Gaussians& gaussians, const Camera& camera, int width, int height,
                        const SplatOptions& options) {
    const CameraFrame frame = frame_of(camera, width, height);
    const double cutoff = gaussians.cutoff;
    const KernelPolynomial kernel = fit_kernel(cutoff);
    const SplatKernels& kernels =
        options.simd_target.empty() ? best_splat_kernels() : splat_kernels(options.simd_target);
    if (!(options.aabb_sigma >= 0 && std::isfinite(options.aabb_sigma)))
        throw Error(fmt::format("bounding boxes of {} sigma, expected a number above 0, or 0: none",
                                options.aabb_sigma));
    if (options.aabb_sigma > 0) return render_boxes(kernels, gaussians, frame, options.aabb_sigma);
    using Index = std::span<const std::uint32_t>;

    // Batches bound the memory of the projected splats, whatever the size of the model.
    constexpr std::size_t kBatch = 1 << 19;
    DepthImage image(width, height);
    for (std::size_t first = 0; first < gaussians.size(); first += kBatch) {
        const std::size_t last = std::min(first + kBatch, gaussians.size());
        const Splats batch = project_range(kernels, gaussians, frame, first, last);
        add_splats(batch.far, frame, image,
                   [&](const FarSplat* splats, Index index, TilePixels& tile) {
                       kernels.add_far(splats, index.data(), index.size(), kernel, tile);
                   });
        add_splats(batch.near, frame, image,
                   [&](const NearSplat* splats, Index index, TilePixels& tile) {
                       for (const std::uint32_t n : index) add_near(splats[n], cutoff, tile);
                   });
        if (options.progress)
            options.progress(static_cast<double>(last) / static_cast<double>(gaussians.size()));
    }
    return image;
}

}  // namespace vog
