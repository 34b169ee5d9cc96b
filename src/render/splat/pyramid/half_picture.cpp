// half_picture.cpp: cubic interpolation of pixels, and its error.
#include "render/splat/pyramid/half_picture.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/parallel.h"

namespace vog::splat {

namespace {

/// A pixel of f(member) for each of its members.
template <class F>
Rgba each_channel(const F& f) {
    return {f(&Rgba::r), f(&Rgba::g), f(&Rgba::b), f(&Rgba::a)};
}

/// Half way between the middle two of four pixels in a row, by the cubic through them; within [0, 1].
Rgba between(const Rgba& a, const Rgba& b, const Rgba& c, const Rgba& d) {
    return each_channel([&](float Rgba::*n) {
        return std::clamp((9 * (b.*n + c.*n) - (a.*n + d.*n)) * (1 / 16.0f), 0.0f, 1.0f);
    });
}

/// Largest fourth difference of five pixels in a row, over their channels.
float fourth_difference(const Rgba& a, const Rgba& b, const Rgba& c, const Rgba& d, const Rgba& e) {
    const Rgba most = each_channel(
        [&](float Rgba::*n) { return std::abs(a.*n + e.*n - 4 * (b.*n + d.*n) + 6 * c.*n); });
    return std::max(std::max(most.r, most.g), std::max(most.b, most.a));
}

/// A picture at half the resolution, read beyond its edges, too.
struct Samples {
    std::span<const Rgba> pixel;
    int width, height;

    std::span<const Rgba> row(int y) const {
        return pixel.subspan(static_cast<std::size_t>(std::clamp(y, 0, height - 1)) *
                                 static_cast<std::size_t>(width),
                             static_cast<std::size_t>(width));
    }
    std::size_t column(int x) const {
        return static_cast<std::size_t>(std::clamp(x, 0, width - 1));
    }
};

/// Whether each pixel of a row of samples differs from a cubic through its neighbours by more than the limit.
void find_uneven(const Samples& samples, int y, float limit, std::span<char> uneven) {
    std::span<const Rgba> rows[5];
    for (int n = 0; n < 5; ++n) rows[n] = samples.row(y + n - 2);
    const std::span<const Rgba> row = rows[2];
    for (int x = 0; x < samples.width; ++x) {
        const auto at = static_cast<std::size_t>(x);
        const auto beside = [&](int by) -> const Rgba& { return row[samples.column(x + by)]; };
        const float down =
            fourth_difference(rows[0][at], rows[1][at], row[at], rows[3][at], rows[4][at]);
        const float across =
            fourth_difference(beside(-2), beside(-1), row[at], beside(1), beside(2));
        uneven[at] = std::max(down, across) > limit;
    }
}

/// Fills a row of the picture from samples in the row, every second pixel of which these are.
void fill_row(std::span<const Rgba> samples, std::span<Rgba> row) {
    for (std::size_t x = 0; x + 1 < row.size(); x += 2) {
        const Rgba* at = &samples[x / 2 + kHalfMargin];
        row[x] = at[0];
        row[x + 1] = between(at[-1], at[0], at[1], at[2]);
    }
    if (row.size() % 2 == 1) row.back() = samples[row.size() / 2 + kHalfMargin];
}

/// A band of the picture as high as a cell.
struct Band {
    const Samples& samples;
    VolumeImage& picture;
    int first;  ///< row

