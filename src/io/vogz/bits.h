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
    /// bits   below 2^count
    /// count  0 to kMostBits
    void put(std::uint64_t bits, int count) {
        pending_ |= bits << held_;
        held_ += count;
        for (; held_ >= 8; held_ -= 8, pending_ >>= 8) out_ += static_cast<char>(pending_);
    }
    /// All bytes, the last one filled with zeros.
    std::string take() {
        if (held_ > 0) out_ += static_cast<char>(pending_);
        return std::move(out_);
    }

  private:
    std::string out_;
    std::uint64_t pending_ = 0;
    int held_ = 0;
};

class BitReader {
  public:
    explicit BitReader(std::span<const char> bytes) : bytes_(bytes) {}
    /// Next number; zeros behind the end.
    /// count  0 to kMostBits
    std::uint64_t take(int count) {
        std::uint64_t load = 0;
        const std::size_t byte = bit_ / 8;
        if (byte + sizeof load <= bytes_.size())
            std::memcpy(&load, bytes_.data() + byte, sizeof load);
        else if (byte < bytes_.size())
            std::memcpy(&load, bytes_.data() + byte, bytes_.size() - byte);
        load >>= bit_ % 8;
        bit_ += static_cast<std::size_t>(count);
        return load & ((std::uint64_t{1} << count) - 1);
    }
    /// Whether the bytes are those of the numbers taken, no more and no less.
    bool at_end() const { return (bit_ + 7) / 8 == bytes_.size(); }

  private:
    std::span<const char> bytes_;
    std::size_t bit_ = 0;
};

}  // namespace vog::vogz
