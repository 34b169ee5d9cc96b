// color_spaces.cpp: interpolation in CIE Lab, HSV, and Moreland's polar Lab ("Msh").
// Sources: IEC 61966-2-1 (sRGB), CIE 15 (Lab); K. Moreland, "Diverging Color Maps for Scientific
// Visualization", ISVC 2009, for Msh and its rules. The rounded constants (0.008856, 7.787, the
// white point 0.9505 1 1.089) are VTK's, so that colours agree with ParaView's.
#include "shade/color_spaces.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace vog::shading {
namespace {

using std::numbers::pi;

constexpr Color kWhite{0.9505, 1.0, 1.089};  ///< D65, 2 degree observer

Color lerp(const Color& a, const Color& b, double s) {
    return {(1 - s) * a[0] + s * b[0], (1 - s) * a[1] + s * b[1], (1 - s) * a[2] + s * b[2]};
}

double linear_from_display(double c) {
    return c > 0.04045 ? std::pow((c + 0.055) / 1.055, 2.4) : c / 12.92;
}
double display_from_linear(double c) {
    return c > 0.0031308 ? 1.055 * std::pow(c, 1 / 2.4) - 0.055 : 12.92 * c;
}

Color lab_from_rgb(const Color& rgb) {
    const double r = linear_from_display(rgb[0]), g = linear_from_display(rgb[1]),
                 b = linear_from_display(rgb[2]);
    const Color xyz{0.4124 * r + 0.3576 * g + 0.1805 * b, 0.2126 * r + 0.7152 * g + 0.0722 * b,
                    0.0193 * r + 0.1192 * g + 0.9505 * b};
    const auto f = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116.0; };
    const double x = f(xyz[0] / kWhite[0]), y = f(xyz[1] / kWhite[1]), z = f(xyz[2] / kWhite[2]);
    return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

Color rgb_from_lab(const Color& lab) {
    const auto inverse_f = [](double t) {
        const double cube = t * t * t;
        return cube > 0.008856 ? cube : (t - 16.0 / 116.0) / 7.787;
    };
    const double fy = (lab[0] + 16) / 116;
    const double x = kWhite[0] * inverse_f(fy + lab[1] / 500), y = kWhite[1] * inverse_f(fy),
                 z = kWhite[2] * inverse_f(fy - lab[2] / 200);
    Color rgb{display_from_linear(3.2406 * x - 1.5372 * y - 0.4986 * z),
              display_from_linear(-0.9689 * x + 1.8758 * y + 0.0415 * z),
              display_from_linear(0.0557 * x - 0.2040 * y + 1.0570 * z)};
    // Outside the display's gamut: bright colours are scaled, negative components set to 0.
    const double brightest = std::max({rgb[0], rgb[1], rgb[2], 1.0});
    for (double& c : rgb) c = std::max(c / brightest, 0.0);
    return rgb;
}

/// (M, s, h): length of the Lab vector, its angle from the grey axis, its hue; radians.
Color msh_from_lab(const Color& lab) {
    constexpr double kZero = 0.001;
    const double m = std::hypot(lab[0], lab[1], lab[2]);
    const double s = m > kZero ? std::acos(lab[0] / m) : 0;
    return {m, s, s > kZero ? std::atan2(lab[2], lab[1]) : 0};
}
Color lab_from_msh(const Color& msh) {
    const double chroma = msh[0] * std::sin(msh[1]);
    return {msh[0] * std::cos(msh[1]), chroma * std::cos(msh[2]), chroma * std::sin(msh[2])};
}

/// Hue of an unsaturated colour of length `m` that gives an even change of hue towards `saturated`.
double hue_towards(const Color& saturated, double m) {
    if (saturated[0] >= m - 0.1) return saturated[2];
    const double spin = saturated[1] * std::sqrt(m * m - saturated[0] * saturated[0]) /
                        (saturated[0] * std::sin(saturated[1]));
    return saturated[2] > -0.3 * pi ? saturated[2] + spin : saturated[2] - spin;  // avoids purple
}

Color interpolate_diverging(const Color& from, const Color& to, double s) {
    constexpr double kSaturated = 0.05, kDistinct = 0.33 * pi, kMinWhite = 88;
    Color a = msh_from_lab(lab_from_rgb(from)), b = msh_from_lab(lab_from_rgb(to));
    double apart = std::abs(a[2] - b[2]);
    if (apart > pi) apart = 2 * pi - apart;

    // Between two saturated colours of distinct hue, the map passes through white.
    if (a[1] > kSaturated && b[1] > kSaturated && apart > kDistinct) {
        const Color white{std::max({a[0], b[0], kMinWhite}), 0, 0};
        if (s < 0.5) {
            b = white, s = 2 * s;
        } else {
            a = white, s = 2 * s - 1;
        }
    }
    if (a[1] < kSaturated && b[1] > kSaturated)
        a[2] = hue_towards(b, a[0]);
    else if (b[1] < kSaturated && a[1] > kSaturated)
        b[2] = hue_towards(a, b[0]);
    return rgb_from_lab(lab_from_msh(lerp(a, b, s)));
}

Color hsv_from_rgb(const Color& rgb) {
    const double value = std::max({rgb[0], rgb[1], rgb[2]});
    const double range = value - std::min({rgb[0], rgb[1], rgb[2]});
    if (range <= 0) return {0, 0, value};
    double sixths = 0;
    if (rgb[0] == value)
        sixths = (rgb[1] - rgb[2]) / range;
    else if (rgb[1] == value)
        sixths = 2 + (rgb[2] - rgb[0]) / range;
    else
        sixths = 4 + (rgb[0] - rgb[1]) / range;
    return {sixths < 0 ? sixths / 6 + 1 : sixths / 6, range / value, value};
}

Color rgb_from_hsv(const Color& hsv) {
    // A primary is 1 within a sixth of its own hue, falls to 0 at two sixths.
    const auto primary = [&](double hue) {
        double away = std::abs(hsv[0] - hue);
        away = std::min(away, 1 - away) * 6;
        return hsv[2] * (1 - hsv[1] + hsv[1] * std::clamp(2 - away, 0.0, 1.0));
    };
    return {primary(0), primary(1.0 / 3), primary(2.0 / 3)};
}

Color interpolate_hsv(const Color& from, const Color& to, double s, bool wrapped) {
    Color a = hsv_from_rgb(from), b = hsv_from_rgb(to);
    if (wrapped && std::abs(a[0] - b[0]) > 0.5) (a[0] > b[0] ? a : b)[0] -= 1;
    Color hsv = lerp(a, b, s);
    if (hsv[0] < 0) hsv[0] += 1;
    return rgb_from_hsv(hsv);
}

using Sample = std::pair<double, Color>;

/// Appends samples in (from, to] whose linear interpolation is close to the curve.
void bisect(const std::function<Color(double)>& curve, const Sample& from, const Sample& to,
            int depth, std::vector<Sample>& samples) {
    constexpr double kTolerance = 0.25 / 255;
    bool straight = true;
    for (const double part : {0.25, 0.5, 0.75}) {
        const Color line = lerp(from.second, to.second, part);
        const Color exact = curve(from.first + part * (to.first - from.first));
        for (int c = 0; c < 3; ++c) straight &= std::abs(exact[c] - line[c]) <= kTolerance;
    }
    if (straight || depth == 0) return samples.push_back(to);
    const double middle = (from.first + to.first) / 2;
    const Sample between{middle, curve(middle)};
    bisect(curve, from, between, depth - 1, samples);
    bisect(curve, between, to, depth - 1, samples);
}

}  // namespace

