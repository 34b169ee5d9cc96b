// error_views.h: the measured error of a model: relative L2 of T over views around the volume.
#pragma once

#include <span>
#include <vector>

#include "vog/camera.h"
#include "vog/gaussians.h"
#include "vog/image.h"
#include "vog/volume.h"

namespace vog::comparison {

/// A picture of T without the empty ends of its rows: most of it, of data seen from outside.
class CroppedDepth {
  public:
    explicit CroppedDepth(const DepthImage& image);
    double at(int column, int row) const {
        const Row& values = rows_[static_cast<std::size_t>(row)];
        const bool inside = column >= values.first && column < values.end;
        return inside ? values_[values.values + static_cast<std::size_t>(column - values.first)]
                      : 0;
    }

  private:
    struct Row {
        int first = 0, end = 0;  ///< columns
        std::size_t values = 0;  ///< where its own begin
    };
    std::vector<Row> rows_;
    std::vector<float> values_;
};

/// The data's own T from eight sides.
class ErrorViews {
  public:
    /// By exact traversal of the voxels.
    /// parts   add up
    /// memory  half of the largest part's, while they are made
    ErrorViews(std::span<const Volume> parts, const Box& box);
    /// By the finest model that there is.
    explicit ErrorViews(const Gaussians& finest);
    /// sqrt(sum |T - T_ref|^2 / sum |T_ref|^2), over all pixels of all views
    double relative_l2(const Gaussians& model) const;
    /// Root of the mean over all pixels of dV^2 + dT^2 / 10, T in units of the extinction that the
    /// first view is shown at: what is seen, and what another extinction would show.
    double visible_rms(const Gaussians& model) const;
    /// For each Gaussian the sum of that square over its pixels, each by the share that it has of T
    /// there; it is taken as round, with the mean of its variances.
    std::vector<float> error_of_each_gaussian(const Gaussians& model) const;

  private:
    /// Calls take(view, image) for the model's picture of each view.
    template <class Take>
    void for_each_picture(const Gaussians& model, const Take& take) const;
    double squared_error(double t, double reference) const;

    std::vector<Camera> cameras_;
    std::vector<CroppedDepth> reference_;
    double extinction_ = 1;
};

}  // namespace vog::comparison
