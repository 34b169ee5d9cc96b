// vog/compare_maps.h: differences between maps of a field, and the files of maps that `vog render --values-out`
// writes. The first argument is always the reference. Definitions: docs/evaluation.md, "Figures of fields".
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "vog/field_maps.h"

namespace vog {

/// Difference of one map from the reference over the pixels where the reference has a value.
struct MapDifference {
    double relative_l2 = 0;  ///< |a - b|₂ / |b|₂ of image a and reference b, >= 0; both 0: 0
    double bias = 0;         ///< mean of a - b, in the map's unit
    double largest = 0;      ///< a - b of largest magnitude, with its sign
    /// Pixel of `largest`, from the top left, counted from 0; the first of several.
    int largest_column = 0, largest_row = 0;
    double counted = 0;  ///< share of all pixels that count, [0, 1]
    double missing =
        0;  ///< share of the counted pixels where the image has no value; it counts as 0 there
};
/// Compares two maps; NaN: no value.
/// throws  vog::Error if the sizes differ, or the reference has no value
[[nodiscard]] MapDifference compare(const ValueMap& reference, const ValueMap& image);

/// Difference of the maps of a field where the reference's column is at least a thousandth of its largest.
/// Pixels weigh by the reference's column.
struct FieldDifference {
    double column_l2 = 0;  ///< relative L2 of the column, unweighted, over all pixels
    double mean_l2 = 0;    ///< |mean - mean_ref| / |mean_ref|
    /// |deviation - deviation_ref| / rms, rms² = |mean_ref|² + |deviation_ref|²: the root mean square value
    /// of the field.
    double deviation_l2 = 0;
    double mean_bias = 0;       ///< weighted mean of mean - mean_ref, in the field's unit
    double deviation_bias = 0;  ///< mean difference of the deviation
    double largest_mean = 0;    ///< mean - mean_ref of largest magnitude, with its sign
    int largest_column = 0, largest_row = 0;  ///< its pixel
    double counted = 0;                       ///< share of all pixels that count, [0, 1]
    double missing =
        0;  ///< share of their weight where the image has no column; its field counts as 0
};
/// throws  vog::Error if the sizes differ, or the reference has no column
[[nodiscard]] FieldDifference compare(const FieldMaps& reference, const FieldMaps& image);

/// Whether a file holds maps: .npy, or an EXR of the channels column, mean and deviation; by contents.
/// throws  vog::Error if it cannot be read
bool is_map_file(const std::filesystem::path& file);
/// Whether a file of maps holds all three maps of a field.
bool is_field_file(const std::filesystem::path& file);
/// Reads a map [height, width] of float32 or float64, NumPy's format 1 or 2; float64 is rounded.
/// throws  vog::Error for other contents
ValueMap read_map(const std::filesystem::path& file);
/// Reads the channels column, mean and deviation of an EXR.
/// throws  vog::Error for other contents
FieldMaps read_field_maps(const std::filesystem::path& file);

}  // namespace vog
