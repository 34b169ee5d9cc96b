// vog/vogz_fit.h: precision of a compact file from a bound on what its pictures may lose.
#pragma once

#include <functional>

#include "vog/camera.h"
#include "vog/gaussians.h"
#include "vog/image.h"
#include "vog/vogz.h"

namespace vog {

/// Bound on the loss of a compact file.
struct VogzBound {
    /// Largest loss of PSNR of V = 1 - exp(-T) against the data in any view, dB, > 0.
    double max_loss_db = 0.1;
    /// Picture of the data: T at extinction 1, size x size pixels. Null: no data; the model is taken to have the PSNR
    /// `model_psnr_db` in every view.
    std::function<DepthImage(const Camera& camera, int size)> data{};
    double model_psnr_db = 50;  ///< > 0; used only without data
};

/// Precision, and what it costs in the views `paper`, +x, -x, +y, -y, +z and -z of 256 x 256 pixels, at the extinction
/// of auto_extinction.
struct VogzFit {
    VogzPrecision precision;
    double loss_db = 0;  ///< largest of the views
    double rounded_db =
        0;  ///< PSNR of the rounded model against the model, least of the views; infinity: equal
    double model_db = 0;  ///< PSNR of the model against the data, mean of the views
};

/// Coarsest of the steps 2^(-n/4) within a bound. Field values are rounded in proportion: a step of 0.025 goes with
/// 1/256 of the data's range.
/// throws  vog::Error for an invalid model or bound, or one that no step from 1e-5 on meets
/// cost    about seven times seven pictures
[[nodiscard]] VogzFit fit_vogz(const Gaussians& model, const VogzBound& bound = {});

}  // namespace vog
