// error_views.h: errors of a model over views around the data: relative L2 of T, visible error.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vog/camera.h"
#include "vog/distributed.h"
#include "vog/gaussians.h"
#include "vog/image.h"
#include "vog/volume.h"

namespace vog::comparison {

/// A depth image stored without the zeros at both ends of each row, which are most of an image of
/// data from outside.
class CroppedDepth {
  public:
    explicit CroppedDepth(const DepthImage& image);
    double at(int column, int row) const {
        const Row& values = rows_[static_cast<std::size_t>(row)];
        const bool inside = column >= values.first && column < values.end;
        return inside ? values_[values.values + static_cast<std::size_t>(column - values.first)]
                      : 0;
    }

    /// Whether every pixel is 0.
    bool empty() const { return values_.empty(); }
    /// Number of pixels between the first and the last of each row that are not 0.
    std::size_t covered() const { return values_.size(); }

  private:
    struct Row {
        int first = 0, end = 0;  ///< columns
        std::size_t values = 0;  ///< index of column `first` in values_
    };
    std::vector<Row> rows_;
    std::vector<float> values_;
};

/// Weight f of the squared error of T beside that of V = 1 - exp(-T), where a visible error is dV^2
/// + f dT^2, T in units of the extinction of the picture. Alone, dV^2 gives no weight to errors
/// behind T of 4 and more, which show at lower extinctions. The weight trades the two errors,
/// measured by
///     vog convert smoke.vdb --budget 19900 (cloud.vdb 20000, fire.vdb flames 5000)
///     vog render --size 512, vog compare: PSNR of V, dB / relative L2 of T, paper view
///         f       0             0.05          0.1           0.2
///     smoke   51.33 / 0.0234  51.29 / 0.0205  51.21 / 0.0200  51.14 / 0.0196
///     cloud   46.71 / 0.0211  45.92 / 0.0214  45.55 / 0.0216  45.24 / 0.0220
///     fire    38.58 / 0.0749  38.28 / 0.0721  38.12 / 0.0716  37.93 / 0.0716
/// Beyond 0.1 the L2 of T gains 2 % at most.
inline constexpr double kDepthErrorWeight = 0.1;

/// Sums of squares of the views, for RelativeError.
class SquareSums {
  public:
    /// Adds a view. error2  sum (T - T_ref)^2; norm2  sum T_ref^2
    void add(double error2, double norm2);
    /// A view in which nothing of the data is visible has no error.
    /// throws  vog::Error if no view shows anything
    RelativeError error() const;

  private:
    double error2_ = 0, norm2_ = 0, worst2_ = 0;
};

/// T of the data from several directions, and the errors of models against it.
class ErrorViews {
  public:
    /// Views of voxels, by exact traversal: of the box of the mass, or, where its parts are smaller
    /// than pixels, of the blocks of 128^3 voxels with the most mass.
    /// parts   their T add up
    /// box     of the whole data, world space: frames the views
    /// period  periodic box: models are drawn with their images, inside the box; none: open
    /// throws  vog::Error if no view shows anything
    /// memory  half of the largest part's, during construction
    ErrorViews(std::span<const Volume> parts, const Box& box, std::optional<Box> period = {});
    /// Views of a model, the finest of the data.
    /// draw  T of the data themselves, of kErrorViewSize_px; empty: of the model
    explicit ErrorViews(const Gaussians& finest,
                        const std::function<DepthImage(const Camera&)>& draw = {});
    RelativeError relative_l2(const Gaussians& model) const;
    /// Whether so many pixels show the data that estimates take the fifth of is_fifth(), all else.
    bool takes_fifth() const;
    /// Error of the same voxels, interpolated linearly between their centres, as takes_fifth() has it.
    /// parts  as given to the constructor
    RelativeError interpolation(std::span<const Volume> parts) const;
    /// Root mean square over all pixels of the visible error, dV^2 + kDepthErrorWeight dT^2, under
    /// the automatic extinction of the first view.
    double visible_rms(const Gaussians& model) const;
    /// Squared visible error attributed to each Gaussian [N] (compare/error_shares.h).
    std::vector<float> error_of_each_gaussian(const Gaussians& model) const;
    const std::vector<Camera>& cameras() const { return cameras_; }
    /// Radius of the box that they show, of several boxes the largest one's, world units.
    double radius() const { return radius_; }
    /// Mass that the views leave out, in words; empty: none.
    const std::string& note() const { return note_; }

  private:
    /// returns  whether the pictures have the mass of the data
    bool set_reference(std::span<const Volume> parts);
    /// Sum of (T - T_ref)^2 and T_ref^2 of one view.
    /// fifth  whether of the pixels of is_fifth() alone
    void add_view(std::size_t view, const DepthImage& image, SquareSums& sums,
                  bool fifth = false) const;
    /// Calls take(view, image) for the depth image of the model from each view.
    template <class Take>
    void for_each_picture(const Gaussians& model, const Take& take) const;
    /// Visible error of one pixel.
    double squared_error(double t, double reference) const;

    std::optional<Box> period_;
    std::vector<Camera> cameras_;
    std::vector<CroppedDepth> reference_;
    double extinction_ = 1, radius_ = 0;
    std::string note_;
};

}  // namespace vog::comparison
