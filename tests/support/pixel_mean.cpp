// pixel_mean.cpp: widens thin Gaussians, then divides them by their sum over pixel centres.
#include "support/pixel_mean.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "render/ray_gaussian.h"

namespace vog::test {

namespace {

Mat3 outer(Vec3d v) {
    Mat3 m;
    for (std::size_t r = 0; r < 3; ++r) m.row[r] = v[static_cast<int>(r)] * v;
    return m;
}
Mat3 sum(const Mat3& a, double s, const Mat3& b) {
    Mat3 m;
    for (std::size_t r = 0; r < 3; ++r) m.row[r] = a.row[r] + s * b.row[r];
    return m;
}
/// Upper triangular U with Uᵀ U = m, m symmetric and positive.
Mat3 root(const Mat3& m) {
    Mat3 u;
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) u(r, c) = 0;
    for (int r = 0; r < 3; ++r)
        for (int c = r; c < 3; ++c) {
            double rest = m(r, c);
            for (int n = 0; n < r; ++n) rest -= u(n, r) * u(n, c);
            u(r, c) = c == r ? std::sqrt(rest) : rest / u(r, r);
        }
    return u;
}
double tapered(double value, double from, double to) {
    return std::clamp((to - value) / (to - from), 0.0, 1.0);
}

/// Screen covariance, pixels², by the gradients of column and row at the mean.
struct ScreenCovariance {
    double xx, xy, yy, large, small;
};
ScreenCovariance screen_covariance(const Mat3& covariance, Vec3d column, Vec3d row) {
    ScreenCovariance s{};
    s.xx = dot(column, covariance * column), s.xy = dot(column, covariance * row);
    s.yy = dot(row, covariance * row);
    const double middle = 0.5 * (s.xx + s.yy), radius = std::hypot(0.5 * (s.xx - s.yy), s.xy);
    s.large = middle + radius, s.small = middle - radius;
    return s;
}

}  // namespace

PixelMean pixel_mean(const Gaussians& model, std::size_t i, const CameraFrame& frame) {
    constexpr double kLeast = 0.5, kSampled = 2, kTaper = 1.75;
    const double k = model.cutoff, variance = variance_within(k);
    PixelMean out;
    out.w = whitening(model, i);
    out.density = model.density[i];
    const Vec3d p = world_mean(model, i) - frame.eye;
    const double z = dot(p, frame.forward), per_pixel = 1 / frame.pixels_at(z);
    const Mat3 axes = inverse(out.w);
    Mat3 covariance = axes * transpose(axes);
    const double depth = std::sqrt(dot(frame.forward, covariance * frame.forward));
    if (z < 1.01 * k * depth) return out;

    const double slanted = frame.orthographic ? 0 : 1;  // 0: rays have no slope
    const Vec3d column =
        (1 / per_pixel) * (frame.right - (slanted * dot(p, frame.right) / z) * frame.forward);
    const Vec3d row =
        (1 / per_pixel) * (frame.up - (slanted * dot(p, frame.up) / z) * frame.forward);
    ScreenCovariance screen = screen_covariance(covariance, column, row);
    const double least = kLeast * kLeast / variance;
    if (screen.small < least) {
        out.widened = true;
        const double angle = 0.5 * std::atan2(2 * screen.xy, screen.xx - screen.yy);
        for (const bool large : {false, true}) {
            const double turn = large ? angle : angle + 0.5 * std::numbers::pi;
            const Vec3d b = per_pixel * (std::cos(turn) * frame.right + std::sin(turn) * frame.up);
            const double more = least - (large ? screen.large : screen.small);
            covariance = sum(covariance, std::max(more, 0.0), outer(b));
        }
        const Mat3 w = root(inverse(covariance));
        out.density *= std::abs(determinant(w) / determinant(out.w));
        out.w = w;
        screen = screen_covariance(covariance, column, row);
    }

    const double deviation = std::sqrt(std::max(screen.small, 0.0) * variance);
    const double half = k * std::sqrt(std::max(screen.xx, screen.yy));
    const double share = tapered(deviation, kTaper, kSampled) * tapered(half, 5, 6) *
                         tapered(slanted * k * depth / z, 0.1, 0.2);
    if (share == 0) return out;
    // The sum over an endless image around the mean.
    const double x = dot(p, frame.right) / per_pixel + 0.5 * (frame.width - 1);
    const double y = 0.5 * (frame.height - 1) - dot(p, frame.up) / per_pixel;
    double total = 0;
    constexpr int kReach = 9;
    for (int down = -kReach; down <= kReach; ++down)
        for (int right = -kReach; right <= kReach; ++right) {
            const double at_x = std::round(x) + right, at_y = std::round(y) + down;
            const Vec3d e = world_mean(model, i) - frame.origin(at_x, at_y);
            total += segment_integral(out.w * e, out.w * frame.direction(at_x, at_y), k);
        }
    const double integral = std::pow(2 * std::numbers::pi, 1.5) * mass_within(k) /
                            std::abs(determinant(out.w)) / (per_pixel * per_pixel) *
                            (1 + slanted * 3 * variance * depth * depth / (z * z));
    out.density /= 1 + share * (total / integral - 1);
    return out;
}

}  // namespace vog::test