    int end() const { return std::min(first + kCellHeight, picture.height); }
    void fill() const;
    void find(float limit, CellRows& drawn) const;
};

void Band::fill() const {
    const auto width = static_cast<std::size_t>(picture.width);
    std::vector<Rgba> beside(static_cast<std::size_t>(samples.width));
    const auto row = [&](int n) {
        return std::span(picture.pixel).subspan(static_cast<std::size_t>(n) * width, width);
    };
    for (int y = first; y < end(); y += 2) {
        const int at = y / 2 + kHalfMargin;
        fill_row(samples.row(at), row(y));
        if (y + 1 == picture.height) return;
        const std::span<const Rgba> rows[4] = {samples.row(at - 1), samples.row(at),
                                               samples.row(at + 1), samples.row(at + 2)};
        for (std::size_t x = 0; x < beside.size(); ++x)
            beside[x] = between(rows[0][x], rows[1][x], rows[2][x], rows[3][x]);
        fill_row(beside, row(y + 1));
    }
}

void Band::find(float limit, CellRows& drawn) const {
    // Samples of the band, and those around it that its pixels lie between.
    constexpr int kRows = kCellHeight / 2 + 3;
    const auto width = static_cast<std::size_t>(samples.width);
    std::vector<char> uneven(kRows * width);
    for (int n = 0; n < kRows; ++n)
        find_uneven(samples, first / 2 + kHalfMargin - 1 + n, limit,
                    std::span(uneven).subspan(static_cast<std::size_t>(n) * width, width));
    for (int y = first; y < end(); y += 2)
        for (int x = 0; x < picture.width; x += kCellWidth) {
            const std::size_t from = samples.column(x / 2 + kHalfMargin - 1);
            const std::size_t to = samples.column(x / 2 + kHalfMargin + kCellWidth / 2 + 1) + 1;
            bool any = false;
            for (std::size_t n = 0; n < 4; ++n) {
                const auto row =
                    uneven.begin() + static_cast<std::ptrdiff_t>(
                                         (static_cast<std::size_t>(y - first) / 2 + n) * width);
                any |= std::any_of(row + static_cast<std::ptrdiff_t>(from),
                                   row + static_cast<std::ptrdiff_t>(to),
                                   [](char c) { return c != 0; });
            }
            if (any) drawn.of(x, first) |= std::uint32_t{3} << static_cast<unsigned>(y - first);
        }
}

}  // namespace

CameraFrame half_frame(const CameraFrame& frame) {
    CameraFrame half = frame;
    const double shift = -2 * kHalfMargin;
    half.corner = frame.direction(shift, shift);
    half.first_origin = frame.origin(shift, shift);
    for (Vec3d* step : {&half.step_x, &half.step_y, &half.shift_x, &half.shift_y})
        *step = 2.0 * *step;
    half.pixels_per_unit = frame.pixels_per_unit / 2;
    // A cubic has two samples on either side.
    half.width = (frame.width + 1) / 2 + kHalfMargin + 2;
    half.height = (frame.height + 1) / 2 + kHalfMargin + 2;
    return half;
}

CellRows::CellRows(int width, int height)
    : columns_(static_cast<std::size_t>((width + kCellWidth - 1) / kCellWidth)),
      rows_(columns_ * static_cast<std::size_t>((height + kCellHeight - 1) / kCellHeight)) {}

CellRows fill_from_half(const VolumeImage& half, double precision, VolumeImage& picture) {
    // The cubic through four samples of a function f misses its middle by 3/128 of the fourth difference; where f is not smooth,
    // by up to a seventh of it.
    constexpr double kPerDifference = 1 / 32.0;
    const Samples samples{half.pixel, half.width, half.height};
    const auto limit = static_cast<float>(precision / kPerDifference);
    CellRows drawn(picture.width, picture.height);
    vog::parallel_for(0, (picture.height + kCellHeight - 1) / kCellHeight, [&](int n) {
        const Band band{samples, picture, n * kCellHeight};
        band.fill();
        band.find(limit, drawn);
    });
    return drawn;
}

float least_half_axis(const FarSplat& s) {
    // Of the larger eigenvalue of the quadratic form by + ax + ay.
    const float xx = s.ax * s.ax, xy = s.ax * s.ay, yy = s.ay * s.ay + s.by * s.by;
    const float middle = 0.5f * (xx + yy), half = 0.5f * (xx - yy);
    return std::sqrt(s.f0 / std::max(middle + std::sqrt(half * half + xy * xy), 1e-30f));
}

}  // namespace vog::splat
