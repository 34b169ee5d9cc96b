// mass_threshold.h: which cells are too light to keep.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "vog/convert_moments.h"
#include "vog/distributed.h"

namespace vog::moments {

/// Finds the mass below which cells may go: together at most some share of all. Cells are sorted by
/// the upper 16 bits of their mass, so those within 1 % of each other stay or go collective.
class MassThreshold {
  public:
    /// mass  finite, >= 0
    void add(float mass) {
        const std::size_t bin = std::bit_cast<std::uint32_t>(mass) >> 16;
        sum_[bin] += static_cast<double>(mass);
        ++count_[bin];
    }
    /// With the cells of others. The sum of up to 2^29 floats of one bin is exact in a double, so
    /// neither the order of cells nor how they are shared out makes a difference.
    void sum_over(const Collective& collective) {
        if (!collective.shared()) return;
        std::vector<double> all = sum_;
        all.insert(all.end(), count_.begin(), count_.end());
        collective.sum(all);
        std::copy_n(all.begin(), kBins, sum_.begin());
        std::transform(all.begin() + kBins, all.end(), count_.begin(),
                       [](double count) { return static_cast<std::size_t>(count); });
    }
    /// The least mass that stays, where `share` of the total may go.
    float least_mass(double share) {
        total_ = std::accumulate(sum_.begin(), sum_.end(), 0.0);
        std::size_t bin = 0;
        for (; bin < kBins && dropped_mass_ + sum_[bin] <= share * total_; ++bin) {
            dropped_mass_ += sum_[bin];
            dropped_cells_ += count_[bin];
        }
        return std::bit_cast<float>(static_cast<std::uint32_t>(bin) << 16);
    }
    void tell(double volume_mass, MomentReport& report) const {
        report.mass_ratio = total_ / volume_mass;
        report.dropped_mass_share = dropped_mass_ / volume_mass;
        report.dropped_cells = dropped_cells_;
    }

  private:
    static constexpr std::size_t kBins = 0x7f80;  // of positive finite floats
    std::vector<double> sum_ = std::vector<double>(kBins);
    std::vector<std::size_t> count_ = std::vector<std::size_t>(kBins);
    double total_ = 0, dropped_mass_ = 0;
    std::size_t dropped_cells_ = 0;
};

}  // namespace vog::moments
