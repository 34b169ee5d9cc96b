// gradient_factor.h: Gradient opacity: a factor of extinction by the magnitude of the field's gradient, linear between points
// (ValueTransfer::gradient). by_value/value_pieces.h makes it.
#pragma once

#include "render/device/vector.h"

namespace vog::device {

/// Points as shares of the last one's magnitude: data in any units have floats.
struct GradientFactor {
    static constexpr int32_t kMostParts = 7;

    int32_t parts;  ///< between points; 0: the factor is 1
    float first;    ///< factor of the first point and below
    float start[kMostParts], width[kMostParts], slope[kMostParts];

    VOG_HD bool any() const { return parts > 0; }
    /// share  of the last point's magnitude, >= 0
    VOG_HD float at(float share) const {
        float factor = first;
        for (int32_t n = 0; n < parts; ++n)
            factor += fminf(fmaxf(share - start[n], 0.0f), width[n]) * slope[n];
        return fminf(fmaxf(factor, 0.0f), 1.0f);
    }
};

}  // namespace vog::device
