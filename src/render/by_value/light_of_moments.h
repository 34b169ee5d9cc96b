// light_of_moments.h: Classification after blending: mean light of values with given moments under a transfer function.
//
// Values are shares of the field's range. The closed form is in device/expected_light.h; a table of it serves loops over
// pixels: linear in the mean and in the variance, in which it is smooth (the mean light solves the heat equation).
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "render/device/expected_light.h"
#include "vog/gaussians.h"
#include "vog/value_transfer.h"

namespace vog::by_value {

/// Range of a field's data, widened where all values are one: values as shares of it.
struct ValueRange {
    double lower = 0, upper = 1;
    double share(double value) const { return (value - lower) / (upper - lower); }
    double value(double share) const { return lower + share * (upper - lower); }
};
ValueRange value_range(const ScalarField& field);

/// Table of mean light.
struct MomentTable {
    static constexpr int kColumns = 1024, kOctaves = 20, kRows = kOctaves + 1;
    /// Variance of the last row. Row 0 has variance 0, row n > 0 this divided by 2^(kOctaves - n).
    static constexpr float kMostVariance = 0.25f;

    std::vector<std::array<float, 4>> light;  ///< [kRows][kColumns]
    /// Half of the columns lie over the whole range, half over the part of it where the transfer function changes:
    /// position = mean per_range + (clamp(mean, low, high) - low) per_part, 0 to 1.
    float low = 0, high = 1, per_range = 0.5f, per_part = 0.5f;

    float position(float mean) const {
        return mean * per_range + (std::min(std::max(mean, low), high) - low) * per_part;
    }
    /// Row of a variance, [0, kOctaves]: linear in it between rows.
    static float row(float variance);
    std::array<float, 4> at(float mean, float variance) const;
};

/// A transfer function prepared for moments.
class LightOfMoments {
  public:
    LightOfMoments() = default;
    /// range      of the field's data
    /// per_value  light per unit of the value: of a field that is the measure itself
    /// unit       factor of all light
    /// throws     vog::Error as validate(transfer) does
    LightOfMoments(const ValueTransfer& transfer, const ValueRange& range, bool per_value,
                   double unit = 1);

    /// Mean light per unit of the measure and world unit, times the unit: extinction times red, green and blue, and
    /// extinction.
    std::array<float, 4> exact(float mean, float deviation) const {
        std::array<float, 4> light;
        pieces().light(mean, deviation, light.data());
        return light;
    }
    /// Valid while this lives, unchanged.
    device::LightPieces pieces() const {
        return {pieces_.data(), static_cast<std::int32_t>(pieces_.size())};
    }
    const MomentTable& table() const { return table_; }
    /// Whether the table follows the transfer function; else bands of it are narrower than the table's columns.
    bool resolved() const { return resolved_; }

  private:
    void add_pieces(const ValueTransfer& transfer, const ValueRange& range, bool per_value,
                    double unit);
    void fill_table();
    bool follows() const;
    float value_at(double position) const;

    std::vector<device::LightPiece> pieces_;
    MomentTable table_;
    bool resolved_ = true;
};

}  // namespace vog::by_value
