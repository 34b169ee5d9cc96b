// scan_values.h: values of raw, deflated and text data as floats. Sizes are checked against the file before memory
// is allocated.
#pragma once

#include <zlib.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

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

/// Value as float. Conversion beyond float's range is undefined behaviour: such values become infinite.
float float_of(double value);
/// Value of a stored number in this machine's byte order.
float number_from(const char* bytes, Number type);

enum class Encoding { raw, deflate, text };

/// Place of values in a file.
struct StoredPart {
    std::filesystem::path file;
    std::uint64_t begin = 0;  ///< first byte of the file that belongs to the stream
    std::uint64_t skip = 0;   ///< bytes of the stream before the values, unpacked
};

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

    std::uint64_t part_values() const { return voxels * grids / parts.size(); }
};

/// Bytes of a file, unpacked where they are deflated (gzip or zlib), forward only.
class ScanBytes {
  public:
    /// where  start of messages
    ScanBytes(const std::filesystem::path& file, std::uint64_t begin, bool deflated);
    ~ScanBytes();
    ScanBytes(const ScanBytes&) = delete;
    ScanBytes& operator=(const ScanBytes&) = delete;

    /// Reads the next bytes.
    /// throws vog::Error where there are fewer
    void read(char* to, std::uint64_t count);
    void skip(std::uint64_t count);
    /// Reads up to `count` bytes. Returns their number, 0 at the end.
    std::uint64_t read_some(char* to, std::uint64_t count);
    std::uint64_t position() const { return position_; }
    /// Most bytes that can follow: those of the file, times deflate's largest ratio.
    std::uint64_t most_left() const;
    /// Reads the checksum behind deflated bytes, unless more of them follow.
    void check_end();

  private:
    void refill();

    std::string name_;
    std::ifstream stream_;
    std::uint64_t size_ = 0, read_ = 0, position_ = 0;
    std::vector<char> packed_;
    z_stream zip_{};
    bool deflated_ = false, between_members_ = false, ended_ = false;
};

/// Whether a file begins with the bytes of gzip.
bool is_gzip(const std::filesystem::path& file);

/// Unpacks a gzip'd or zlib'd file.
BigVector<char> unpacked_bytes(const std::filesystem::path& file);
/// Sets the places of parts whose values are the last bytes of their files, `behind` bytes before the end.
/// throws vog::Error for values as text
void place_at_end(StoredArray& array, std::uint64_t behind = 0);
/// Reader of the grids of an array, for ScanFile::read.
/// throws vog::Error where the file is too small for the array
std::function<BigVector<float>(std::size_t)> reader_of(const StoredArray& array);

/// Number of voxels of a size.
/// throws vog::Error for sizes below 1 or above 2^30, and for more than 2^40 voxels
std::uint64_t checked_voxels(const std::filesystem::path& file, std::int64_t x, std::int64_t y,
                             std::int64_t z);

}  // namespace vog::scan
