// joint_pixels.cpp: Moments of a field over the voxels of several processes, about one value a pixel.
#include "render/reference/parts/joint_pixels.h"

#include <limits>
#include <vector>

namespace vog::reference {

void join(std::span<FirstRelative> pixels, const Collective& processes) {
    constexpr double kNothing = -std::numeric_limits<double>::infinity();
    // A value of the field on the pixel, the same for all: a field that hardly varies keeps its digits.
    std::vector<double> reference(pixels.size(), kNothing);
    for (std::size_t n = 0; n < pixels.size(); ++n)
        if (pixels[n].met) reference[n] = pixels[n].reference;
    processes.max(reference);
    std::vector<double> sums;
    sums.reserve(3 * pixels.size());
    for (std::size_t n = 0; n < pixels.size(); ++n) {
        FirstRelative joint{{{}, reference[n], reference[n] > kNothing}};
        joint.add(RayMoments{pixels[n].sums, pixels[n].reference});
        sums.insert(sums.end(), {joint.sums.column, joint.sums.first, joint.sums.second});
    }
    processes.sum(sums);
    for (std::size_t n = 0; n < pixels.size(); ++n) {
        const bool met = reference[n] > kNothing;
        pixels[n] = {
            {{sums[3 * n], sums[3 * n + 1], sums[3 * n + 2]}, met ? reference[n] : 0, met}};
    }
}

}  // namespace vog::reference
