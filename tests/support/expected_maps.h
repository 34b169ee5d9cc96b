// expected_maps.h: pixels of maps of a field from sums in double precision.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "render/shown_field.h"
#include "vog/field_maps.h"

namespace vog::test {

/// Column, mean and deviation of a pixel.
struct Expected {
    double column = 0, mean = 0, deviation = 0;
};
inline Expected expected(const std::vector<FieldSums>& parts) {
    // The mean first: squares of a field that hardly varies lose digits even in double precision.
    Expected all;
    double first = 0, second = 0;
    for (const FieldSums& sums : parts) all.column += sums.column, first += sums.first;
    if (all.column == 0) return all;
    all.mean = first / all.column;
    for (const FieldSums& sums : parts)
        second += sums.second - 2 * all.mean * sums.first + all.mean * all.mean * sums.column;
    all.deviation = std::sqrt(std::max(second / all.column, 0.0));
    return all;
}
/// Root mean square and three-dimensional dispersion, from the three components.
inline Expected magnitude_of(const std::function<Expected(FieldPart)>& component) {
    double square = 0, variance = 0, column = 0;
    for (const FieldPart part : {FieldPart::x, FieldPart::y, FieldPart::z}) {
        const Expected one = component(part);
        column = one.column;
        variance += one.deviation * one.deviation;
        square += one.mean * one.mean + one.deviation * one.deviation;
    }
    return {column, std::sqrt(square), std::sqrt(variance)};
}

}  // namespace vog::test
