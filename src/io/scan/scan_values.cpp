// scan_values.cpp: unpacking, byte order, conversion to float and scaling of stored values.
#include "io/scan/scan_values.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <utility>

#include "core/atomic_file.h"
#include "core/paging.h"
#include "vog/error.h"
#include "vog/text.h"

namespace vog::scan {

namespace {

constexpr std::array<std::pair<const char*, std::uint64_t>, 11> kTypes{{{"int8", 1},
                                                                        {"uint8", 1},
                                                                        {"int16", 2},
                                                                        {"uint16", 2},
                                                                        {"int32", 4},
                                                                        {"uint32", 4},
                                                                        {"int64", 8},
                                                                        {"uint64", 8},
                                                                        {"float16", 2},
                                                                        {"float32", 4},
                                                                        {"float64", 8}}};
/// IEEE 754's binary16: sign, 5 bits of exponent, 10 of significand.
struct Half {
    std::uint16_t bits = 0;

    operator double() const {
        constexpr int kHidden = 1 << 10, kSpecial = 31, kLeast = -24;
        const int exponent = bits >> 10 & kSpecial, low = bits & (kHidden - 1);
        const double size = exponent == kSpecial ? (low ? std::numeric_limits<double>::quiet_NaN()
                                                        : std::numeric_limits<double>::infinity())
                            : exponent == 0      ? std::ldexp(low, kLeast)
                                                 : std::ldexp(kHidden + low, kLeast - 1 + exponent);
        return bits >> 15 ? -size : size;
    }
};

/// Calls use(T{}) with the C++ type of a stored one.
template <class Use>
void with_type(Number type, const Use& use) {
    switch (type) {
        case Number::int8:
            return use(std::int8_t{});
        case Number::uint8:
            return use(std::uint8_t{});
        case Number::int16:
            return use(std::int16_t{});
        case Number::uint16:
            return use(std::uint16_t{});
        case Number::int32:
            return use(std::int32_t{});
        case Number::uint32:
            return use(std::uint32_t{});
        case Number::int64:
            return use(std::int64_t{});
        case Number::uint64:
            return use(std::uint64_t{});
        case Number::float16:
            return use(Half{});
        case Number::float32:
            return use(float{});
        case Number::float64:
            return use(double{});
    }
}

template <class T>
T number_at(const char* bytes, bool big_endian) {
    std::array<char, sizeof(T)> copy;
    std::memcpy(copy.data(), bytes, sizeof(T));
    if (big_endian) std::ranges::reverse(copy);
    return std::bit_cast<T>(copy);
}

/// Numbers of a text, between blanks.
class TextNumbers {
  public:
    explicit TextNumbers(const StoredPart& part) : name_(part.file.string()) {
        require_readable(part.file);
        stream_.open(part.file, std::ios::binary);
        stream_.seekg(static_cast<std::streamoff>(part.begin));
    }
    double next(std::uint64_t n, std::uint64_t expected) {
        const std::string word = next_word();
        if (word.empty())
            throw Error(
                fmt::format("{}: truncated: {} values as text, expected {}", name_, n, expected));
        double value = 0;
        const auto [stop, code] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (code == std::errc::result_out_of_range) return std::numeric_limits<double>::infinity();
        if (code != std::errc{} || stop != word.data() + word.size())
            throw Error(
                fmt::format("{}: value {} is '{}', expected a number", name_, n, printable(word)));
        return value;
    }
    /// throws vog::Error unless the text ends
    void check_end(std::uint64_t expected) {
        std::uint64_t count = expected;
        while (!next_word().empty()) ++count;
        if (count > expected)
            throw Error(
                fmt::format("{}: {} values as text, expected {} (commas lie between values, "
                            "decimals have a point)",
                            name_, count, expected));
    }

  private:
    /// Next word, or the beginning of a long one; empty at the end.
    std::string next_word() {
        constexpr std::size_t kLongest = 64;
        const auto blank = [](int c) {
            return c == ' ' || c == '\n' || c == '\t' || c == '\r' || c == ',' || c == 0;
        };
        std::string word;
        int c = stream_.get();
        while (blank(c)) c = stream_.get();
        for (; c != EOF && !blank(c); c = stream_.get())
            if (word.size() < kLongest) word.push_back(static_cast<char>(c));
        return word;
    }

