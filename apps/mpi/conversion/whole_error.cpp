// whole_error.cpp: depth images summed over the ranks, compared on the first.
#include "conversion/whole_error.h"

#include <algorithm>
#include <cmath>

#include "vog/error.h"
#include "vog/periodic.h"
#include "vog/picture.h"

namespace vog::mpi {

namespace {

template <class Data>
PictureRenderer renderer_of(Data data) {
    Scene scene;
    scene.sources.push_back(std::move(data));
    return PictureRenderer(std::move(scene));
}

/// Picture of one view.
PictureRequest request_of(const Camera& camera) {
    return {.camera = camera, .width = kErrorViewSize_px, .height = kErrorViewSize_px};
}

}  // namespace

WholeError::WholeError(std::vector<Volume> volumes, const Box& box,
                       const std::optional<Box>& period, const Ranks& ranks)
    : ranks_(ranks), period_(period), cameras_(error_views(volumes, box, &ranks.collective())) {
    auto set = std::make_shared<VolumeSet>();
    set->volumes = std::move(volumes);
    PictureRenderer renderer = renderer_of(VoxelSource{std::move(set), {}});
    for (const Camera& camera : cameras_) {
        references_.push_back(bare_depth(renderer, request_of(camera)));
        ranks.sum_at_first(references_.back());
    }
    interpolation_ = of([&](const Camera& camera) {
        PictureRequest request = request_of(camera);
        request.options.voxels = {Interpolation::linear, 0};
        return bare_depth(renderer, request);
    });
}

RelativeError WholeError::of(const std::vector<Gaussians>& models) const {
    Gaussians model;
    for (const Gaussians& one : models)
        if (one.size() > 0) append(model, one);
    if (period_) add_periodic_images(model, *period_);
    PictureRenderer renderer =
        renderer_of(ModelSource{std::make_shared<const Gaussians>(std::move(model))});
    return of([&](const Camera& camera) { return bare_depth(renderer, request_of(camera)); });
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
            "the error cannot be measured: no view shows anything of the data, whose parts are too "
            "small for their distance; expected a budget or a block");
    return {std::sqrt(worst2), std::sqrt(error2 / norm2)};
}

}  // namespace vog::mpi
