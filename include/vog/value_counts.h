// vog/value_counts.h: distribution of a field's values over its data, weighted by the measure.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "vog/fields.h"

namespace vog {

/// Weights of values in bins of a 256th of a power of two, of both signs: bins that all data share, so that parts, levels and
/// processes add up.
class ValueCounts {
  public:
    static constexpr std::size_t kBins = std::size_t{1} << 16;

    /// value   finite
    /// weight  of the measure; not counted unless it is > 0
    void add(float value, double weight);
    void add(const ValueCounts& other);
    bool empty() const { return weights_.empty(); }
    /// [kBins] for sums over processes
    std::span<double> weights();
    /// Unknown without weight.
    ValueSpread spread() const;

  private:
    std::vector<double> weights_;  ///< [kBins]; empty: nothing counted
};

}  // namespace vog
