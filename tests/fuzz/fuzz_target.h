// fuzz_target.h: Input of a fuzz target, the properties that must hold for it, and numbers drawn from it.
// A target is a file NAME_fuzz.cpp that defines run(); docs/reliability.md lists the targets.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

namespace vog::fuzz {

/// Input of one run.
using Bytes = std::span<const std::uint8_t>;

/// Runs the target of this executable. Ends the process if a property does not hold.
void run(Bytes input);

/// Ends the process with the property's name unless it holds.
void expect(bool holds, const char* property);

/// Limits of one input beside 64 MiB. The sanitizers' checks take three times as long as the code.
struct Limits {
    double memory_ratio = 10;         ///< bytes allocated for a byte of the input
    double seconds = 3;               ///< of all threads together, whatever the size
    double seconds_per_kilobyte = 3;  ///< more of them for each 1024 bytes
};
/// Limits of this target; each *_fuzz.cpp defines them beside run().
extern const Limits kLimits;

/// Calls a reader, a writer or a conversion.
/// returns  false if it refuses its input by a vog::Error, whose message is one line of printable
///          UTF-8 text; any other exception ends the process
bool accepted(const std::function<void()>& call);

/// Path of a file in a folder of this process, in memory where the system has such folders.
std::filesystem::path scratch_file(const std::string& name);
/// Writes the input to a scratch file.
/// extension  ".vdb"
std::filesystem::path input_file(Bytes input, const std::string& extension);

/// Whether two arrays of plain values are the same bytes: NaN equals itself, 0 is not -0.
template <class A, class B>
bool same_bytes(const A& a, const B& b) {
    return a.size() == b.size() &&
           (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(*a.data())) == 0);
}

/// Numbers drawn from an input, zeros behind its end.
class Numbers {
  public:
    explicit Numbers(Bytes input) : left_(input) {}

    bool empty() const { return left_.empty(); }
    std::uint8_t byte() {
        if (left_.empty()) return 0;
        const std::uint8_t first = left_.front();
        left_ = left_.subspan(1);
        return first;
    }
    std::uint64_t bits(int bytes) {
        std::uint64_t all = 0;
        for (int n = 0; n < bytes; ++n) all |= std::uint64_t{byte()} << (8 * n);
        return all;
    }
    /// Integer in [0, count), count up to 2^16.
    int below(int count) { return static_cast<int>(bits(2) % static_cast<unsigned>(count)); }
    bool flag() { return byte() & 1; }
    /// Number in [0, 1).
    double share() { return static_cast<double>(bits(2)) / 65536; }
    /// Most often a number of ordinary size; else a power of ten in 1e-38 ... 1e38, or any bits.
    float number();
    /// As number(), finite and above 0.
    float positive();
    /// Text of up to `most` bytes, of any values.
    std::string text(int most);

  private:
    Bytes left_;
};

}  // namespace vog::fuzz
