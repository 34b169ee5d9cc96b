// whole_error.cpp: depth images summed over the ranks, compared on the first.
#include "whole_error.h"

#include <cmath>

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
    double sums[2] = {};  // (T - T_ref)^2, T_ref^2
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

}  // namespace vog::mpi
