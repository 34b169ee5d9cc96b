// value_views.cpp: pictures by value of voxels and models, and sums of errors over them.
#include "compare/values/value_views.h"

#include <fmt/core.h>

#include <utility>

#include "compare/error_shares.h"
#include "compare/values/value_functions.h"
#include "vog/distributed.h"
#include "vog/error.h"
#include "vog/splat.h"
#include "vog/text.h"

namespace vog::comparison {

namespace {

constexpr int kSize_px = kErrorViewSize_px;

double square(const Rgba& c) {
    return double{c.r} * c.r + double{c.g} * c.g + double{c.b} * c.b + double{c.a} * c.a;
}
double square_difference(const Rgba& a, const Rgba& b) {
    return square({a.r - b.r, a.g - b.g, a.b - b.b, a.a - b.a});
}

}  // namespace

ValueViews::ValueViews(std::span<const Volume> volumes, std::span<const VoxelField> field,
                       std::vector<Camera> cameras, double radius)
    : field_(field.front().name), cameras_(std::move(cameras)) {
    const ValueRange range = value_range(volumes, field);
    if (!(range.upper > range.lower))
        throw Error(
            fmt::format("{}: field {}: all values are {:.6g}, expected several for pictures "
                        "by value",
                        volumes.front().source, printable(field_), range.lower));
    functions_ = value_functions(range, radius);
    for (const Camera& camera : cameras_) {
        std::vector<VolumeImage>& pictures = reference_.emplace_back();
        for (const ValueTransfer& function : functions_)
            pictures.push_back(
                render_volume_reference(volumes, field, function, camera, kSize_px, kSize_px));
    }
}

template <class Take>
void ValueViews::for_each_picture(const Gaussians& model, const Take& take) const {
    SlabRenderer renderer(model, field_, functions_.front());
    VolumeImage picture;
    for (std::size_t f = 0; f < functions_.size(); ++f) {
        renderer.set_transfer(functions_[f]);
        for (std::size_t view = 0; view < cameras_.size(); ++view) {
            renderer.render(cameras_[view], kSize_px, kSize_px, picture);
            take(view, f, picture);
        }
    }
}

RelativeError ValueViews::relative_l2(const Gaussians& model) const {
    std::vector<double> error2(cameras_.size()), norm2(cameras_.size());
    for_each_picture(model, [&](std::size_t view, std::size_t f, const VolumeImage& picture) {
        const std::vector<Rgba>& reference = reference_[view][f].pixel;
        for (std::size_t n = 0; n < reference.size(); ++n) {
            error2[view] += square_difference(picture.pixel[n], reference[n]);
            norm2[view] += square(reference[n]);
        }
    });
    SquareSums sums;
    for (std::size_t view = 0; view < cameras_.size(); ++view) sums.add(error2[view], norm2[view]);
    return sums.error();
}

std::vector<float> ValueViews::error_of_each_gaussian(const Gaussians& model) const {
    constexpr std::size_t kPixels = std::size_t{kSize_px} * kSize_px;
    std::vector<std::vector<float>> error2(cameras_.size(), std::vector<float>(kPixels));
    for_each_picture(model, [&](std::size_t view, std::size_t f, const VolumeImage& picture) {
        const std::vector<Rgba>& reference = reference_[view][f].pixel;
        for (std::size_t n = 0; n < kPixels; ++n)
            error2[view][n] +=
                static_cast<float>(square_difference(picture.pixel[n], reference[n]));
    });
    std::vector<float> errors(model.size());
    SplatRenderer renderer(model);
    DepthImage depth;
    for (std::size_t view = 0; view < cameras_.size(); ++view) {
        renderer.render(cameras_[view], kSize_px, kSize_px, depth);
        add_error_shares(errors, model, cameras_[view], depth, [&](int x, int y) {
            return error2[view][std::size_t(y) * kSize_px + std::size_t(x)];
        });
    }
    return errors;
}

}  // namespace vog::comparison