    std::string name_;
    std::ifstream stream_;
};

/// Refuses what follows the values of a part in its file, except what may.
/// bytes  behind the values
void check_rest(const StoredArray& array, const StoredPart& part, ScanBytes& bytes) {
    constexpr std::uint64_t kMostBlanks = 8;
    const bool packed = array.is_packed(), any = array.spare == kAnySpare;
    std::vector<char> step(any ? 1 : ScanBytes::kStep);
    std::uint64_t rest = 0;
    bool blank = array.behind_head;
    // The checksum of a deflated stream comes behind its last byte.
    while (const std::uint64_t got = bytes.read_some(step.data(), step.size())) {
        rest += got;
        blank &=
            rest <= kMostBlanks &&
            std::all_of(step.begin(), step.begin() + static_cast<std::ptrdiff_t>(got), [](char c) {
                return c == 0 || std::isspace(static_cast<unsigned char>(c)) != 0;
            });
        if (any) return;
        if (packed) continue;
        rest += bytes.most_left();
        break;
    }
    if (blank || rest <= array.spare) return;
    const std::uint64_t expected = array.part_values() * bytes_of(array.type);
    throw Error(fmt::format("{}: {} bytes{} of values, expected {} for {} values of {}{}",
                            part.file.string(), expected + rest, packed ? " unpacked" : "",
                            expected, array.part_values(), type_name(array.type), array.advice));
}

BigVector<float> read_text(const StoredArray& array, std::size_t grid) {
    const std::uint64_t all = array.voxels * array.grids, share = array.part_values();
    std::optional<TextNumbers> text;
    BigVector<float> values;
    Singles singles;
    for (std::uint64_t n = 0; n < all; ++n) {
        if (n % share == 0) text.emplace(array.parts[n / share]);
        const double value = text->next(n % share, share);
        const std::uint64_t of = array.interleaved ? n % array.grids : n / array.voxels;
        if (of == grid) values.push_back(singles(array.slope * value + array.offset));
        if (n % share == share - 1 && array.spare != kAnySpare) text->check_end(share);
    }
    singles.check(array.parts[0].file.string());
    return values;
}

/// Values of an array's parts as one row of bytes, forward only.
class PartBytes {
  public:
    explicit PartBytes(const StoredArray& array)
        : array_(array), share_(array.part_values() * bytes_of(array.type)) {}
    std::uint64_t position() const { return position_; }
    void read(char* to, std::uint64_t count) {
        while (count > 0) {
            const std::uint64_t step = std::min(count, open());
            bytes_->read(to, step);
            to += step, count -= step, position_ += step;
        }
    }
    void skip(std::uint64_t count) {
        for (; count >= share_ - position_ % share_; count -= share_ - position_ % share_)
            position_ += share_ - position_ % share_;  // a part that is not opened
        if (count > 0) open(), bytes_->skip(count), position_ += count;
    }
    /// Reads the open part to its end, where nothing may follow.
    void check_end() {
        const StoredPart& part = array_.parts[part_];
        bytes_->skip(part.skip + share_ - bytes_->position());
        check_rest(array_, part, *bytes_);
        bytes_.reset();
    }

  private:
    /// Opens the part at the position. Returns the bytes left in it.
    std::uint64_t open() {
        const std::size_t n = position_ / share_;
        if (!bytes_ || n != part_) {
            if (bytes_) check_end();
            const StoredPart& part = array_.parts[part_ = n];
            bytes_.emplace(part.file, part.begin, array_.encoding);
            bytes_->skip(part.skip + position_ % share_);
        }
        return share_ - position_ % share_;
    }

    const StoredArray& array_;
    std::uint64_t share_, position_ = 0;
    std::size_t part_ = 0;
    std::optional<ScanBytes> bytes_;
};

/// Reader of raw or deflated values that goes on where it stopped, for grids in the order of the file.
class ArrayReader {
  public:
    explicit ArrayReader(const StoredArray& array) : array_(array), bytes_(std::in_place, array_) {}

    BigVector<float> operator()(std::size_t grid) {
        const std::uint64_t bytes = bytes_of(array_.type);
        const std::uint64_t stride = array_.interleaved ? array_.grids : 1;
        const std::uint64_t begin = (array_.interleaved ? grid : grid * array_.voxels) * bytes;
        if (bytes_->position() > begin) bytes_.emplace(array_);
        bytes_->skip(begin - bytes_->position());
        BigVector<float> values;
        Singles singles;
        resize_kept(values, array_.voxels);
        const std::uint64_t run = std::max<std::uint64_t>(ScanBytes::kStep / (stride * bytes), 1);
        std::vector<char> buffer;
        for (std::uint64_t at = 0; at < array_.voxels; at += run) {
            const std::uint64_t count = std::min(run, array_.voxels - at);
            const bool last = at + count == array_.voxels;
            // Behind the last value of a channel lie those of later ones, which no one reads.
            buffer.resize(((count - 1) * stride + (last ? 1 : stride)) * bytes);
            bytes_->read(buffer.data(), buffer.size());
            convert(buffer.data(), stride * bytes, {values.data() + at, count}, singles);
            keep_memory();
        }
        singles.check(array_.parts[0].file.string(), array_.scale);
        if (array_.interleaved || grid + 1 == array_.grids) bytes_->check_end();
        return values;
    }

