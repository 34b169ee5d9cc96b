// extinction.cpp: automatic extinction, and its change after rendering (T is linear in it).
#include <fmt/core.h>
#include <tbb/blocked_range.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/parallel.h"
#include "data/image_checks.h"
#include "vog/error.h"
#include "vog/image.h"

namespace vog {

double auto_extinction(const DepthImage& image) {
    require_valid("auto extinction", image);
    std::vector<float> positive;
    positive.reserve(image.depth.size());
    for (const float t : image.depth)
        if (t > 0) positive.push_back(t);
    if (positive.empty()) return 1;

    // Nearest rank of the 99th percentile, index ceil(0.99 n) - 1 in integers. T = 4 is V = 0.98,
    // still distinguishable from 1.
    constexpr double kTargetDepth = 4;
    const std::size_t rank = (99 * positive.size() + 99) / 100 - 1;
    const auto percentile = positive.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(positive.begin(), percentile, positive.end());
    return image.extinction * kTargetDepth / static_cast<double>(*percentile);
}

void set_extinction(DepthImage& image, double extinction) {
    require_valid("set extinction", image);
    if (!(std::isfinite(extinction) && extinction > 0))
        throw Error(fmt::format("extinction {}, expected a finite number above 0", extinction));
    const double factor = extinction / image.extinction;
    const float deepest = *std::max_element(image.depth.begin(), image.depth.end());
    if (!std::isfinite(static_cast<float>(deepest * factor)))
        throw Error(fmt::format("extinction {}: the optical depth {} would become infinite",
                                extinction, deepest));

    vog::parallel_for(tbb::blocked_range<std::size_t>(0, image.depth.size(), 1 << 16),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          for (std::size_t i = range.begin(); i != range.end(); ++i)
                              image.depth[i] = static_cast<float>(image.depth[i] * factor);
                      });
    image.extinction = extinction;
}

}  // namespace vog
