// vogz_fit.cpp: bisection of the steps of compact files by the error of their pictures.
#include "vog/vogz_fit.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "render/splat/splat.h"
#include "vog/error.h"

namespace vog {

namespace {

constexpr int kSize = 256;  // pixels

/// Mean square of V - V_ref at an extinction.
double mean_square(const DepthImage& reference, const DepthImage& image, double extinction) {
    double sum = 0;
    for (std::size_t n = 0; n < reference.depth.size(); ++n) {
        const double difference = std::exp(-extinction * double{reference.depth[n]}) -
                                  std::exp(-extinction * double{image.depth[n]});
        sum += difference * difference;
    }
    return sum / static_cast<double>(reference.depth.size());
}

double decibels(double mean_square) {
    return mean_square > 0 ? -10 * std::log10(mean_square)
                           : std::numeric_limits<double>::infinity();
}

/// A view of the model, and of the data or its assumed error.
struct View {
    Camera camera;
    DepthImage model, data;
    double extinction = 1, model_error = 0;
};

std::vector<View> views_of(const Gaussians& model, const VogzBound& bound) {
    std::vector<View> views;
    SplatRenderer renderer(model);
    const Box box = view_box(model);
    for (const char* name : view_names()) {
        Orbit orbit;
        orbit.distance_radii = 3;
        set_view(orbit, name);
        View view{orbit_view(box, orbit), {}, {}, 1, std::pow(10, -bound.model_psnr_db / 10)};
        renderer.render(view.camera, kSize, kSize, view.model);
        if (bound.data) view.data = bound.data(view.camera, kSize);
        view.extinction = auto_extinction(bound.data ? view.data : view.model);
        if (bound.data) view.model_error = mean_square(view.data, view.model, view.extinction);
        views.push_back(std::move(view));
    }
    return views;
}

VogzFit measure(const Gaussians& model, const VogzPrecision& precision,
                const std::vector<View>& views) {
    VogzFit fit{precision, 0, std::numeric_limits<double>::infinity(), 0};
    const Gaussians coarse = rounded(model, precision);
    SplatRenderer renderer(coarse);
    DepthImage image;
    for (const View& view : views) {
        renderer.render(view.camera, kSize, kSize, image);
        const double error = mean_square(view.model, image, view.extinction);
        const double total = view.data.depth.empty()
                                 ? view.model_error + error
                                 : mean_square(view.data, image, view.extinction);
        // A model without an error loses all by any rounding.
        const double loss = total > 0 ? decibels(view.model_error) - decibels(total) : 0;
        fit.loss_db = std::max(fit.loss_db, loss);
        fit.rounded_db = std::min(fit.rounded_db, decibels(error));
        fit.model_db += decibels(view.model_error) / static_cast<double>(views.size());
    }
    return fit;
}

VogzPrecision precision_at(int quarter_octaves) {
    const VogzPrecision standard;
    const double step = std::exp2(-0.25 * quarter_octaves);
    return {step, std::min(0.5, step * standard.field_step / standard.step)};
}

}  // namespace

VogzFit fit_vogz(const Gaussians& model, const VogzBound& bound) {
    if (!(bound.max_loss_db > 0) || !std::isfinite(bound.max_loss_db))
        throw Error(fmt::format("loss of at most {} dB, expected above 0", bound.max_loss_db));
    if (!(bound.model_psnr_db > 0) || !std::isfinite(bound.model_psnr_db))
        throw Error(fmt::format("PSNR of the model {} dB, expected above 0", bound.model_psnr_db));
    const std::vector<View> views = views_of(model, bound);
    // Steps of 2^-3 and 2^-16.5 = 1.1e-5.
    int coarse = 12, fine = 66;
    VogzFit best = measure(model, precision_at(fine), views);
    if (best.loss_db > bound.max_loss_db)
        throw Error(fmt::format(
            "compact model: a loss of {:.3g} dB at the finest step, expected at most {} dB",
            best.loss_db, bound.max_loss_db));
    VogzFit tried = measure(model, precision_at(coarse), views);
    if (tried.loss_db <= bound.max_loss_db) return tried;
    while (fine - coarse > 1) {
        const int middle = (coarse + fine) / 2;
        tried = measure(model, precision_at(middle), views);
        if (tried.loss_db <= bound.max_loss_db)
            fine = middle, best = tried;
        else
            coarse = middle;
    }
    return best;
}

}  // namespace vog