  private:
    void convert(const char* from, std::uint64_t stride, std::span<float> to,
                 Singles& singles) const {
        const bool plain = array_.slope == 1 && array_.offset == 0;
        with_type(array_.type, [&](auto zero) {
            using T = decltype(zero);
            for (std::size_t n = 0; n < to.size(); ++n) {
                const T stored = number_at<T>(from + n * stride, array_.big_endian);
                if constexpr (std::is_same_v<T, double>) {
                    to[n] = singles(plain ? stored : array_.slope * stored + array_.offset);
                } else {
                    to[n] =
                        plain ? static_cast<float>(stored)
                              : singles(array_.slope * static_cast<double>(stored) + array_.offset);
                }
            }
        });
    }

    StoredArray array_;
    std::optional<PartBytes> bytes_;
};

}  // namespace

void Singles::check(const std::string& file, const std::string& scale) const {
    if (float_unit(largest_) == 1) return;
    throw Error(
        fmt::format("{}: values up to {:.6g}, expected ones within single precision, 1.2e-38 to "
                    "3.4e+38: write them in another unit{}{}",
                    file, largest_, scale.empty() ? "" : fmt::format(", or change {}", scale),
                    largest_ > 1 ? ", and NaN for no data" : ""));
}

const char* type_name(Number type) { return kTypes[static_cast<std::size_t>(type)].first; }
std::uint64_t bytes_of(Number type) { return kTypes[static_cast<std::size_t>(type)].second; }

std::optional<Number> number_named(std::string_view name) {
    for (std::size_t n = 0; n < kTypes.size(); ++n)
        if (name == kTypes[n].first) return static_cast<Number>(n);
    return std::nullopt;
}

double number_from(const char* bytes, Number type) {
    double value = 0;
    with_type(type, [&](auto zero) {
        value = static_cast<double>(number_at<decltype(zero)>(bytes, false));
    });
    return value;
}

void place_at_end(StoredArray& array, std::uint64_t behind) {
    const std::uint64_t bytes = array.part_values() * bytes_of(array.type) + behind;
    for (StoredPart& part : array.parts) {
        if (array.encoding == Encoding::text)
            throw Error(
                fmt::format("{}: values as text at the end of the file, expected a number of bytes "
                            "or lines before them",
                            part.file.string()));
        ScanBytes stream(part.file, part.begin, array.encoding);
        std::uint64_t size = stream.most_left();
        if (array.encoding != Encoding::raw) {
            std::vector<char> step(ScanBytes::kStep);
            size = 0;
            while (const std::uint64_t got = stream.read_some(step.data(), ScanBytes::kStep))
                size += got;
        }
        if (size < bytes)
            throw Error(fmt::format("{}: truncated: {} bytes, expected {} or more",
                                    part.file.string(), size, bytes));
        part.skip = size - bytes;
    }
}

std::function<BigVector<float>(std::size_t)> reader_of(const StoredArray& array) {
    if (array.encoding == Encoding::text)
        return [array](std::size_t grid) { return read_text(array, grid); };
    const std::uint64_t bytes = array.part_values() * bytes_of(array.type);
    for (const StoredPart& part : array.parts) {
        ScanBytes probe(part.file, part.begin, array.encoding);
        if (probe.most_left() < part.skip || probe.most_left() - part.skip < bytes)
            throw Error(fmt::format("{}: truncated: {} bytes, expected {} for {} values of {}",
                                    part.file.string(), part.begin + probe.most_left(),
                                    part.begin + part.skip + bytes, array.part_values(),
                                    type_name(array.type)));
        if (array.encoding != Encoding::raw) continue;
        probe.skip(part.skip + bytes);
        check_rest(array, part, probe);
    }
    auto reader = std::make_shared<ArrayReader>(array);
    return [reader](std::size_t grid) { return (*reader)(grid); };
}

std::uint64_t checked_voxels(const std::filesystem::path& file, std::int64_t x, std::int64_t y,
                             std::int64_t z) {
    constexpr std::int64_t kMostEdge = std::int64_t{1} << 30;
    constexpr double kMost = static_cast<double>(std::uint64_t{1} << 40);
    for (const std::int64_t edge : {x, y, z})
        if (edge < 1 || edge > kMostEdge)
            throw Error(fmt::format("{}: {} x {} x {} voxels, expected 1 to 2^30 along each axis",
                                    file.string(), x, y, z));
    if (static_cast<double>(x) * static_cast<double>(y) * static_cast<double>(z) > kMost)
        throw Error(
            fmt::format("{}: {} x {} x {} voxels, expected at most 2^40", file.string(), x, y, z));
    return static_cast<std::uint64_t>(x) * static_cast<std::uint64_t>(y) *
           static_cast<std::uint64_t>(z);
}

}  // namespace vog::scan
