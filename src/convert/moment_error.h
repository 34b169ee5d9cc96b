// moment_error.h: the measured error of a model: relative L2 of T over views around the volume.
#pragma once

#include <span>
#include <vector>

#include "vog/camera.h"
#include "vog/gaussians.h"
#include "vog/image.h"
#include "vog/volume.h"

namespace vog {

/// A picture of T without the empty ends of its rows: most of it, of data seen from outside.
class CroppedDepth {
  public:
    explicit CroppedDepth(const DepthImage& image);
    /// Sums of |image - this|^2 and |this|^2 over all pixels of an image of the same size, row by
    /// row.
    void compare(const DepthImage& image, double& error2, double& norm2) const;

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
    double measure(const Gaussians& model) const;

  private:
    std::vector<Camera> cameras_;
    std::vector<CroppedDepth> reference_;
};

}  // namespace vog
