// error_views.cpp: depth images of 256^2 pixels around the mass, and sums of errors over them.
#include "compare/error_views.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "compare/error_shares.h"
#include "compare/view_boxes.h"
#include "render/pixel_tiles.h"
#include "render/reference/reference.h"
#include "render/splat/splat.h"
#include "shade/named_extinction.h"
#include "vog/error.h"
#include "vog/periodic.h"
#include "vog/shade.h"

namespace vog {

using namespace comparison;

namespace {

constexpr int kSize_px = kErrorViewSize_px;

}  // namespace

std::vector<Camera> error_views(const Box& box) {
    constexpr double kNear = 1.5, kPaper = kPaperDistanceRadii;
    constexpr bool kParallel = true;
    struct View {
        double azimuth_degrees, elevation_degrees, distance_radii;
        bool orthographic = false;
    };
    constexpr std::array<View, 12> kViews{{{kPaperAzimuthDegrees, kPaperElevationDegrees, kPaper},
                                           {126, -29, kPaper},
                                           {223, 50, kPaper},
                                           {298, -11, kPaper},
                                           {0, 0, kPaper, kParallel},  // x, y, z
                                           {0, 90, kPaper, kParallel},
                                           {90, 0, kPaper, kParallel},
                                           {45, 0, kPaper, kParallel},  // diagonals of faces
                                           {0, -45, kPaper, kParallel},
                                           {74, 11, kNear},
                                           {172, -46, kNear},
                                           {180, 0, kNear}}};
    std::vector<Camera> cameras;
    for (const View& view : kViews) {
        Orbit orbit;
        orbit.azimuth_degrees = view.azimuth_degrees;
        orbit.elevation_degrees = view.elevation_degrees;
        orbit.distance_radii = view.distance_radii;
        orbit.orthographic = view.orthographic;
        cameras.push_back(orbit_view(box, orbit));
    }
    return cameras;
}

namespace comparison {

void SquareSums::add(double error2, double norm2) {
    if (!(norm2 > 0)) return;  // plates seen edge-on, narrower than a pixel
    error2_ += error2, norm2_ += norm2;
    worst2_ = std::max(worst2_, error2 / norm2);
}

RelativeError SquareSums::error() const {
    if (!(norm2_ > 0))
        throw Error(fmt::format(
            "the error cannot be measured: {} views of {}x{} pixels show nothing of the data, "
            "whose parts are too small for their distance; expected a budget or a block",
            error_views(Box{}).size(), kSize_px, kSize_px));
    return {std::sqrt(worst2_), std::sqrt(error2_ / norm2_)};
}

}  // namespace comparison

namespace {

/// Note that views do not show the whole; empty where they do.
std::string box_note(const Box& seen, const Box& whole) {
    if (seen == whole) return {};
    return fmt::format(
        "at most 0.1 % of the mass lies far outside the views of the measured error: the whole is "
        "{:.3g} times as wide as their box",
        whole.radius() / seen.radius());
}

}  // namespace

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

/// Adds a volume's T to each image, or to a fifth of its pixels. The traversal copies the voxels, so a large volume is traversed
/// in four runs of its sorted leaves, whose T add up in both interpolations.
void add_reference(const Volume& volume, std::span<const Camera> cameras,
                   const VoxelGridOptions& options, const ReferenceOptions& traced,
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
        const VoxelGrid grid = voxel_grid(slab, options);
        slab = {{}, {}, volume.world_from_index, {}, volume.source};
        for (std::size_t view = 0; view < cameras.size(); ++view) {
            const DepthImage part =
                render_reference(std::span(&grid, 1), cameras[view], kSize_px, kSize_px, traced);
            for (std::size_t pixel = 0; pixel < part.depth.size(); ++pixel)
                images[view].depth[pixel] += part.depth[pixel];
        }
    }
}

std::vector<DepthImage> reference_images(std::span<const Volume> parts,
                                         std::span<const Camera> cameras,
                                         const VoxelGridOptions& options = {},
                                         const ReferenceOptions& traced = {}) {
    std::vector<DepthImage> images(cameras.size(), DepthImage(kSize_px, kSize_px));
    for (const Volume& part : parts) add_reference(part, cameras, options, traced, images);
    return images;
}

}  // namespace

