// slab_maximum.cpp: Largest mean over the slabs of a band, and their sum.
#include "render/splat/volume/slab_maximum.h"

#include <algorithm>
#include <array>
#include <limits>

#include "vog/maximum_picture.h"

namespace vog::splat {

void maximum_band(SlabBand& band, const CameraFrame& frame, Rgba* image) {
    constexpr float kNothing = -std::numeric_limits<float>::infinity();
    constexpr auto kShare = static_cast<float>(kLeastDensityShare);
    const float most = band.most_share / band.thickness;
    const TileRange& pixels = band.pixels;
    for (int y = pixels.y0; y <= pixels.y1; ++y) {
        std::array<float, kTileWidth> least{}, largest;
        largest.fill(kNothing);
        const auto rows = [&](int channel, const auto& visit) {
            for (int slab = 0; slab < band.slabs; ++slab)
                if (band.touched[static_cast<std::size_t>(slab)])
                    visit(band.plane(slab, channel) + SlabBand::offset(0, y), slab);
        };
        rows(3, [&](const float* weight, int) {
            for (std::size_t x = 0; x < least.size(); ++x)
                least[x] = std::max(least[x], kShare * weight[x]);
        });
        rows(0, [&](const float* sum, int slab) {
            const float* weight = band.plane(slab, 3) + SlabBand::offset(0, y);
            for (std::size_t x = 0; x < least.size(); ++x)
                largest[x] =
                    weight[x] > 0 && weight[x] >= least[x]
                        ? std::max(largest[x], std::min(sum[x] / weight[x], most * weight[x]))
                        : largest[x];
        });
        Rgba* row = image +
                    static_cast<std::size_t>(band.row + y) * static_cast<std::size_t>(frame.width) +
                    band.column;
        for (int x = pixels.x0; x <= pixels.x1; ++x)
            if (largest[static_cast<std::size_t>(x)] > kNothing)
                row[x] = {std::clamp(largest[static_cast<std::size_t>(x)], 0.0F, 1.0F), 0, 0, 1};
    }
    band.clear();
}

void depth_band(SlabBand& band, const CameraFrame& frame, Rgba* image) {
    const TileRange& pixels = band.pixels;
    for (int y = pixels.y0; y <= pixels.y1; ++y)
        for (int x = pixels.x0; x <= pixels.x1; ++x) {
            const int column = band.column + x, row = band.row + y;
            double sum = 0;
            for (int slab = 0; slab < band.slabs; ++slab)
                if (band.touched[static_cast<std::size_t>(slab)])
                    sum += double{band.plane(slab, 3)[SlabBand::offset(x, y)]};
            const auto depth =
                static_cast<float>(std::max(sum, 0.0) * length(frame.direction(column, row)));
            image[static_cast<std::size_t>(row) * static_cast<std::size_t>(frame.width) +
                  static_cast<std::size_t>(column)] = {depth, 0, 0, 1};
        }
    band.clear();
}

}  // namespace vog::splat
