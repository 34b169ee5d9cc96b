// whole_error.cpp: depth images summed over the ranks, compared on the first.
#include "conversion/whole_error.h"

#include <algorithm>
#include <cmath>

#include "vog/error.h"
#include "vog/reference.h"
#include "vog/splat.h"

namespace vog::mpi {

WholeError::WholeError(std::span<const Volume> volumes, const Box& box, const Ranks& ranks)
    : ranks_(ranks), cameras_(error_views(volumes, box, &ranks.collective())) {
    const auto grids_of = [&](const VoxelGridOptions& options) {
        std::vector<VoxelGrid> grids;
        for (const Volume& volume : volumes) grids.push_back(voxel_grid(volume, options));
        return grids;
    };
    const auto picture_of = [](const std::vector<VoxelGrid>& grids, const Camera& camera) {
        return render_reference(grids, camera, kErrorViewSize_px, kErrorViewSize_px);
    };
    std::vector<VoxelGrid> grids = grids_of({});
    for (const Camera& camera : cameras_) {
        references_.push_back(picture_of(grids, camera));
        ranks.sum_at_first(references_.back());
    }
    grids = grids_of({Interpolation::linear, 0});
    interpolation_ = of([&](const Camera& camera) { return picture_of(grids, camera); });
}

RelativeError WholeError::of(const std::vector<Gaussians>& models) const {
    Gaussians model;
    for (const Gaussians& one : models)
        if (one.size() > 0) append(model, one);
    SplatRenderer renderer(model);
    return of([&](const Camera& camera) {
        return renderer.render(camera, kErrorViewSize_px, kErrorViewSize_px);
    });
}

RelativeError WholeError::of(const std::function<DepthImage(const Camera&)>& picture_of) const {
    std::vector<double> sums(2 * cameras_.size());  // each view's (T - T_ref)^2, T_ref^2
    for (std::size_t view = 0; view < cameras_.size(); ++view) {
        DepthImage image = picture_of(cameras_[view]);
        ranks_.sum_at_first(image);
        if (!ranks_.first()) continue;
        for (std::size_t n = 0; n < image.depth.size(); ++n) {
            const double t = references_[view].depth[n], d = image.depth[n] - t;
            sums[2 * view] += d * d;
            sums[2 * view + 1] += t * t;
        }
    }
    ranks_.sum(sums);
    double error2 = 0, norm2 = 0, worst2 = 0;
    for (std::size_t view = 0; view < cameras_.size(); ++view) {
        error2 += sums[2 * view], norm2 += sums[2 * view + 1];
        if (sums[2 * view + 1] > 0) worst2 = std::max(worst2, sums[2 * view] / sums[2 * view + 1]);
    }
    if (!(norm2 > 0))
        throw Error(
            "the error cannot be measured: no view shows anything of the data, whose parts "
            "are too small for their distance; expected a budget or a block");
    return {std::sqrt(worst2), std::sqrt(error2 / norm2)};
}

}  // namespace vog::mpi
