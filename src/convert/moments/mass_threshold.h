// mass_threshold.h: the mass below which cells are dropped, from a histogram of masses.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "vog/convert_moments.h"
#include "vog/distributed.h"
#include "vog/error.h"

namespace vog::moments {

/// Finds the largest mass such that the lighter cells together have at most a given share of the
/// total. Bins are the upper 16 bits of a float32, so cells within 1 % of each other share a bin
/// and are kept or dropped together. Memory: 0.5 MB.
class MassThreshold {
  public:
    /// mass  finite, >= 0; any other counts in the last bin, and least_mass throws
    void add(float mass) {
        const auto bin = std::min<std::size_t>(std::bit_cast<std::uint32_t>(mass) >> 16, kBins - 1);
        sum_[bin] += static_cast<double>(mass);
        ++count_[bin];
    }
    /// Adds the cells of all processes. Sums of up to 2^29 floats of one bin are exact in a double,
    /// so the result does not depend on the order of cells or on how they are distributed.
    void sum_over(const Collective& collective) {
        if (!collective.shared()) return;
        std::vector<double> all = sum_;
        all.insert(all.end(), count_.begin(), count_.end());
        collective.sum(all);
        std::copy_n(all.begin(), kBins, sum_.begin());
        std::transform(all.begin() + kBins, all.end(), count_.begin(),
                       [](double count) { return static_cast<std::size_t>(count); });
    }
    /// Mass from which on cells are kept. Call once, after all add().
    /// share   of the total mass that may be dropped, [0, 1)
    /// throws  vog::Error if the total is not finite
    float least_mass(double share) {
        total_ = std::accumulate(sum_.begin(), sum_.end(), 0.0);
        if (!std::isfinite(total_))
            throw Error("the masses of cells leave the range of 32-bit floats");
        std::size_t bin = 0;
        for (; bin < kBins && dropped_mass_ + sum_[bin] <= share * total_; ++bin) {
            dropped_mass_ += sum_[bin];
            dropped_cells_ += count_[bin];
        }
        return std::bit_cast<float>(static_cast<std::uint32_t>(bin) << 16);
    }
    /// Records what the threshold drops.
    /// volume_mass  of the voxels, in the unit of the cells' masses
    void write_to(MomentReport& report, double volume_mass) const {
        report.mass_ratio = total_ / volume_mass;
        report.dropped_mass_share = dropped_mass_ / volume_mass;
        report.dropped_cells = dropped_cells_;
    }

  private:
    static constexpr std::size_t kBins = 0x7f80;  // the positive finite floats
    std::vector<double> sum_ = std::vector<double>(kBins);
    std::vector<std::size_t> count_ = std::vector<std::size_t>(kBins);
    double total_ = 0, dropped_mass_ = 0;
    std::size_t dropped_cells_ = 0;
};

}  // namespace vog::moments
