// value_table.h: A transfer function of values as arrays, looked up in constant time: for the reference and for OptiX's
// rays through voxels. by_value/value_pieces.h makes it.
#pragma once

#include "render/device/gradient_factor.h"
#include "render/device/vector.h"

namespace vog::device {

/// Piece between two points of colour or opacity, in which both are linear.
struct ValuePiece {
    double start, end;  ///< values in [start, end)
    double origin;      ///< value at which the following hold
    double opacity, opacity_slope;
    double color[3], color_slope[3];
    double extinction;  ///< per world unit where opacity is constant; else negative
};

/// Light of a value: ValueLight (vog/value_transfer.h).
struct LightOfValue {
    double extinction;  ///< per world unit
    double color[3];
};

constexpr int32_t kValueBuckets = 1024;

/// The pieces, and for each of 1024 equal buckets of values a piece near it, where the search starts.
struct ValueTable {
    const ValuePiece* piece;
    const uint32_t* first;  ///< [kValueBuckets]
    double lowest, buckets_per_value;
    double unit_distance, most_opacity;
    GradientFactor gradient;
    double steepest;  ///< magnitude of its last point

    /// value  finite
    VOG_HD LightOfValue light(double value) const;
    VOG_HD double extinction(double opacity) const;
    /// Factor of the extinction by the magnitude of the field's gradient, per world unit.
    VOG_HD double factor(double magnitude) const {
        return gradient.any()
                   ? static_cast<double>(gradient.at(static_cast<float>(magnitude / steepest)))
                   : 1;
    }
};

/// -log1p(-opacity) / unit_distance, which takes a quarter of a picture: to 1e-12 of it by a series and log.
VOG_HD double ValueTable::extinction(double opacity) const {
    const double a = fmin(fmax(opacity, 0.0), most_opacity);
    const double depth =
        a < 1e-4 ? a * (1 + a * (1.0 / 2 + a * (1.0 / 3 + a * (1.0 / 4)))) : -log(1 - a);
    return depth / unit_distance;
}

VOG_HD LightOfValue ValueTable::light(double value) const {
    const double bucket = (value - lowest) * buckets_per_value;
    uint32_t at = bucket > 0 ? first[static_cast<uint32_t>(fmin(bucket, kValueBuckets - 1.0))] : 0;
    // Buckets are near by rounding; the piece's own ends decide.
    while (value >= piece[at].end) ++at;
    while (value < piece[at].start) --at;
    const ValuePiece& p = piece[at];
    const double along = value - p.origin;
    LightOfValue light;
    for (int c = 0; c < 3; ++c)
        light.color[c] = p.color_slope[c] == 0
                             ? p.color[c]
                             : fmin(fmax(p.color[c] + along * p.color_slope[c], 0.0), 1.0);
    light.extinction =
        p.extinction >= 0 ? p.extinction : extinction(p.opacity + along * p.opacity_slope);
    return light;
}

}  // namespace vog::device
