// crate_codes.cpp: LZ4 blocks and differences of crates.
#include "io/exchange/usd/crate_codes.h"

#include <fmt/core.h>

#include <algorithm>
#include <cassert>
#include <cstring>
#include <limits>
#include <unordered_map>

namespace vog::exchange::usd {

namespace {

/// A byte of LZ4 stands for at most 255.
constexpr std::size_t kMostRatio = 255;

/// Bytes from the front of a block.
class Block {
  public:
    explicit Block(std::span<const char> bytes) : bytes_(bytes) {}
    bool at_end() const { return bytes_.empty(); }
    std::span<const char> take(std::size_t count) {
        if (count > bytes_.size()) throw CrateFault("corrupt: an LZ4 block ends early");
        const std::span<const char> front = bytes_.first(count);
        bytes_ = bytes_.subspan(count);
        return front;
    }
    std::size_t byte() { return static_cast<std::uint8_t>(take(1).front()); }
    /// Four bits of a token, and bytes of more where they are 15.
    std::size_t length(std::size_t four_bits) {
        std::size_t sum = four_bits;
        if (four_bits < 15) return sum;
        for (std::size_t more = 255; more == 255;) sum += more = byte();
        return sum;
    }

  private:
    std::span<const char> bytes_;
};

void append_block(std::string& out, Block block, std::size_t most) {
    const std::size_t begin = out.size();
    const auto grow = [&](std::size_t count) {
        if (count > most - out.size())
            throw CrateFault(fmt::format("corrupt: more than {} bytes in an LZ4 block", most));
    };
    while (!block.at_end()) {
        const std::size_t token = block.byte();
        const std::size_t plain = block.length(token >> 4);
        const std::span<const char> literals = block.take(plain);
        grow(plain);
        out.append(literals.begin(), literals.end());
        if (block.at_end()) return;
        const std::size_t low = block.byte(), back = low | block.byte() << 8;
        constexpr std::size_t kLeastMatch = 4;
        const std::size_t count = kLeastMatch + block.length(token & 15);
        if (back == 0 || back > out.size() - begin)
            throw CrateFault("corrupt: an LZ4 block repeats bytes before it");
        grow(count);
        for (std::size_t n = 0; n < count; ++n) out.push_back(out[out.size() - back]);
    }
}

void put_literals(std::string& out, std::span<const char> bytes) {
    const std::size_t count = bytes.size();
    out.push_back(static_cast<char>(std::min<std::size_t>(count, 15) << 4));
    if (count >= 15) {
        out.append((count - 15) / 255, '\xff');
        out.push_back(static_cast<char>((count - 15) % 255));
    }
    out.append(bytes.begin(), bytes.end());
}

std::size_t code_bytes(std::size_t count) { return (2 * count + 7) / 8; }

template <class T>
void put_number(std::string& out, T value) {
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// A difference of one of the three kinds in bytes.
template <class T>
std::uint32_t taken(Block& bytes) {
    T value{};
    std::memcpy(&value, bytes.take(sizeof value).data(), sizeof value);
    return static_cast<std::uint32_t>(std::int32_t{value});
}

}  // namespace

std::string crate_packed(std::span<const char> bytes) {
    assert(bytes.size() <= std::size_t{1} << 30);
    std::string out(1, '\0');  // one block
    put_literals(out, bytes);
    return out;
}

std::string crate_unpacked(std::span<const char> packed, std::size_t most) {
    most = std::min(most, kMostRatio * packed.size());
    std::string out;
    Block all(packed);
    const std::size_t blocks = all.byte();
    if (blocks == 0) {
        append_block(out, Block(packed.subspan(1)), most);
        return out;
    }
    for (std::size_t n = 0; n < blocks; ++n) {
        std::int32_t size = 0;
        std::memcpy(&size, all.take(sizeof size).data(), sizeof size);
        if (size < 0) throw CrateFault("corrupt: an LZ4 block of negative size");
        append_block(out, Block(all.take(static_cast<std::size_t>(size))), most);
    }
    return out;
}

std::string crate_coded(std::span<const std::int32_t> numbers) {
    std::vector<std::int32_t> steps;
    std::unordered_map<std::int32_t, std::size_t> often;
    std::uint32_t before = 0;
    for (const std::int32_t number : numbers) {
        const auto now = static_cast<std::uint32_t>(number);
        steps.push_back(static_cast<std::int32_t>(now - before));
        ++often[steps.back()];
        before = now;
    }
    std::int32_t common = 0;
    for (const std::int32_t step : steps)
        if (often[step] > often[common]) common = step;
    std::string codes(code_bytes(numbers.size()), '\0'), rest;
    for (std::size_t n = 0; n < steps.size(); ++n) {
        const std::int32_t step = steps[n];
        int code = 0;
        if (step == common) {
        } else if (step == static_cast<std::int8_t>(step)) {
            code = 1;
            put_number(rest, static_cast<std::int8_t>(step));
        } else if (step == static_cast<std::int16_t>(step)) {
            code = 2;
            put_number(rest, static_cast<std::int16_t>(step));
        } else {
            code = 3;
            put_number(rest, step);
        }
        codes[n / 4] = static_cast<char>(codes[n / 4] | code << 2 * (n % 4));
    }
    std::string all;
    put_number(all, common);
    return crate_packed(all + codes + rest);
}

std::vector<std::int32_t> crate_decoded(std::span<const char> packed, std::size_t count) {
    if (count > 4 * kMostRatio * packed.size())
        throw CrateFault(fmt::format("corrupt: {} numbers in {} bytes", count, packed.size()));
    const std::string all = crate_unpacked(packed, std::numeric_limits<std::size_t>::max());
    Block rest(all);
    const std::uint32_t common = taken<std::int32_t>(rest);
    const std::span<const char> codes = rest.take(code_bytes(count));
    std::vector<std::int32_t> numbers(count);
    std::uint32_t now = 0;
    for (std::size_t n = 0; n < count; ++n) {
        switch (static_cast<std::uint8_t>(codes[n / 4]) >> 2 * (n % 4) & 3) {
            case 0:
                now += common;
                break;
            case 1:
                now += taken<std::int8_t>(rest);
                break;
            case 2:
                now += taken<std::int16_t>(rest);
                break;
            default:
                now += taken<std::int32_t>(rest);
        }
        numbers[n] = static_cast<std::int32_t>(now);
    }
    return numbers;
}

}  // namespace vog::exchange::usd
