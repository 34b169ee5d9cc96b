// compare.cpp: Error metrics between two images or two depth images.
#include "vog/compare.h"

#include <cstdlib>
#include <limits>

#include "compare/grey.h"
#include "compare/ssim.h"

namespace vog {

using namespace comparison;

namespace {

/// Fills all metrics except SSIM.
/// channels  values a pixel in `reference` and `image`
PictureDifference compare_bytes(const std::uint8_t* reference, const std::uint8_t* image,
                                std::size_t pixels, int channels, int width) {
    PictureDifference difference;
    std::uint64_t squares = 0, off_1 = 0, off_4 = 0;  // integers: exact in any order
    for (std::size_t n = 0; n < pixels; ++n) {
        int largest = 0;
        for (int c = 0; c < channels; ++c) {
            const int delta = std::abs(int{*image++} - int{*reference++});
            squares += static_cast<std::uint64_t>(delta * delta);
            largest = std::max(largest, delta);
        }
        off_1 += largest > 1;
        off_4 += largest > 4;
        if (largest > difference.largest) {
            difference.largest = largest;
            difference.largest_column = static_cast<int>(n % static_cast<std::size_t>(width));
            difference.largest_row = static_cast<int>(n / static_cast<std::size_t>(width));
        }
    }
    const auto count = static_cast<double>(pixels);
    const double mean_square = static_cast<double>(squares) / (count * channels);
    difference.psnr_db = squares ? 10 * std::log10(255.0 * 255.0 / mean_square)
                                 : std::numeric_limits<double>::infinity();
    difference.share_off_1 = static_cast<double>(off_1) / count;
    difference.share_off_4 = static_cast<double>(off_4) / count;
    return difference;
}

/// ITU-R BT.601, the weights of the common conversions of colours to grey.
std::vector<float> luma(const std::vector<Rgb8>& pixels) {
    std::vector<float> values(pixels.size());
    for (std::size_t n = 0; n < pixels.size(); ++n) {
        const std::uint8_t* c = pixels[n].channel;
        values[n] = static_cast<float>(0.299 * c[0] + 0.587 * c[1] + 0.114 * c[2]);
    }
    return values;
}

/// Sums over T in double precision, in pixel order.
void compare_depths(const DepthImage& reference, const DepthImage& image,
                    DepthDifference& difference) {
    const double factor = to_extinction_of(reference, image);
    double sum = 0, sum_ref = 0, squares = 0, squares_ref = 0;
    for (std::size_t n = 0; n < reference.depth.size(); ++n) {
        const double t = factor * static_cast<double>(image.depth[n]);
        const double t_ref = static_cast<double>(reference.depth[n]);
        const double dt = t - t_ref;
        sum += t;
        sum_ref += t_ref;
        squares += dt * dt;
        squares_ref += t_ref * t_ref;
        if (std::abs(dt) > std::abs(difference.largest_dt)) {
            const auto width = static_cast<std::size_t>(reference.width);
            difference.largest_dt = dt;
            difference.largest_column = static_cast<int>(n % width);
            difference.largest_row = static_cast<int>(n / width);
        }
    }
    const auto ratio = [](double a, double b, double where_both_zero) {
        return b > 0 ? a / b : a == 0 ? where_both_zero : std::numeric_limits<double>::infinity();
    };
    difference.relative_l2 = ratio(std::sqrt(squares), std::sqrt(squares_ref), 0);
    difference.bias = ratio(sum, sum_ref, 1);
    difference.identical = squares == 0;
}

}  // namespace

PictureDifference compare(const Image& reference, const Image& image) {
    require_same_size(reference, image);
    const std::vector<Rgb8> a = color_bytes(reference), b = color_bytes(image);
    PictureDifference difference =
        compare_bytes(a.front().channel, b.front().channel, a.size(), 3, reference.width);
    difference.ssim = structural_similarity(luma(a), luma(b), reference.width, reference.height);
    return difference;
}

DepthDifference compare(const DepthImage& reference, const DepthImage& image) {
    require_same_size(reference, image);
    DepthDifference difference;
    difference.extinction = reference.extinction;
    compare_depths(reference, image, difference);

    const std::vector<std::uint8_t> a = grey_bytes(reference, 1);
    const std::vector<std::uint8_t> b = grey_bytes(image, to_extinction_of(reference, image));
    difference.grey = compare_bytes(a.data(), b.data(), a.size(), 1, reference.width);
    difference.grey.ssim = structural_similarity({a.begin(), a.end()}, {b.begin(), b.end()},
                                                 reference.width, reference.height);
    return difference;
}

PictureDifference compare_shaded(const DepthImage& reference, const DepthImage& image,
                                 const TransferFunction& tf) {
    require_same_size(reference, image);
    DepthImage same = image;
    set_extinction(same, reference.extinction);
    return compare(shade(reference, tf), shade(same, tf));
}

}  // namespace vog
