// moment_error.cpp: eight small pictures of the volume, and how far a model's are from them.
#include "convert/moment_error.h"

#include <cmath>
#include <numbers>

#include "vog/moments.h"
#include "vog/reference.h"
#include "vog/render.h"

namespace vog {

namespace {

constexpr int kSize_px = kErrorViewSize_px;

}  // namespace

std::vector<Camera> error_views(const Box& box) {
    constexpr int kViews = 8;
    std::vector<Camera> cameras;
    // An eighth of a turn apart from the paper's azimuth on, its elevation and 50 degrees by turns,
    // above and below: no two look along the same axis.
    constexpr double kSteep = 0.87;
    for (int view = 0; view < kViews; ++view) {
        const double azimuth = kPaperAzimuthRad + view * std::numbers::pi / 4;
        const double elevation = (view & 1 ? kSteep : kPaperElevationRad) * (view & 2 ? -1.0 : 1.0);
        cameras.push_back(
            orbit_view(box, azimuth, elevation, kPaperDistanceRadii, kPaperFovDegrees));
    }
    return cameras;
}

ErrorViews::ErrorViews(std::span<const Volume> parts, const Box& box) : cameras_(error_views(box)) {
    std::vector<VoxelGrid> grids;
    for (const Volume& part : parts) grids.push_back(voxel_grid(part));
    for (const Camera& camera : cameras_)
        reference_.push_back(render_reference(grids, camera, kSize_px, kSize_px));
}

ErrorViews::ErrorViews(const Gaussians& finest) : cameras_(error_views(view_box(finest))) {
    for (const Camera& camera : cameras_)
        reference_.push_back(render_splat(finest, camera, kSize_px, kSize_px));
}

double ErrorViews::measure(const Gaussians& model) const {
    double error2 = 0, norm2 = 0;
    SplatRenderer renderer(model);
    DepthImage image;
    for (std::size_t view = 0; view < cameras_.size(); ++view) {
        renderer.render(cameras_[view], kSize_px, kSize_px, image);
        for (std::size_t pixel = 0; pixel < image.depth.size(); ++pixel) {
            const double t = reference_[view].depth[pixel], d = image.depth[pixel] - t;
            error2 += d * d;
            norm2 += t * t;
        }
    }
    return norm2 > 0 ? std::sqrt(error2 / norm2) : 0;
}

}  // namespace vog
