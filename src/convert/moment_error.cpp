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

void CroppedDepth::compare(const DepthImage& image, double& error2, double& norm2) const {
    for (int y = 0; y < image.height; ++y) {
        const Row& row = rows_[static_cast<std::size_t>(y)];
        for (int x = 0; x < image.width; ++x) {
            const bool inside = x >= row.first && x < row.end;
            const double t =
                inside ? values_[row.values + static_cast<std::size_t>(x - row.first)] : 0;
            const double d = image.at(x, y) - t;
            error2 += d * d;
            norm2 += t * t;
        }
    }
}

namespace {

/// Adds a volume's T to each picture. A traversal holds its voxels once more: of a large volume a
/// quarter of the leaves at a time, which lie together as leaves are sorted.
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
}

ErrorViews::ErrorViews(const Gaussians& finest) : cameras_(error_views(view_box(finest))) {
    for (const Camera& camera : cameras_)
        reference_.emplace_back(render_splat(finest, camera, kSize_px, kSize_px));
}

double ErrorViews::measure(const Gaussians& model) const {
    double error2 = 0, norm2 = 0;
    SplatRenderer renderer(model);
    DepthImage image;
    for (std::size_t view = 0; view < cameras_.size(); ++view) {
        renderer.render(cameras_[view], kSize_px, kSize_px, image);
        reference_[view].compare(image, error2, norm2);
    }
    return norm2 > 0 ? std::sqrt(error2 / norm2) : 0;
}

}  // namespace vog
