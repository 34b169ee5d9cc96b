// slab_maximum.cpp: Largest mean over the slabs of a cell.
#include "render/splat/volume/slab_maximum.h"

#include <algorithm>
#include <array>
#include <limits>

#include "render/by_value/volume_image.h"

namespace vog::splat {

void maximum_cell(float most_share, SlabCell& cell) {
    constexpr float kNothing = -std::numeric_limits<float>::infinity();
    constexpr auto kShare = static_cast<float>(kLeastDensityShare);
    CellPixels least{}, largest;
    largest.fill(kNothing);
    for (int slab = cell.lowest; slab <= cell.highest; ++slab) {
        const CellPixels& weight = cell.slab(slab)[kTau].pixel;
        for (std::size_t n = 0; n < kCellPixels; ++n)
            least[n] = std::max(least[n], kShare * weight[n]);
    }
    for (int slab = cell.lowest; slab <= cell.highest; ++slab) {
        const CellPixels &weight = cell.slab(slab)[kTau].pixel,
                         &sum = cell.slab(slab)[kFirst].pixel;
        for (std::size_t n = 0; n < kCellPixels; ++n)
            largest[n] =
                weight[n] > 0 && weight[n] >= least[n]
                    ? std::max(largest[n], std::min(sum[n] / weight[n], most_share * weight[n]))
                    : largest[n];
    }
    cell.seen = {};
    for (std::size_t n = 0; n < kCellPixels; ++n) {
        cell.seen[0][n] = largest[n] > kNothing ? std::clamp(largest[n], 0.0F, 1.0F) : 0;
        cell.seen[3][n] = largest[n] > kNothing ? 0.0F : 1.0F;
    }
}

}  // namespace vog::splat