Color interpolate(ColorSpace space, const Color& from, const Color& to, double s) {
    switch (space) {
        case ColorSpace::kHsv:
            return interpolate_hsv(from, to, s, false);
        case ColorSpace::kHsvWrapped:
            return interpolate_hsv(from, to, s, true);
        case ColorSpace::kLab:
            return rgb_from_lab(lerp(lab_from_rgb(from), lab_from_rgb(to), s));
        case ColorSpace::kDiverging:
            return interpolate_diverging(from, to, s);
        case ColorSpace::kRgb:
            break;
    }
    return lerp(from, to, s);
}

std::vector<std::pair<double, Color>> sample_curve(const std::function<Color(double)>& curve) {
    // Eight pieces first: the three test points of bisect could miss a feature narrower than 1/32.
    constexpr int kPieces = 8, kDepth = 10;
    std::vector<Sample> samples;
    Sample from{0, curve(0)};
    for (int piece = 1; piece <= kPieces; ++piece) {
        const double s = static_cast<double>(piece) / kPieces;
        const Sample to{s, curve(s)};
        bisect(curve, from, to, kDepth, samples);
        from = to;
    }
    return samples;
}

std::vector<ColorPoint> sample_colors(ColorSpace space, const std::vector<ColorPoint>& control) {
    if (space == ColorSpace::kRgb) return control;
    std::vector<ColorPoint> points{control.front()};
    for (std::size_t i = 1; i < control.size(); ++i) {
        const ColorPoint &a = control[i - 1], &b = control[i];
        const Color from{a.r, a.g, a.b}, to{b.r, b.g, b.b};
        if (b.v > a.v) {
            const auto samples =
                sample_curve([&](double s) { return interpolate(space, from, to, s); });
            for (const auto& [s, color] : samples)
                points.push_back({static_cast<float>(a.v + s * (double{b.v} - a.v)),
                                  static_cast<float>(color[0]), static_cast<float>(color[1]),
                                  static_cast<float>(color[2])});
            points.pop_back();  // the last sample is the control point, up to rounding
        }
        points.push_back(b);
    }
    return points;
}

}  // namespace vog::shading
