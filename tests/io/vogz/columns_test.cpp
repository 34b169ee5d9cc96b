// columns_test.cpp: columns of numbers come back exactly, in few bytes; corrupt ones are refused.
#include "io/vogz/columns.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "io/vogz/bits.h"
#include "support/refusal.h"
#include "support/scenes.h"

namespace vog::test {

using namespace vogz;

namespace {

constexpr Compression kBoth[] = {Compression::zstd, Compression::deflate};

std::string put(const std::vector<std::int64_t>& numbers, Compression compression) {
    std::string bytes;
    put_numbers(bytes, numbers, compression);
    return bytes;
}

std::vector<std::int64_t> taken(const std::string& bytes, std::size_t count,
                                Compression compression) {
    MemoryBytes in(bytes, "column", 0);
    std::vector<std::int64_t> numbers(count);
    take_numbers(in, numbers, compression);
    EXPECT_TRUE(in.at_end());
    return numbers;
}

/// Rounded normal deviates, each added to `share` of the number before it.
std::vector<std::int64_t> noise(std::size_t count, double deviation, double share) {
    Random random(count);
    std::vector<std::int64_t> numbers;
    double before = 0;
    for (std::size_t n = 0; n < count; ++n) {
        double normal = -6;
        for (int k = 0; k < 12; ++k) normal += random();
        before = share * before + deviation * normal;
        numbers.push_back(std::llround(before));
    }
    return numbers;
}

}  // namespace

TEST(vogz_columns, numbers_come_back) {
    constexpr std::int64_t kFar = std::int64_t{1} << 50;
    const std::vector<std::vector<std::int64_t>> columns = {{},
                                                            {7},
                                                            {-3, -3, -3, -3, -3},
                                                            {0, 1, -1, 2, -2},
                                                            {0, kFar, -kFar, 5, kFar + 1},
                                                            noise(5000, 0.3, 0),
                                                            noise(5000, 40, 0),
                                                            noise(300, 1e6, 0),
                                                            noise(9000, 100, 0.9)};
    for (const Compression compression : kBoth)
        for (const auto& column : columns)
            EXPECT_EQ(taken(put(column, compression), column.size(), compression), column);
}

TEST(vogz_columns, cost_the_entropy_of_noise) {
    // Bits of a rounded normal deviate: log2(deviation sqrt(2 pi e)).
    for (const Compression compression : kBoth)
        for (const double deviation : {3.0, 40.0, 5000.0}) {
            const std::size_t count = 8192;
            const double bits =
                8.0 * static_cast<double>(put(noise(count, deviation, 0), compression).size()) /
                static_cast<double>(count);
            EXPECT_LT(bits, std::log2(deviation * 4.1327) + 0.25) << deviation;
        }
}

TEST(vogz_columns, predict_numbers_that_resemble_those_before) {
    const std::size_t count = 8192;
    for (const Compression compression : kBoth)
        EXPECT_LT(
            put(noise(count, 10, 0.98), compression).size(),
            put(noise(count, 10 / std::sqrt(1 - 0.98 * 0.98), 0), compression).size() * 3 / 4);
}

TEST(vogz_columns, hold_words_of_all_widths) {
    std::vector<std::uint64_t> words(6000, 3);
    words[0] = words[5999] = std::numeric_limits<std::uint64_t>::max();
    words[7] = std::uint64_t{1} << 60;
    std::string bytes;
    put_words(bytes, words, Compression::zstd);
    MemoryBytes in(bytes, "column", 0);
    std::vector<std::uint64_t> read(words.size());
    take_words(in, read, Compression::zstd);
    EXPECT_EQ(read, words);
}

TEST(vogz_columns, refuse_truncated_bytes) {
    for (const Compression compression : kBoth) {
        const std::string bytes = put(noise(300, 1e4, 0.5), compression);
        for (std::size_t size = 0; size < bytes.size(); ++size) {
            const std::string cut = bytes.substr(0, size);
            MemoryBytes in(cut, "column", 0);
            std::vector<std::int64_t> numbers(300);
            EXPECT_THROW(take_numbers(in, numbers, compression), Error) << size;
        }
    }
}

TEST(vogz_columns, survive_changed_bytes) {
    // Any byte changed: an error or other numbers, no crash. The file's checksums are not asked here.
    for (const Compression compression : kBoth) {
        const std::string bytes = put(noise(200, 300, 0.5), compression);
        for (std::size_t at = 0; at < bytes.size(); ++at)
            for (const int change : {1, 0x80, 0xff}) {
                std::string changed = bytes;
                changed[at] = static_cast<char>(changed[at] ^ change);
                MemoryBytes in(changed, "column", 0);
                std::vector<std::int64_t> numbers(200);
                refusal([&] { take_numbers(in, numbers, compression); });
            }
    }
}

TEST(vogz_bits, come_back) {
    BitWriter writer(kMostBits * (kMostBits + 1) / 2);
    for (unsigned count = 0; count <= kMostBits; ++count)
        writer.put((std::uint64_t{1} << count) - 1 - (count > 3 ? 5 : 0), count);
    const std::string bytes = writer.take();
    BitReader reader(bytes);
    for (unsigned count = 0; count <= kMostBits; ++count)
        EXPECT_EQ(reader.take(count), (std::uint64_t{1} << count) - 1 - (count > 3 ? 5 : 0));
    EXPECT_TRUE(reader.at_end());
}

}  // namespace vog::test
