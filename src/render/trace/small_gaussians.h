// small_gaussians.h: Gaussians smaller than a pixel in a ray tracer's picture (docs/method.md).
// A ray through a pixel's centre does not give their mean over the pixel: the thinnest are left to
// the splat, and the others count with a share that makes their sum over the pixels their mass.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/parallel.h"
#include "render/device/tile_splat.h"
#include "render/trace/trace_model.h"
#include "vog/clip.h"
#include "vog/image.h"

namespace vog::trace {

struct SmallGaussians {
    /// [N] factor on the tau of each Gaussian along rays; 0: splatted. Empty: all 1.
    std::vector<float> shares;
    std::vector<device::TileSplat> splats;  ///< of those with share 0, in the model's order
    std::vector<std::uint32_t> index;       ///< [splats] Gaussians that they are of
};

/// Finds the small Gaussians of a picture. Without effect in a boxed model: the paper's boxes are met
/// by single rays.
SmallGaussians small_gaussians(const TraceModel& model, const device::Camera& camera);
/// Leaves of every splat the share of the chord through its mean that the clip leaves.
/// clip, frame  relative to TraceModel::origin
void clip_splats(const TraceModel& model, const Clipping& clip, const CameraFrame& frame,
                 SmallGaussians& small);
/// Narrows a ray to what a clip leaves.
/// clip     relative to TraceModel::origin, world units
/// returns  false: nothing
bool clip_ray(const TraceModel& model, const Clipping& clip, device::Ray& ray);

/// Calls add(n, column, row, tau / |D|) for the pixels of every splat n: in parallel by bands of rows, within a
/// band in the order of the splats.
template <class Add>
void for_each_splat_pixel(const std::vector<device::TileSplat>& splats,
                          const device::Kernel& kernel, int height, const Add& add) {
    constexpr int kBandRows = 16;
    const int bands = (height + kBandRows - 1) / kBandRows;
    std::vector<std::vector<std::uint32_t>> of_band(static_cast<std::size_t>(bands));
    for (std::size_t n = 0; n < splats.size(); ++n)
        for (int band = splats[n].pixels.y0 / kBandRows; band <= splats[n].pixels.y1 / kBandRows;
             ++band)
            of_band[static_cast<std::size_t>(band)].push_back(static_cast<std::uint32_t>(n));
    vog::parallel_for(0, bands, [&](int band) {
        const int top = band * kBandRows, bottom = std::min(top + kBandRows, height) - 1;
        for (const std::uint32_t n : of_band[static_cast<std::size_t>(band)]) {
            const device::PixelRange& pixels = splats[n].pixels;
            for (int y = std::max(pixels.y0, top); y <= std::min(pixels.y1, bottom); ++y)
                for (int x = pixels.x0; x <= pixels.x1; ++x)
                    add(n, x, y, double{device::far_depth(splats[n], kernel, x, y)});
        }
    });
}

/// Adds the splats' T, in units of TraceModel::depth_unit, to an image; the same bytes for any number of threads.
void draw_splats(const std::vector<device::TileSplat>& splats, const device::Kernel& kernel,
                 const device::Camera& camera, DepthImage& image);

}  // namespace vog::trace
