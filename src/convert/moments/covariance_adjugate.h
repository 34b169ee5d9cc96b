// covariance_adjugate.h: adjugate and determinant of a covariance, from which its inverse follows.
#pragma once

#include <array>

namespace vog::moments {

/// Entries xx xy xz yy yz zz.
struct Adjugate {
    std::array<double, 6> entry;
    double determinant;  ///< > 0
};

/// covariance  xx xy xz yy yz zz, positive definite. Of a cell thousands of times as long as wide and
///             not along an axis, such as two voxels far apart, rounding leaves no digit of the
///             determinant, not even its sign: it is widened by 1e-6 of its trace.
inline Adjugate adjugate_of(std::array<double, 6> covariance) {
    const auto of = [](const std::array<double, 6>& c) {
        const double xx = c[3] * c[5] - c[4] * c[4], xy = c[2] * c[4] - c[1] * c[5],
                     xz = c[1] * c[4] - c[2] * c[3], yy = c[0] * c[5] - c[2] * c[2],
                     yz = c[1] * c[2] - c[0] * c[4], zz = c[0] * c[3] - c[1] * c[1];
        return Adjugate{{xx, xy, xz, yy, yz, zz}, c[0] * xx + c[1] * xy + c[2] * xz};
    };
    // Its rounding errors are near 1e-16 of the product of the variances.
    constexpr double kLeast = 1e-14, kWidening = 1e-6;
    auto& c = covariance;
    const Adjugate adjugate = of(c);
    if (adjugate.determinant > kLeast * c[0] * c[3] * c[5]) return adjugate;
    const double wider = kWidening * (c[0] + c[3] + c[5]);
    c[0] += wider, c[3] += wider, c[5] += wider;
    return of(c);
}

}  // namespace vog::moments
