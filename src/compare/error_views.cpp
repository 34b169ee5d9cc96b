// error_views.cpp: eight depth images of 256^2 pixels, and sums of errors over them.
#include "compare/error_views.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.h"
#include "vog/distributed.h"
#include "vog/reference.h"
#include "vog/shade.h"
#include "vog/splat.h"

namespace vog {

using namespace comparison;

namespace {

constexpr int kSize_px = kErrorViewSize_px;

}  // namespace

std::vector<Camera> error_views(const Box& box) {
    constexpr int kViews = 8;
    std::vector<Camera> cameras;
    // Azimuths an eighth of a turn apart, starting with the paper's. Elevations alternate between
    // the paper's and 50 degrees, above and below, so that no two views share an axis.
    constexpr double kSteepDegrees = 50;
    for (int view = 0; view < kViews; ++view) {
        Orbit orbit;
        orbit.azimuth_degrees += view * 45;
        if (view & 1) orbit.elevation_degrees = kSteepDegrees;
        if (view & 2) orbit.elevation_degrees *= -1;
        orbit.distance_radii = kPaperDistanceRadii;
        cameras.push_back(orbit_view(box, orbit));
    }
    return cameras;
}

CroppedDepth::CroppedDepth(const DepthImage& image) {
    for (int y = 0; y < image.height; ++y) {
        Row row{0, image.width, values_.size()};
        while (row.end > 0 && image.at(row.end - 1, y) == 0) --row.end;
        while (row.first < row.end && image.at(row.first, y) == 0) ++row.first;
        for (int x = row.first; x < row.end; ++x) values_.push_back(image.at(x, y));
        rows_.push_back(row);
    }
    values_.shrink_to_fit();
}

namespace {

/// Adds a volume's T to each image. The traversal copies the voxels, so a large volume is traversed
/// in four runs of its sorted leaves.
void add_reference(const Volume& volume, std::span<const Camera> cameras,
                   std::span<DepthImage> images) {
    constexpr std::size_t kSlabs = 4, kLeast = 256;  // leaves
    const std::size_t count = volume.leaves.size(), slabs = count < kLeast ? 1 : kSlabs;
    Volume slab;
    slab.tiles = volume.tiles;
    slab.world_from_index = volume.world_from_index;
    slab.source = volume.source;
    for (std::size_t n = 0; n < slabs; ++n) {
        const auto leaf = [&](std::size_t end) {
            return volume.leaves.begin() + static_cast<std::ptrdiff_t>(end * count / slabs);
        };
        slab.leaves = BigVector<Leaf>(leaf(n), leaf(n + 1));
        const VoxelGrid grid = voxel_grid(slab);
        slab = {{}, {}, volume.world_from_index, {}, volume.source};
        for (std::size_t view = 0; view < cameras.size(); ++view) {
            const DepthImage part =
                render_reference(std::span(&grid, 1), cameras[view], kSize_px, kSize_px);
            for (std::size_t pixel = 0; pixel < part.depth.size(); ++pixel)
                images[view].depth[pixel] += part.depth[pixel];
        }
    }
}

}  // namespace

ErrorViews::ErrorViews(std::span<const Volume> parts, const Box& box) : cameras_(error_views(box)) {
    std::vector<DepthImage> images(cameras_.size(), DepthImage(kSize_px, kSize_px));
    for (const Volume& part : parts) add_reference(part, cameras_, images);
    for (const DepthImage& image : images) reference_.emplace_back(image);
    extinction_ = auto_extinction(images.front());
}

ErrorViews::ErrorViews(const Gaussians& finest) : cameras_(error_views(view_box(finest))) {
    for (const Camera& camera : cameras_) {
        const DepthImage image = render_splat(finest, camera, kSize_px, kSize_px);
        if (reference_.empty()) extinction_ = auto_extinction(image);
        reference_.emplace_back(image);
    }
}

template <class Take>
void ErrorViews::for_each_picture(const Gaussians& model, const Take& take) const {
    SplatRenderer renderer(model);
    DepthImage image;
    for (std::size_t view = 0; view < cameras_.size(); ++view) {
        renderer.render(cameras_[view], kSize_px, kSize_px, image);
        take(view, image);
    }
}

double ErrorViews::relative_l2(const Gaussians& model) const {
    double error2 = 0, norm2 = 0;
    for_each_picture(model, [&](std::size_t view, const DepthImage& image) {
        for (int y = 0; y < kSize_px; ++y)
            for (int x = 0; x < kSize_px; ++x) {
                const double t = reference_[view].at(x, y), d = image.at(x, y) - t;
                error2 += d * d;
                norm2 += t * t;
            }
    });
    return norm2 > 0 ? std::sqrt(error2 / norm2) : 0;
}

double ErrorViews::squared_error(double t, double reference) const {
    const double dv = std::exp(-extinction_ * reference) - std::exp(-extinction_ * t);
    const double dt = extinction_ * (t - reference);
    return dv * dv + kDepthErrorWeight * dt * dt;
}

double ErrorViews::visible_rms(const Gaussians& model) const {
    double sum = 0;
    for_each_picture(model, [&](std::size_t view, const DepthImage& image) {
        for (int y = 0; y < kSize_px; ++y)
            for (int x = 0; x < kSize_px; ++x)
                sum += squared_error(image.at(x, y), reference_[view].at(x, y));
    });
    return std::sqrt(sum / (static_cast<double>(cameras_.size()) * kSize_px * kSize_px));
}

std::vector<float> ErrorViews::error_of_each_gaussian(const Gaussians& model) const {
    std::vector<float> errors(model.size());
    for_each_picture(model, [&](std::size_t view, const DepthImage& image) {
        const CameraFrame frame = frame_of(cameras_[view], kSize_px, kSize_px);
        vog::parallel_for(std::size_t{0}, model.size(), [&](std::size_t i) {
            const Vec3d to = vec_cast<double>(model.mean[i]) - frame.eye;
            const double depth = dot(to, frame.forward);
            if (depth <= 0) return;
            const double pixels = frame.pixels_per_unit / depth;
            const double column = 0.5 * (kSize_px - 1) + pixels * dot(to, frame.right);
            const double row = 0.5 * (kSize_px - 1) - pixels * dot(to, frame.up);
            const Vec3d scale = vec_cast<double>(model.scale[i]);
            const double sigma = std::sqrt(dot(scale, scale) / 3);
            // Narrower footprints could fall between pixel centres.
            const double sigma_px = std::max(0.4, pixels * sigma), reach = 2 * sigma_px;
            const double peak =
                static_cast<double>(model.density[i]) * sigma * std::sqrt(2 * std::numbers::pi);
            const auto clamped = [](double pixel) {
                return static_cast<int>(std::clamp(pixel, 0.0, kSize_px - 1.0));
            };
            double sum = 0;
            for (int y = clamped(std::ceil(row - reach)); y <= clamped(row + reach); ++y)
                for (int x = clamped(std::ceil(column - reach)); x <= clamped(column + reach);
                     ++x) {
                    const double t = image.at(x, y), dx = x - column, dy = y - row;
                    const double from2 = (dx * dx + dy * dy) / (2 * sigma_px * sigma_px);
                    if (t <= 0 || from2 > 2) continue;
                    const double share = std::min(1.0, peak * std::exp(-from2) / t);
                    sum += share * squared_error(t, reference_[view].at(x, y));
                }
            errors[i] += static_cast<float>(sum);
        });
    });
    return errors;
}

}  // namespace vog
