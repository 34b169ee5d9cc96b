// value_pieces.h: A transfer function of values prepared for many values: light_of in constant time.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/device/voxels/value_table.h"
#include "vog/value_transfer.h"

namespace vog::by_value {

/// Gradient opacity of a transfer function.
/// throws  vog::Error as validate does
device::GradientFactor gradient_factor(const ValueTransfer& transfer);

/// Whether opacity steps up to kMostOpacity at a value: there a surface is drawn.
bool has_surface(const ValueTransfer& transfer);

/// Pieces between the points of colour and opacity, in each of which both are linear.
class ValuePieces {
  public:
    /// throws  vog::Error as validate does
    explicit ValuePieces(const ValueTransfer& transfer);

    /// Light of a value: light_of to rounding, and the same side of every step.
    /// value  finite
    ValueLight operator()(double value) const {
        const device::LightOfValue light = table().light(value);
        return {light.extinction, light.color[0], light.color[1], light.color[2]};
    }

    /// Valid while this lives, unchanged.
    device::ValueTable table() const {
        return {pieces_.data(), first_.data(), lowest_,   buckets_per_value_,
                unit_distance_, kMostOpacity,  gradient_, steepest_};
    }
    const std::vector<device::ValuePiece>& pieces() const { return pieces_; }
    /// Factor of the extinction by the magnitude of a gradient, >= 0.
    double factor(double magnitude) const { return table().factor(magnitude); }
    bool has_gradient() const { return gradient_.any(); }
    const std::vector<std::uint32_t>& buckets() const { return first_; }

  private:
    std::vector<device::ValuePiece> pieces_;
    std::vector<std::uint32_t> first_;  ///< [device::kValueBuckets]
    double lowest_ = 0, buckets_per_value_ = 0;
    double unit_distance_ = 1;
    device::GradientFactor gradient_{};
    double steepest_ = 1;
};

}  // namespace vog::by_value
