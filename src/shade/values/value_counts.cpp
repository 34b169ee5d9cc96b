// value_counts.cpp: percentiles of values by bins of their upper 16 bits.
#include "vog/value_counts.h"

#include <fmt/core.h>

#include <bit>
#include <cstdint>
#include <numeric>
#include <string>

namespace vog {

namespace {

constexpr std::uint32_t kSign = 0x80000000u;

/// Bits of a value in the order of values: negative ones are turned round.
std::uint32_t ordered(std::uint32_t bits) { return bits & kSign ? ~bits : bits | kSign; }

/// Value of a bin's end nearer to 0, which data of few digits have, to three digits.
double value_of(std::size_t bin) {
    const std::uint32_t key = static_cast<std::uint32_t>(bin) << 16;
    const auto value = std::bit_cast<float>(key & kSign ? key & ~kSign : ~key & 0xffff0000u);
    return std::stod(fmt::format("{:.3g}", value));
}

}  // namespace

void ValueCounts::add(float value, double weight) {
    if (!(weight > 0)) return;
    weights()[ordered(std::bit_cast<std::uint32_t>(value + 0.0f)) >> 16] += weight;
}

void ValueCounts::add(const ValueCounts& other) {
    if (other.empty()) return;
    const std::span<double> sums = weights();
    for (std::size_t n = 0; n < kBins; ++n) sums[n] += other.weights_[n];
}

std::span<double> ValueCounts::weights() {
    if (weights_.empty()) weights_.resize(kBins);
    return weights_;
}

ValueSpread ValueCounts::spread() const {
    const double all = std::accumulate(weights_.begin(), weights_.end(), 0.0);
    if (!(all > 0)) return {};
    double sum = 0;
    std::size_t bin = 0;
    const auto value_at = [&](double share) {
        while (sum + weights_[bin] < share * all && bin + 1 < kBins) sum += weights_[bin++];
        return value_of(bin);
    };
    const double low = value_at(0.01), middle = value_at(0.5);
    return {low, middle, value_at(0.99), true};
}

}  // namespace vog
