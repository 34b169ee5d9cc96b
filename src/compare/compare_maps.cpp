// compare_maps.cpp: weighted differences of maps of a field.
#include "vog/compare_maps.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "vog/error.h"

namespace vog {

namespace {

void require_same_size(int width, int height, int other_width, int other_height) {
    if (width != other_width || height != other_height)
        throw Error(fmt::format("maps of {}x{} and {}x{} pixels, expected the same size", width,
                                height, other_width, other_height));
}

/// |difference| / |whole|; 0 of two zeros.
double ratio(double difference2, double whole2) {
    return difference2 > 0 ? std::sqrt(difference2 / whole2) : 0;
}

double relative_l2(const std::vector<float>& reference, const std::vector<float>& image) {
    double difference = 0, whole = 0;
    for (std::size_t n = 0; n < reference.size(); ++n) {
        const double b{reference[n]}, d = double{image[n]} - b;
        difference += d * d;
        whole += b * b;
    }
    return ratio(difference, whole);
}

}  // namespace

MapDifference compare(const ValueMap& reference, const ValueMap& image) {
    require_same_size(reference.width, reference.height, image.width, image.height);
    MapDifference result;
    double count = 0, difference2 = 0, whole2 = 0, sum = 0, missing = 0;
    for (std::size_t n = 0; n < reference.value.size(); ++n) {
        const double b{reference.value[n]};
        if (std::isnan(b)) continue;
        const bool none = std::isnan(image.value[n]);
        const double d = (none ? 0 : double{image.value[n]}) - b;
        ++count;
        missing += none;
        difference2 += d * d;
        whole2 += b * b;
        sum += d;
        if (std::abs(d) <= std::abs(result.largest)) continue;
        result.largest = d;
        const auto width = static_cast<std::size_t>(reference.width);
        result.largest_column = static_cast<int>(n % width);
        result.largest_row = static_cast<int>(n / width);
    }
    if (count == 0) throw Error("the reference has no value at any pixel, expected at least one");
    result.relative_l2 = ratio(difference2, whole2);
    result.bias = sum / count;
    result.counted = count / static_cast<double>(reference.value.size());
    result.missing = missing / count;
    return result;
}

FieldDifference compare(const FieldMaps& reference, const FieldMaps& image) {
    require_same_size(reference.width, reference.height, image.width, image.height);
    const double most{*std::ranges::max_element(reference.column)};
    if (!(most > 0)) throw Error("the reference has no column at any pixel, expected at least one");
    FieldDifference result;
    result.column_l2 = relative_l2(reference.column, image.column);
    double count = 0, weights = 0, missing = 0, mean2 = 0, deviation2 = 0;
    double mean_difference2 = 0, deviation_difference2 = 0;
    for (std::size_t n = 0; n < reference.column.size(); ++n) {
        const double w{reference.column[n]}, mean{reference.mean[n]};
        const double deviation{reference.deviation[n]};
        if (w < 1e-3 * most) continue;
        const bool none = std::isnan(image.mean[n]);
        const double d_mean = (none ? 0 : double{image.mean[n]}) - mean;
        const double d_deviation = (none ? 0 : double{image.deviation[n]}) - deviation;
        ++count;
        weights += w;
        missing += none ? w : 0;
        mean2 += w * mean * mean;
        deviation2 += w * deviation * deviation;
        mean_difference2 += w * d_mean * d_mean;
        deviation_difference2 += w * d_deviation * d_deviation;
        result.mean_bias += w * d_mean;
        result.deviation_bias += w * d_deviation;
        if (std::abs(d_mean) <= std::abs(result.largest_mean)) continue;
        result.largest_mean = d_mean;
        const auto width = static_cast<std::size_t>(reference.width);
        result.largest_column = static_cast<int>(n % width);
        result.largest_row = static_cast<int>(n / width);
    }
    result.mean_l2 = ratio(mean_difference2, mean2);
    result.deviation_l2 = ratio(deviation_difference2, mean2 + deviation2);
    result.mean_bias /= weights;
    result.deviation_bias /= weights;
    result.counted = count / static_cast<double>(reference.column.size());
    result.missing = missing / weights;
    return result;
}

}  // namespace vog
