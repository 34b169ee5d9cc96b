// ssim.cpp: Structural similarity by separable windows, filtered along rows, then columns.
#include "compare/ssim.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "core/parallel.h"

namespace vog::comparison {

namespace {

constexpr int kWindow = 11;
constexpr double kSigma = 1.5;

std::array<double, kWindow> window() {
    std::array<double, kWindow> weight;
    double sum = 0;
    for (int n = 0; n < kWindow; ++n) {
        const double x = n - kWindow / 2;
        sum += weight[static_cast<std::size_t>(n)] = std::exp(-x * x / (2 * kSigma * kSigma));
    }
    for (double& w : weight) w /= sum;
    return weight;
}

/// Weighted sums of a, b, a², b² and ab.
struct Moments {
    double a = 0, b = 0, aa = 0, bb = 0, ab = 0;

    void add(double weight, const Moments& m) {
        a += weight * m.a;
        b += weight * m.b;
        aa += weight * m.aa;
        bb += weight * m.bb;
        ab += weight * m.ab;
    }
};

/// Equation 13: luminance times contrast and structure.
double similarity(const Moments& m) {
    constexpr double kC1 = (0.01 * 255) * (0.01 * 255), kC2 = (0.03 * 255) * (0.03 * 255);
    const double variances = m.aa - m.a * m.a + m.bb - m.b * m.b, covariance = m.ab - m.a * m.b;
    return (2 * m.a * m.b + kC1) * (2 * covariance + kC2) /
           ((m.a * m.a + m.b * m.b + kC1) * (variances + kC2));
}

/// Sum of the similarities of `rows` rows of windows from row `top` on.
double similarity_of_band(const float* reference, const float* image, int width, int top,
                          int rows) {
    static const auto weight = window();
    const auto columns = static_cast<std::size_t>(width - kWindow + 1);
    std::vector<Moments> across(columns * static_cast<std::size_t>(rows + kWindow - 1));
    const std::size_t start = static_cast<std::size_t>(top) * static_cast<std::size_t>(width);
    for (std::size_t n = 0; n < across.size(); ++n) {
        const std::size_t first =
            start + n / columns * static_cast<std::size_t>(width) + n % columns;
        for (std::size_t k = 0; k < kWindow; ++k) {
            const double a = static_cast<double>(reference[first + k]);
            const double b = static_cast<double>(image[first + k]);
            across[n].add(weight[k], {a, b, a * a, b * b, a * b});
        }
    }
    double total = 0;
    for (std::size_t n = 0; n < columns * static_cast<std::size_t>(rows); ++n) {
        Moments sum;
        for (std::size_t k = 0; k < kWindow; ++k) sum.add(weight[k], across[n + k * columns]);
        total += similarity(sum);
    }
    return total;
}

}  // namespace

double structural_similarity(const std::vector<float>& reference, const std::vector<float>& image,
                             int width, int height) {
    const int columns = width - kWindow + 1, rows = height - kWindow + 1;
    if (columns < 1 || rows < 1) return std::numeric_limits<double>::quiet_NaN();

    // Bands of rows bound the memory; their sums are added in order, so that the result is the same
    // for any number of threads.
    constexpr int kBandRows = 32;
    std::vector<double> band_sum(static_cast<std::size_t>((rows + kBandRows - 1) / kBandRows));
    vog::parallel_for(std::size_t{0}, band_sum.size(), [&](std::size_t band) {
        const int top = static_cast<int>(band) * kBandRows;
        band_sum[band] = similarity_of_band(reference.data(), image.data(), width, top,
                                            std::min(kBandRows, rows - top));
    });
    double total = 0;
    for (const double sum : band_sum) total += sum;
    return total / (static_cast<double>(columns) * static_cast<double>(rows));
}

}  // namespace vog::comparison
