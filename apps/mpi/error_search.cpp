// error_search.cpp: pictures of all parts, and false position on budgets.
#include "error_search.h"

#include <algorithm>
#include <cmath>

#include "vog/convert_moments.h"
#include "vog/distributed.h"
#include "vog/reference.h"
#include "vog/splat.h"

namespace vog::mpi {

WholeError::WholeError(std::span<const Volume> volumes, const Box& box, const Ranks& ranks)
    : ranks_(ranks), cameras_(error_views(box)) {
    std::vector<VoxelGrid> grids;
    for (const Volume& volume : volumes) grids.push_back(voxel_grid(volume));
    for (const Camera& camera : cameras_) {
        references_.push_back(
            render_reference(grids, camera, kErrorViewSize_px, kErrorViewSize_px));
        ranks.sum_at_first(references_.back());
    }
}

double WholeError::of(const std::vector<Gaussians>& models) const {
    Gaussians model;
    for (const Gaussians& one : models)
        if (one.size() > 0) append(model, one);
    double sums[2] = {};  // of squares: of errors, of T
    SplatRenderer renderer(model);
    for (std::size_t view = 0; view < cameras_.size(); ++view) {
        DepthImage image = renderer.render(cameras_[view], kErrorViewSize_px, kErrorViewSize_px);
        ranks_.sum_at_first(image);
        if (!ranks_.first()) continue;
        for (std::size_t n = 0; n < image.depth.size(); ++n) {
            const double t = references_[view].depth[n], d = image.depth[n] - t;
            sums[0] += d * d;
            sums[1] += t * t;
        }
    }
    ranks_.sum(sums);
    return sums[1] > 0 ? std::sqrt(sums[0] / sums[1]) : 0;
}

std::vector<Gaussians> smallest_models(
    double target, std::size_t largest, const WholeError& error,
    const std::function<std::vector<Gaussians>(std::size_t budget)>& make) {
    // Errors are close to a power of the count: false position on the logarithms, kept inside what
    // is known.
    constexpr int kTries = 12;
    constexpr double kTolerance = 1.05, kFirstShare = 0.01;
    constexpr double kNear = 0.97;  // of the target is near enough: a twelfth of the Gaussians
    const auto finest = static_cast<double>(std::max<std::size_t>(largest, 1));
    double low = 1, high = finest, count = std::max(1.0, kFirstShare * finest), power = -0.35;
    double last_count = 0, last_error = 0;
    std::vector<Gaussians> best;
    for (int tries = 0; tries < kTries && high > kTolerance * low; ++tries) {
        std::vector<Gaussians> models = make(static_cast<std::size_t>(count));
        const double reached = error.of(models);
        if (reached <= target) {
            best = std::move(models);
            high = count;
            if (reached > kNear * target) break;
        } else {
            low = count;
        }
        if (last_count > 0 && last_count != count) {
            const double found = std::log(reached / last_error) / std::log(count / last_count);
            if (std::isfinite(found)) power = std::clamp(found, -1.0, -0.1);
        }
        last_count = count, last_error = reached;
        constexpr double kAim = 0.985;  // between near enough and too much
        const double aimed = count * std::pow(kAim * target / reached, 1 / power);
        count = aimed > low && aimed < high ? aimed : std::sqrt(low * high);
    }
    if (best.empty()) best = make(static_cast<std::size_t>(finest));
    return best;
}

}  // namespace vog::mpi
