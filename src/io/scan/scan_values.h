// scan_values.h: values of raw, deflated and text data as floats. Sizes are checked against the file before memory
// is allocated.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/float_of.h"
#include "io/scan/scan_bytes.h"
#include "vog/memory.h"

namespace vog::scan {

/// Types of stored values.
enum class Number {
    int8,
    uint8,
    int16,
    uint16,
    int32,
    uint32,
    int64,
    uint64,
    float16,
    float32,
    float64
};
/// "int16".
const char* type_name(Number type);
std::optional<Number> number_named(std::string_view name);
std::uint64_t bytes_of(Number type);

/// Conversion of the doubles of an image to floats.
class Singles {
  public:
    double blank = std::numeric_limits<double>::quiet_NaN();  ///< becomes NaN

    float operator()(double value) {
        if (value == blank) return std::numeric_limits<float>::quiet_NaN();
        if (std::isfinite(value)) largest_ = std::max(largest_, std::abs(value));
        return float_of(value);
    }
    /// throws vog::Error where the largest finite value is beyond the range of floats, or below it
    /// scale  key of the file that scales its values: "BSCALE"; empty: none
    void check(const std::string& file, const std::string& scale = "") const;

  private:
    double largest_ = 0;
};
/// Value of a stored number in this machine's byte order.
double number_from(const char* bytes, Number type);

/// Place of values in a file.
struct StoredPart {
    std::filesystem::path file;
    std::uint64_t begin = 0;  ///< first byte of the file that belongs to the stream
    std::uint64_t skip = 0;   ///< bytes of the stream before the values, unpacked
};

/// StoredArray::spare where the head states the place of the values.
inline constexpr std::uint64_t kAnySpare = ~std::uint64_t{0};

/// Place and form of an array in a file, or in several files with equal shares of its values.
struct StoredArray {
    std::vector<StoredPart> parts;
    Encoding encoding = Encoding::raw;
    bool big_endian = false;
    Number type = Number::uint8;
    std::uint64_t voxels = 0;  ///< of one grid
    std::uint64_t grids = 1;   ///< frames or channels
    bool interleaved =
        false;  ///< all channels of a voxel side by side; else one grid after another
    double slope = 1, offset = 0;  ///< value = slope * stored + offset
    std::string scale{};           ///< key of the file for `slope`; empty: none
    bool behind_head = false;      ///< in one file with it; a few blanks or zeros may end that file
    std::uint64_t spare = 0;       ///< bytes of any content that may follow the values in a file
    std::string advice{};  ///< behind that error: ": state 'byte skip: -1' for the last ones"

    bool is_packed() const { return encoding == Encoding::deflate || encoding == Encoding::hex; }
    std::uint64_t part_values() const { return voxels * grids / parts.size(); }
};

/// Sets the places of parts whose values are the last bytes of their files, `behind` bytes before the end.
/// throws vog::Error for values as text
void place_at_end(StoredArray& array, std::uint64_t behind = 0);
/// Reader of the grids of an array, for ScanFile::read.
/// throws vog::Error where a file is too small for its values, or has more than may follow them; of deflated ones when
///         the last are read
std::function<BigVector<float>(std::size_t)> reader_of(const StoredArray& array);

/// Number of voxels of a size.
/// throws vog::Error for sizes below 1 or above 2^30, and for more than 2^40 voxels
std::uint64_t checked_voxels(const std::filesystem::path& file, std::int64_t x, std::int64_t y,
                             std::int64_t z);

}  // namespace vog::scan
