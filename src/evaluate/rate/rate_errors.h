// rate_errors.h: errors of files that were read back, against pictures and voxels of the data.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "evaluate/values/value_comparison.h"
#include "render/reference/reference.h"
#include "vog/gaussians.h"
#include "vog/rate_distortion.h"

namespace vog::evaluation {

/// Pictures of the data from the views of kValueViews, of T and by value, and its voxels.
class RateErrors {
  public:
    /// volume  outlives this
    /// throws  vog::Error for a volume without a density above 0, and as ValueComparison does
    RateErrors(const Volume& volume, const RateDistortionOptions& options);

    std::vector<std::string> functions() const { return values_.names(); }
    /// T of the data from a camera, for fit_vogz.
    DepthImage data(const Camera& camera, int size) const;

    /// PSNR of V in each view, dB, and its mean.
    std::vector<double> psnr_v(const Volume& read) const;
    std::vector<double> psnr_v(const Gaussians& read) const;
    /// [functions][views] PSNR of RGB, dB.
    std::vector<std::vector<double>> psnr_rgb(const Volume& read) const;
    std::vector<std::vector<double>> psnr_rgb(const Gaussians& read) const;
    VoxelError voxels(const Volume& read) const;
    /// Measures everything of a volume in a row; one equal to the data in every bit has no error.
    /// psnr_v  of this volume
    void measure(const Volume& read, const std::vector<double>& psnr_v, RateRow& row) const;
    /// Whether leaves and tiles are the data's.
    bool equal(const Volume& read) const;

  private:
    const Volume& volume_;
    VoxelGrid grid_;
    EvaluateOptions options_;
    ValueComparison values_;
    std::vector<Camera> cameras_;
    std::vector<DepthImage> reference_;  ///< at their extinctions
    double mass_;
};

}  // namespace vog::evaluation
