// value_pieces.h: A transfer function of values prepared for many values: light_of in constant time.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "vog/value_transfer.h"

namespace vog::shading {

/// Pieces between the points of colour and opacity, in each of which both are linear. Each of 1024 equal buckets of
/// values between the first and the last point stores a piece near it, where the search starts.
class ValuePieces {
  public:
    /// throws  vog::Error as validate does
    explicit ValuePieces(const ValueTransfer& transfer);

    /// Light of a value: light_of to rounding, and the same side of every step.
    /// value  finite
    ValueLight operator()(double value) const;

  private:
    struct Piece {
        double start, end;  ///< values in [start, end)
        double origin;      ///< value at which the following hold
        double opacity, opacity_slope;
        std::array<double, 3> color, color_slope;
        double extinction;  ///< per world unit where opacity is constant; else negative
    };
    const Piece& piece_of(double value) const;
    static double opacity_at(const Piece& piece, double value) {
        return piece.opacity + (value - piece.origin) * piece.opacity_slope;
    }
    double extinction_of(double opacity) const;

    static constexpr std::size_t kBuckets = 1024;
    std::vector<Piece> pieces_;
    std::array<std::uint32_t, kBuckets> first_{};
    double lowest_ = 0, buckets_per_value_ = 0;
    double unit_distance_ = 1;
};

}  // namespace vog::shading
