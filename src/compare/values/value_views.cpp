// value_views.cpp: pictures by value of voxels and models, and sums of errors over them.
#include "compare/values/value_views.h"

#include <fmt/core.h>

#include "compare/error_shares.h"
#include "compare/values/value_functions.h"
#include "render/pixel_tiles.h"
#include "render/reference/reference.h"
#include "render/splat/splat.h"
#include "render/splat/volume/volume_splat.h"
#include "vog/distributed.h"
#include "vog/error.h"
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
                       const ErrorViews& views)
    : field_(field.front().name), fifth_(views.takes_fifth()), cameras_(views.cameras()) {
    const ValueRange range = value_range(volumes, field);
    if (!(range.upper > range.lower))
        throw Error(fmt::format(
            "{}: field {}: all values are {:.6g}, expected several for pictures by value",
            volumes.front().source, printable(field_), range.lower));
    functions_ = value_functions(range, views.radius());
    ReferenceOptions traced;
    traced.fifth = fifth_;
    reference_ =
        render_volume_references(volumes, field, functions_, cameras_, kSize_px, kSize_px, traced);
}

template <class Visit>
void ValueViews::for_each_pixel(const Visit& visit) const {
    for (int y = 0; y < kSize_px; ++y)
        for (int x = 0; x < kSize_px; ++x)
            if (!fifth_ || is_fifth(x, y)) visit(x, y, static_cast<std::size_t>(y * kSize_px + x));
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

ValueErrors ValueViews::errors(const Gaussians& model) const {
    constexpr std::size_t kPixels = std::size_t{kSize_px} * kSize_px;
    ValueErrors errors;
    errors.square.assign(cameras_.size(), std::vector<float>(kPixels));
    std::vector<double> error2(cameras_.size()), norm2(cameras_.size());
    for_each_picture(model, [&](std::size_t view, std::size_t f, const VolumeImage& picture) {
        const std::vector<Rgba>& reference = reference_[view][f].pixel;
        for_each_pixel([&](int, int, std::size_t n) {
            const double square = square_difference(picture.pixel[n], reference[n]);
            errors.square[view][n] += static_cast<float>(square);
            error2[view] += square;
            norm2[view] += comparison::square(reference[n]);
        });
    });
    SquareSums sums;
    for (std::size_t view = 0; view < cameras_.size(); ++view) sums.add(error2[view], norm2[view]);
    errors.relative_l2 = sums.error();
    if (!fifth_) return errors;
    for (std::vector<float>& square : errors.square)
        for_each_pixel([&](int x, int y, std::size_t n) {
            if (x > 0) square[n - 1] = square[n];
            if (x + 1 < kSize_px) square[n + 1] = square[n];
            if (y > 0) square[n - kSize_px] = square[n];
            if (y + 1 < kSize_px) square[n + kSize_px] = square[n];
        });
    return errors;
}

std::vector<float> ValueViews::error_of_each_gaussian(const Gaussians& model,
                                                      const ValueErrors& errors) const {
    std::vector<float> of_each(model.size());
    SplatRenderer renderer(model);
    DepthImage depth;
    for (std::size_t view = 0; view < cameras_.size(); ++view) {
        renderer.render(cameras_[view], kSize_px, kSize_px, depth);
        add_error_shares(of_each, model, cameras_[view], depth, [&](int x, int y) {
            return errors.square[view][std::size_t(y) * kSize_px + std::size_t(x)];
        });
    }
    return of_each;
}

}  // namespace vog::comparison
