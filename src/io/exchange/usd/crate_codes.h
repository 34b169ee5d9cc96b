// crate_codes.h: layout of OpenUSD's crates, and how they code numbers: differences in 0 to 4 bytes, in blocks of LZ4.
// Source: OpenUSD, pxr/usd/sdf/crateFile.cpp, crateDataTypes.h, integerCoding.cpp, pxr/base/tf/fastCompression.cpp.
#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace vog::exchange::usd {

inline constexpr const char* kCrateMark = "PXR-USDC";
inline constexpr std::size_t kCrateHead = 88;  ///< bytes before the first value
inline constexpr std::size_t kTableAt = 16;    ///< of the place of the table of contents, 64 bits

/// A section in the table of contents.
struct CrateSection {
    char name[16];
    std::uint64_t start, size;
};
static_assert(sizeof(CrateSection) == 32);

/// Types of values.
enum class CrateType : std::uint8_t {
    boolean = 1,
    int32 = 3,
    float16 = 7,
    float32 = 8,
    float64 = 9,
    token = 11,
    quat64 = 16,
    quat32 = 17,
    quat16 = 18,
    vec3_64 = 23,
    vec3_32 = 24,
    vec3_16 = 25,
    tokens = 41,
    specifier = 42,
    variability = 44
};
/// Kinds of specs.
enum CrateSpec : std::uint32_t { attribute_spec = 1, prim_spec = 6, root_spec = 7 };

/// A value: flags, type, and the value itself or its place in the file.
struct CrateValue {
    static constexpr std::uint64_t kArray = std::uint64_t{1} << 63, kInlined = kArray >> 1,
                                   kCompressed = kArray >> 2;
    static constexpr int kTypeAt = 48;

    std::uint64_t bits = 0;

    bool array() const { return bits & kArray; }
    bool inlined() const { return bits & kInlined; }
    bool compressed() const { return bits & kCompressed; }
    CrateType type() const { return static_cast<CrateType>(bits >> kTypeAt & 0xff); }
    std::uint64_t payload() const { return bits & ((std::uint64_t{1} << kTypeAt) - 1); }
};
constexpr CrateValue crate_value(CrateType type, std::uint64_t flags, std::uint64_t payload) {
    return {flags | std::uint64_t{static_cast<std::uint8_t>(type)} << CrateValue::kTypeAt |
            payload};
}

/// Corrupt codes; its message names no file.
struct CrateFault : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Bytes in one block of LZ4, without searching for repetitions: a byte in 255 more than they are.
/// bytes  at most 2^30
std::string crate_packed(std::span<const char> bytes);
/// throws  CrateFault for corrupt blocks, or for more than `most` bytes
std::string crate_unpacked(std::span<const char> packed, std::size_t most);

/// Bytes of whole numbers, in differences from the number before.
std::string crate_coded(std::span<const std::int32_t> numbers);
/// throws  CrateFault for corrupt blocks, or for fewer than `count` numbers
std::vector<std::int32_t> crate_decoded(std::span<const char> packed, std::size_t count);

}  // namespace vog::exchange::usd
