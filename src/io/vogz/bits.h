// bits.h: numbers as bytes, and numbers of any number of bits, one behind the other.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>

namespace vog::vogz {

/// Appends the bytes of a number, little-endian.
template <class T>
void put(std::string& out, T value) {
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Most bits of a number: 7 of the one before it may be pending.
inline constexpr int kMostBits = 57;

class BitWriter {
  public:
    /// most_bits  of all numbers together, at least
    explicit BitWriter(std::size_t most_bits) : out_(most_bits / 8 + sizeof pending_ + 1, '\0') {}
    /// bits   below 2^count
    /// count  0 to kMostBits
    void put(std::uint64_t bits, unsigned count) {
        pending_ |= bits << held_;
        std::memcpy(out_.data() + size_, &pending_, sizeof pending_);
        held_ += count;
        size_ += held_ / 8;
        // In two steps: held_ may be 64.
        pending_ = pending_ >> (held_ / 8 * 4) >> (held_ / 8 * 4);
        held_ %= 8;
    }
    /// Lower bits of each word.
    void put_each(std::span<const std::uint64_t> words, unsigned count) {
        // A copy of its own stays in registers.
        char* const out = out_.data();
        std::uint64_t pending = pending_;
        std::size_t at = size_;
        unsigned held = held_;
        const std::uint64_t mask = (std::uint64_t{1} << count) - 1;
        const auto put = [&](std::uint64_t bits, unsigned size) {
            pending |= bits << held;
            std::memcpy(out + at, &pending, sizeof pending);
            held += size;
            at += held / 8;
            pending = pending >> (held / 8 * 4) >> (held / 8 * 4);
            held %= 8;
        };
        std::size_t n = 0;
        // Two at a time, as each waits for the one before.
        if (2 * count <= kMostBits)
            for (; n + 2 <= words.size(); n += 2)
                put((words[n] & mask) | (words[n + 1] & mask) << count, 2 * count);
        for (; n < words.size(); ++n) put(words[n] & mask, count);
        pending_ = pending, size_ = at, held_ = held;
    }
    /// All bytes, the last one filled with zeros.
    std::string take() {
        out_.resize(size_ + (held_ > 0 ? 1 : 0));
        return std::move(out_);
    }

  private:
    std::string out_;
    std::size_t size_ = 0;  ///< whole bytes
    std::uint64_t pending_ = 0;
    unsigned held_ = 0;  ///< bits of pending_
};

class BitReader {
  public:
    explicit BitReader(std::span<const char> bytes)
        : bytes_(bytes.size() + sizeof(std::uint64_t), '\0'), size_(bytes.size()) {
        std::ranges::copy(bytes, bytes_.begin());
    }
    /// Next number; zeros behind the end.
    /// count  0 to kMostBits
    std::uint64_t take(unsigned count) {
        std::uint64_t load = 0;
        std::memcpy(&load, bytes_.data() + std::min(bit_ / 8, size_), sizeof load);
        load >>= bit_ % 8;
        bit_ += count;
        return load & ((std::uint64_t{1} << count) - 1);
    }
    /// Calls use(n, number) for as many numbers as `count` bits each make.
    template <class Use>
    void take_each(std::size_t numbers, unsigned count, const Use& use) {
        if (count > 0 && (bit_ + numbers * count) / 8 <= size_) {
            // None behind the end, and none waits for the one before.
            const char* const bytes = bytes_.data();
            const std::uint64_t mask = (std::uint64_t{1} << count) - 1;
            for (std::size_t n = 0, bit = bit_; n < numbers; ++n, bit += count) {
                std::uint64_t load = 0;
                std::memcpy(&load, bytes + bit / 8, sizeof load);
                use(n, load >> bit % 8 & mask);
            }
            bit_ += numbers * count;
        } else {
            for (std::size_t n = 0; n < numbers; ++n) use(n, take(count));
        }
    }
    /// Whether the bytes are those of the numbers taken, no more and no less.
    bool at_end() const { return (bit_ + 7) / 8 == size_; }

  private:
    std::string bytes_;  ///< and zeros behind them: each number is loaded as 8 bytes
    std::size_t size_ = 0, bit_ = 0;
};

}  // namespace vog::vogz
