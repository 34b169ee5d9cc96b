// rate_errors.cpp: pictures and voxels of what is read back, compared with those of the data.
#include "evaluate/rate/rate_errors.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/reference/reference.h"
#include "render/splat/splat.h"
#include "shade/named_extinction.h"
#include "vog/compare.h"
#include "vog/error.h"

namespace vog::evaluation {

namespace {

constexpr double kExact = std::numeric_limits<double>::infinity();

EvaluateOptions options_of(const RateDistortionOptions& options) {
    EvaluateOptions evaluate;
    evaluate.width = options.width;
    evaluate.height = options.height;
    evaluate.extinction = options.extinction;
    evaluate.value_functions = options.value_functions;
    return evaluate;
}

std::vector<std::vector<double>> psnr_of(const std::vector<std::vector<ValueResult>>& results) {
    std::vector<std::vector<double>> psnr;
    for (const std::vector<ValueResult>& of_function : results) {
        std::vector<double>& views = psnr.emplace_back();
        for (const ValueResult& result : of_function) views.push_back(result.psnr_rgb_db);
    }
    return psnr;
}

/// Whether maps differ by rounding alone: files keep transforms in forms of their own.
bool nearly_equal(const Affine& a, const Affine& b) {
    const Affine back = inverse(a);
    for (const Vec3d point : {Vec3d{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}) {
        const Vec3d off = back(b(point)) - point;
        if (!(dot(off, off) < 1e-12)) return false;  // a millionth of a voxel
    }
    return true;
}

}  // namespace

RateErrors::RateErrors(const Volume& volume, const RateDistortionOptions& options)
    : volume_(volume),
      grid_(voxel_grid(volume)),
      options_(options_of(options)),
      values_(std::span(&volume, 1), world_box(volume), options_),
      mass_(mass(volume)) {
    const Box box = world_box(volume);
    for (const char* view : kValueViews) {
        Orbit orbit;
        orbit.distance_radii = kPaperDistanceRadii;
        set_view(orbit, view);
        cameras_.push_back(orbit_view(box, orbit, double(options.width) / options.height));
        DepthImage& depth = reference_.emplace_back(
            render_reference(std::span(&grid_, 1), cameras_.back(), options.width, options.height));
        set_extinction(depth, options.extinction > 0
                                  ? options.extinction
                                  : shading::auto_extinction_of(depth, volume.source));
    }
}

DepthImage RateErrors::data(const Camera& camera, int size) const {
    return render_reference(std::span(&grid_, 1), camera, size, size);
}

std::vector<double> RateErrors::psnr_v(const Volume& read) const {
    const VoxelGrid grid = voxel_grid(read);
    std::vector<double> psnr;
    for (std::size_t view = 0; view < cameras_.size(); ++view)
        psnr.push_back(
            compare(reference_[view], render_reference(std::span(&grid, 1), cameras_[view],
                                                       options_.width, options_.height))
                .grey.psnr_db);
    return psnr;
}

std::vector<double> RateErrors::psnr_v(const Gaussians& read) const {
    SplatRenderer renderer(read);
    DepthImage depth;
    std::vector<double> psnr;
    for (std::size_t view = 0; view < cameras_.size(); ++view) {
        renderer.render(cameras_[view], options_.width, options_.height, depth);
        psnr.push_back(compare(reference_[view], depth).grey.psnr_db);
    }
    return psnr;
}

std::vector<std::vector<double>> RateErrors::psnr_rgb(const Volume& read) const {
    return psnr_of(values_.compare(read));
}

std::vector<std::vector<double>> RateErrors::psnr_rgb(const Gaussians& read) const {
    return psnr_of(values_.compare(read));
}

VoxelError RateErrors::voxels(const Volume& read) const { return voxel_error(volume_, read); }

bool RateErrors::equal(const Volume& read) const {
    const auto same_leaf = [](const Leaf& a, const Leaf& b) {
        return a.origin == b.origin && a.mask == b.mask && a.value == b.value;
    };
    const auto same_tile = [](const Tile& a, const Tile& b) {
        return a.origin == b.origin && a.edge == b.edge && a.value == b.value;
    };
    return std::ranges::equal(volume_.leaves, read.leaves, same_leaf) &&
           std::ranges::equal(volume_.tiles, read.tiles, same_tile);
}

void RateErrors::measure(const Volume& read, const std::vector<double>& psnr_v,
                         RateRow& row) const {
    if (!nearly_equal(volume_.world_from_index, read.world_from_index))
        throw Error(fmt::format("{}: another transform than the volume's", read.source));
    row.psnr_v_db = psnr_v;
    row.mass_ratio = mass(read) / mass_;
    if (equal(read)) {
        row.psnr_rgb_db.assign(values_.names().size(),
                               std::vector<double>(cameras_.size(), kExact));
        row.voxels = {0, kExact, 0, 0};
        return;
    }
    row.psnr_rgb_db = psnr_rgb(read);
    Volume aligned = read;
    aligned.world_from_index = volume_.world_from_index;
    row.voxels = voxels(aligned);
}

}  // namespace vog::evaluation
