// columns.h: columns of whole numbers as bytes: near numbers in few bits, entropy-coded by a library.
//
// A number is coded as its difference from a prediction by the numbers before it. The lower bits of the differences are
// packed as they are, the upper ones are one byte a number, which a compressor takes from 8 bits to their entropy: lower
// bits are noise, and compressors only lose time on them.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "io/byte_source.h"

namespace vog::vogz {

/// Library of the entropy coder. zstd is faster; browsers have deflate built in.
enum class Compression : std::uint8_t { zstd, deflate };

/// Compressed bytes, without their length.
std::string compressed(std::span<const char> bytes, Compression compression);
/// Inverse of compressed().
/// in     names the file in messages
/// throws vog::Error unless `bytes` hold exactly out.size() bytes
void decompress(const ByteSource& in, std::span<const char> bytes, Compression compression,
                std::span<char> out);

/// Bits of the column that put_words would write, by the entropy of its symbols.
double column_bits(std::span<const std::uint64_t> words);
/// Appends a column of small numbers, most of them near 0.
void put_words(std::string& out, std::span<const std::uint64_t> words, Compression compression);
/// throws  vog::Error for bytes that put_words did not write for as many words
void take_words(MemoryBytes& in, std::span<std::uint64_t> words, Compression compression);

/// Appends a column of numbers that resemble those before them.
void put_numbers(std::string& out, std::span<const std::int64_t> numbers, Compression compression);
/// throws  vog::Error as take_words
void take_numbers(MemoryBytes& in, std::span<std::int64_t> numbers, Compression compression);

/// Numbers of either sign as small words: 0, -1, 1, -2, ... become 0, 1, 2, 3, ...
constexpr std::uint64_t zigzag(std::int64_t number) {
    return static_cast<std::uint64_t>(number) << 1 ^ static_cast<std::uint64_t>(number >> 63);
}
constexpr std::int64_t from_zigzag(std::uint64_t word) {
    return static_cast<std::int64_t>(word >> 1 ^ (~(word & 1) + 1));
}

}  // namespace vog::vogz