bool ErrorViews::set_reference(std::span<const Volume> parts) {
    const std::vector<DepthImage> images = reference_images(parts, cameras_);
    reference_.clear();
    for (const DepthImage& image : images) reference_.emplace_back(image);
    extinction_ = shading::auto_extinction_of(images.front(),
                                              parts.empty() ? std::string{} : parts.front().source);

    // The sum of T over an orthographic picture, times the area of its pixels, is the mass: far from
    // it where parts of the data are smaller than a pixel, and rays miss them or hit them by chance.
    double mass_of_parts = 0, sum = 0, widest = 0;
    for (const Volume& part : parts) mass_of_parts += mass(part);
    for (const Camera& camera : cameras_) widest = std::max(widest, camera.orthographic_width);
    int pictures = 0;
    for (std::size_t view = 0; view < cameras_.size(); ++view) {
        // The widest show the whole, others the finest level.
        if (cameras_[view].orthographic_width < 0.5 * widest) continue;
        const double pixel = cameras_[view].orthographic_width / kSize_px;
        const std::vector<float>& depth = images[view].depth;
        sum += pixel * pixel * std::accumulate(depth.begin(), depth.end(), 0.0);
        ++pictures;
    }
    constexpr double kFactor = 2;
    const double seen = sum / pictures;
    return seen * kFactor > mass_of_parts && seen < kFactor * mass_of_parts;
}

ErrorViews::ErrorViews(std::span<const Volume> parts, const Box& box, std::optional<Box> period)
    : period_(period) {
    const Box seen = error_view_box(parts, box);
    cameras_ = error_views(parts, box);
    radius_ = seen.radius();
    note_ = box_note(seen, box);
    if (set_reference(parts)) return;
    BlockViews views = views_of_heaviest_blocks(parts);
    cameras_ = std::move(views.cameras);
    radius_ = views.radius;
    note_ = fmt::format(
        "the data are too sparse for pictures of {} pixels: views of the measured error show the "
        "heaviest {} of {} blocks of 128^3 voxels, with {:.3g} % of the mass",
        kSize_px, views.viewed, views.blocks, 100 * views.mass_share);
    set_reference(parts);
}

ErrorViews::ErrorViews(const Gaussians& finest,
                       const std::function<DepthImage(const Camera&)>& draw) {
    const auto for_each_gaussian = [&](const std::function<void(const Box&, double)>& take) {
        for (std::size_t i = 0; i < finest.size(); ++i) {
            const Vec3d at = world_mean(finest, i);
            take({at, at}, mass(finest, i));
        }
    };
    const Box whole = view_box(finest);
    const Box seen = box_of_mass(whole, collective_or_single(nullptr), for_each_gaussian);
    cameras_ = error_views(seen);
    radius_ = seen.radius();
    note_ = box_note(seen, whole);
    for (const Camera& camera : cameras_) {
        const DepthImage image =
            draw ? draw(camera) : render_splat(finest, camera, kSize_px, kSize_px);
        if (reference_.empty()) extinction_ = auto_extinction(image);
        reference_.emplace_back(image);
    }
}

template <class Take>
void ErrorViews::for_each_picture(const Gaussians& model, const Take& take) const {
    std::optional<Gaussians> with_images;
    if (period_) add_periodic_images(with_images.emplace(model), *period_);
    SplatRenderer renderer(with_images ? *with_images : model);
    if (period_) renderer.set_clip(inside_period({}, *with_images));
    DepthImage image;
    for (std::size_t view = 0; view < cameras_.size(); ++view) {
        renderer.render(cameras_[view], kSize_px, kSize_px, image);
        take(view, image);
    }
}

void ErrorViews::add_view(std::size_t view, const DepthImage& image, SquareSums& sums,
                          bool fifth) const {
    double error2 = 0, norm2 = 0;
    for (int y = 0; y < kSize_px; ++y)
        for (int x = 0; x < kSize_px; ++x) {
            if (fifth && !is_fifth(x, y)) continue;
            const double t = reference_[view].at(x, y), d = image.at(x, y) - t;
            error2 += d * d;
            norm2 += t * t;
        }
    sums.add(error2, norm2);
}

RelativeError ErrorViews::relative_l2(const Gaussians& model) const {
    SquareSums sums;
    for_each_picture(
        model, [&](std::size_t view, const DepthImage& image) { add_view(view, image, sums); });
    return sums.error();
}

bool ErrorViews::takes_fifth() const {
    constexpr std::size_t kEnough = 20000;
    std::size_t covered = 0;
    for (const CroppedDepth& image : reference_) covered += image.covered();
    return covered >= kEnough;
}

RelativeError ErrorViews::interpolation(std::span<const Volume> parts) const {
    constexpr VoxelGridOptions kLinear{Interpolation::linear, 0};
    ReferenceOptions traced;
    traced.fifth = takes_fifth();
    const std::vector<DepthImage> images = reference_images(parts, cameras_, kLinear, traced);
    SquareSums sums;
    for (std::size_t view = 0; view < images.size(); ++view)
        add_view(view, images[view], sums, traced.fifth);
    return sums.error();
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
        add_error_shares(errors, model, cameras_[view], image, [&](int x, int y) {
            return squared_error(image.at(x, y), reference_[view].at(x, y));
        });
    });
    return errors;
}

}  // namespace vog
