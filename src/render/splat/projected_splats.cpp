// projected_splats.cpp: Chunks of Gaussians, and the sort of their splats by tile.
#include "render/splat/projected_splats.h"

#include <tbb/parallel_reduce.h>

#include <cmath>

namespace vog::splat {

double unit_of(const Gaussians& gaussians) {
    const double largest = tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, gaussians.size(), 1 << 16), 0.0,
        [&](const tbb::blocked_range<std::size_t>& range, double most) {
            for (std::size_t i = range.begin(); i < range.end(); ++i) {
                const Vec3f s = gaussians.scale[i];
                most = std::max(most, double{gaussians.density[i]} * std::max({s.x, s.y, s.z}));
            }
            return most;
        },
        [](double a, double b) { return std::max(a, b); });
    return largest > 0 ? std::exp2(std::min(std::ilogb(largest), 252)) : 1;
}

/// Splits Gaussians first ... last - 1 into chunks. Their number depends on the Gaussians alone, so
/// the order of splats within a tile is the same for any number of threads.
void ProjectedSplats::split(std::size_t first, std::size_t last) {
    constexpr std::size_t kLeast = 256, kMost = 32, kGrain = 16;
    const std::size_t count = last - first;
    chunk_count_ = std::clamp<std::size_t>(count / kLeast, 1, kMost);
    const std::size_t size =
        ((count + chunk_count_ - 1) / chunk_count_ + kGrain - 1) / kGrain * kGrain;
    if (chunks_.size() < chunk_count_) chunks_.resize(chunk_count_);
    if (far.size() < count) far.resize(count), bounds.resize(count);
    if (keep_origin && origin.size() < count) origin.resize(count);
    for (std::size_t n = 0; n < chunk_count_; ++n) {
        SplatChunk& chunk = chunks_[n];
        chunk.first = std::min(first + n * size, last);
        chunk.last = std::min(chunk.first + size, last);
        chunk.slot = chunk.first - first;
    }
}

void ProjectedSplats::bin(const CameraFrame& frame) {
    bins.place();
    vog::parallel_for(std::size_t{0}, chunk_count_, [&](std::size_t n) {
        bins.fill(n, bounds_of(chunks_[n]), static_cast<std::uint32_t>(chunks_[n].slot));
    });
    near.clear();
    for (std::size_t n = 0; n < chunk_count_; ++n)
        near.insert(near.end(), chunks_[n].near.begin(), chunks_[n].near.end());
    if (near.empty()) return;
    near_bounds.clear();
    for (const NearSplat& splat : near) near_bounds.push_back(splat.bounds);
    near_bins.start(frame.width, frame.height, 1);
    near_bins.count(0, near_bounds);
    near_bins.place();
    near_bins.fill(0, near_bounds, 0);
}

}  // namespace vog::splat
