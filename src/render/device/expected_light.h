// expected_light.h: Mean light of values that are normally distributed, under a transfer function, in closed form
// (docs/volume_rendering.md), and by a table of it: linear in the mean and in the variance, in which it is smooth (the
// mean light solves the heat equation). by_value/light_of_moments.h makes the arrays. Values are shares of a field's range.
//
// Light per unit of the measure is linear in pieces of the values. Over a piece from a to b, with Phi and n the normal
// distribution function and density, z = (value - mean) / deviation and t = (value - a) / (b - a) in [0, 1],
//   mass    P = Phi(z_b) - Phi(z_a)
//   moment  M = integral of t = ((mean - a) P + deviation (n(z_a) - n(z_b))) / (b - a)
//   light   sum over pieces of  (P - M) light(a) + M light(b),   over the sum of P
// All weights are >= 0: the colour lies between those of the transfer function.
#pragma once

#include "render/device/gradient_factor.h"
#include "render/device/vector.h"

namespace vog::device {

/// Light between two values, linear: extinction times red, green and blue, and extinction.
struct LightPiece {
    float start, end;         ///< shares of the field's range
    float first[4], last[4];  ///< light at start, and just below end
};

/// Pieces over [0, 1], ascending, without gaps; none is empty.
struct LightPieces {
    const LightPiece* piece;
    int32_t count;

    /// Piece that a value lies in; the nearest one beyond the ends.
    VOG_HD int32_t piece_at(float value) const;
    /// Mean light of a normal distribution, cut to [0, 1].
    /// mean       in [0, 1]
    /// deviation  >= 0
    VOG_HD void light(float mean, float deviation, float out[4]) const;
};

/// Cells over the depths of a picture. The two values of a pair lie side by side in a cell: matter of one hides nothing
/// of the other, where a mixture would be opaque before the surface of what is opaque in it.
constexpr int32_t kDepthCells = 32;

/// Mean light of a transfer function, by its table where that follows it.
struct MeanLight {
    static constexpr int32_t kColumns = 1024, kOctaves = 20, kRows = kOctaves + 1;
    /// Variance of the last row. Row 0 has variance 0, row n > 0 this divided by 2^(kOctaves - n).
    static constexpr float kMostVariance = 0.25f;
    static constexpr float kLeastVariance =
        kMostVariance / static_cast<float>(1 << (kOctaves - 1));  ///< of row 1

    LightPieces pieces;
    const float* table;  ///< [kRows][kColumns][4]; null: bands are narrower than its columns
    /// Half of the columns lie over the whole range, half over the part of it where the transfer function changes:
    /// position = mean per_range + (clamp(mean, low, high) - low) per_part, 0 to 1.
    float low, high, per_range, per_part;
    float first_seen, last_seen;  ///< no light below and above
    float most;                   ///< extinction per unit of tau
    float parts_per_cell;         ///< slabs, or other parts of the depth; 0: values are mixed
    GradientFactor gradient;
    float per_gradient;  ///< share of GradientFactor by a part's gradient
    bool labels;         ///< values are ranks of labels, and none lies between two

    VOG_HD float position(float mean) const {
        return mean * per_range + (fminf(fmaxf(mean, low), high) - low) * per_part;
    }
    /// Row of a variance, [0, kOctaves]: linear in it between rows.
    VOG_HD static float row(float variance);
    VOG_HD void at(float mean, float variance, float out[4]) const;
    /// Mean light: at() where there is a table.
    VOG_HD void light(float mean, float variance, float out[4]) const {
        if (table)
            at(mean, variance, out);
        else
            pieces.light(mean, sqrtf(variance), out);
    }
};

VOG_HD int32_t LightPieces::piece_at(float value) const {
    int32_t low = 0, high = count - 1;
    while (low < high) {
        const int32_t middle = (low + high + 1) / 2;
        if (piece[middle].start <= value)
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}

VOG_HD void LightPieces::light(float mean, float deviation, float out[4]) const {
    constexpr float kReach = 4, kPerRoot2 = 0.70710678f, kPerRoot2Pi = 0.39894228f;
    int32_t n = piece_at(mean - kReach * deviation);
    const LightPiece* p = piece + n;
    if (!(deviation > 0) ||
        (mean + kReach * deviation < p->end && mean - kReach * deviation >= p->start)) {
        // A normal distribution within a piece has the light of its mean.
        if (!(deviation > 0)) p = piece + piece_at(mean);
        const float at = fminf(fmaxf((mean - p->start) / (p->end - p->start), 0.0f), 1.0f);
        for (int c = 0; c < 4; ++c) out[c] = p->first[c] + at * (p->last[c] - p->first[c]);
        return;
    }
    const float per = 1 / deviation;
    const float until = mean + kReach * deviation;
    float z0 = (p->start - mean) * per;
    float below0 = erff(z0 * kPerRoot2), density0 = kPerRoot2Pi * expf(-0.5f * z0 * z0);
    float sum[4] = {0, 0, 0, 0}, whole = 0;
    for (; n < count; ++n) {
        p = piece + n;
        const float width = p->end - p->start;
        const float z1 = (p->end - mean) * per;
        const float below1 = erff(z1 * kPerRoot2), density1 = kPerRoot2Pi * expf(-0.5f * z1 * z1);
        float mass = 0.5f * (below1 - below0), moment;
        if (z1 - z0 < 0.1f) {
            // Differences would cancel: the density is nearly linear.
            const float middle = 0.5f * (density0 + density1);
            mass = middle * (z1 - z0);
            moment = mass * 0.5f + (density1 - density0) * (z1 - z0) * (1.0f / 12);
        } else {
            moment = ((mean - p->start) * mass + deviation * (density0 - density1)) / width;
        }
        moment = fminf(fmaxf(moment, 0.0f), mass);
        for (int c = 0; c < 4; ++c) sum[c] += (mass - moment) * p->first[c] + moment * p->last[c];
        whole += mass;
        if (p->end > until) break;
        z0 = z1, below0 = below1, density0 = density1;
    }
    const float per_whole = whole > 0 ? 1 / whole : 0;
    for (int c = 0; c < 4; ++c) out[c] = per_whole * sum[c];
}

VOG_HD float MeanLight::row(float variance) {
    if (variance <= kLeastVariance) return variance > 0 ? variance / kLeastVariance : 0;
    // The bits of a float above a power of two count octaves, linear between them.
    union {
        float value;
        int32_t bits;
    } as, least;
    as.value = fminf(variance, kMostVariance);
    least.value = kLeastVariance;
    return 1 + static_cast<float>(as.bits - least.bits) * (1.0f / (1 << 23));
}

VOG_HD void MeanLight::at(float mean, float variance, float out[4]) const {
    const float x = position(mean) * (kColumns - 1), y = row(variance);
    const int32_t left = static_cast<int32_t>(x), top = static_cast<int32_t>(y);
    const int32_t column = left < kColumns - 2 ? left : kColumns - 2;
    const int32_t above = top < kRows - 2 ? top : kRows - 2;
    const float right = x - static_cast<float>(column), down = y - static_cast<float>(above);
    const float* upper = table + 4 * (above * kColumns + column);
    const float* lower = upper + 4 * kColumns;
    for (int c = 0; c < 4; ++c) {
        const float a = upper[c] + right * (upper[4 + c] - upper[c]);
        const float b = lower[c] + right * (lower[4 + c] - lower[c]);
        out[c] = a + down * (b - a);
    }
}

}  // namespace vog::device
