// light_of_moments.h: Classification after blending: the arrays of device/expected_light.h for a transfer function.
//
// Values are shares of the field's range.
#pragma once

#include <cstdint>
#include <vector>

#include "render/device/expected_light.h"
#include "vog/gaussians.h"
#include "vog/value_transfer.h"

namespace vog {
struct Collective;
}

namespace vog::by_value {

/// Range of a field's data, widened where all values are one: values as shares of it.
struct ValueRange {
    double lower = 0, upper = 1;
    double background = 0;  ///< of the measure itself: its density is the value above this
    /// Whether all values are few, whole, and without spread: where two labels meet, none lies between them.
    bool labels = false;
    /// All labels, whose shares are even from each to the next; empty: shares are linear.
    std::vector<float> order{};
    double share(double value) const {
        return order.empty() ? (value - lower) / (upper - lower) : share_of_label(value);
    }
    double value(double share) const;

  private:
    double share_of_label(double value) const;
};
/// processes  that have parts of the field and make the same call; null: this one alone
ValueRange value_range(const ScalarField& field, const Collective* processes = nullptr);

/// A transfer function prepared for moments.
class LightOfMoments {
  public:
    LightOfMoments() = default;
    /// range      of the field's data
    /// per_value  light per unit of the value above the background: of a field that is the measure itself
    /// unit       factor of all light
    /// throws     vog::Error as validate(transfer) does
    LightOfMoments(const ValueTransfer& transfer, const ValueRange& range, bool per_value,
                   double unit = 1);

    /// Mean light per unit of the measure and world unit, times the unit: extinction times red, green and blue, and
    /// extinction. Valid while this lives, unchanged.
    /// slabs   of the picture; 0: values are mixed
    /// length  of gradients, world units: they are shares of the range over it
    device::MeanLight mean_light(int slabs = 0, double length = 1) const {
        device::MeanLight out = shape_;
        out.per_gradient = static_cast<float>(per_gradient_ / length);
        out.pieces = {pieces_.data(), static_cast<std::int32_t>(pieces_.size())};
        out.table = resolved_ ? table_.data() : nullptr;
        out.parts_per_cell = static_cast<float>(slabs) / device::kDepthCells;
        return out;
    }
    const std::vector<device::LightPiece>& pieces() const { return pieces_; }
    const std::vector<float>& table() const { return table_; }
    const ValueRange& range() const { return range_; }
    /// Whether the table follows the transfer function; else bands of it are narrower than the table's columns.
    bool resolved() const { return resolved_; }
    /// has_surface of the transfer function.
    bool surface() const { return surface_; }

  private:
    void add_pieces(const ValueTransfer& transfer, bool per_value, double unit);
    void set_seen();
    void add_labels(const ValueTransfer& transfer, bool per_value, double unit);
    void fill_table();
    bool follows() const;
    float value_at(double position) const;

    ValueRange range_;
    std::vector<device::LightPiece> pieces_;
    std::vector<float> table_;   ///< of MeanLight
    device::MeanLight shape_{};  ///< its columns
    bool resolved_ = true, surface_ = false;
    double per_gradient_ = 0;  ///< share of GradientFactor by one of the range, world units
};

}  // namespace vog::by_value
