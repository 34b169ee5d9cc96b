// value_pieces.h: A transfer function of values prepared for many values: light_of in constant time.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
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
    ValueLight operator()(double value) const {
        const Piece& piece = piece_of(value);
        const double along = value - piece.origin;
        const auto color = [&](std::size_t c) {
            return piece.color_slope[c] == 0
                       ? piece.color[c]
                       : std::clamp(piece.color[c] + along * piece.color_slope[c], 0.0, 1.0);
        };
        return {piece.extinction >= 0 ? piece.extinction : extinction_of(opacity_at(piece, value)),
                color(0), color(1), color(2)};
    }

  private:
    struct Piece {
        double start, end;  ///< values in [start, end)
        double origin;      ///< value at which the following hold
        double opacity, opacity_slope;
        std::array<double, 3> color, color_slope;
        double extinction;  ///< per world unit where opacity is constant; else negative
    };
    const Piece& piece_of(double value) const {
        const double bucket = (value - lowest_) * buckets_per_value_;
        std::size_t at =
            bucket > 0 ? first_[static_cast<std::size_t>(std::min(bucket, kBuckets - 1.0))] : 0;
        // Buckets are near by rounding; the piece's own ends decide.
        while (value >= pieces_[at].end) ++at;
        while (value < pieces_[at].start) --at;
        return pieces_[at];
    }
    static double opacity_at(const Piece& piece, double value) {
        return piece.opacity + (value - piece.origin) * piece.opacity_slope;
    }
    /// -log1p(-opacity) / unit_distance, which takes a quarter of a picture: to 1e-12 of it by a series and log.
    double extinction_of(double opacity) const {
        const double a = std::clamp(opacity, 0.0, kMostOpacity);
        const double depth =
            a < 1e-4 ? a * (1 + a * (1.0 / 2 + a * (1.0 / 3 + a * (1.0 / 4)))) : -std::log(1 - a);
        return depth / unit_distance_;
    }

    static constexpr std::size_t kBuckets = 1024;
    std::vector<Piece> pieces_;
    std::array<std::uint32_t, kBuckets> first_{};
    double lowest_ = 0, buckets_per_value_ = 0;
    double unit_distance_ = 1;
};

}  // namespace vog::shading
