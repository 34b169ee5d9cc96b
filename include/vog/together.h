// vog/together.h: one conversion by several processes, each with its part of the data.
// The library knows nothing of how they speak to each other: who runs them brings sum and largest.
#pragma once

#include <functional>
#include <span>

namespace vog {

/// Several who make the same calls, at the same time, each with its own part. What has to be known
/// of the whole is the sum, or the largest, of what is known of the parts.
struct Together {
    int index = 0, count = 1;  ///< which of how many
    /// Adds values up over all of them, element by element: each gets the same bytes. Throws where
    /// one of them has failed.
    std::function<void(std::span<double>)> sum{};
    /// The same for the largest of them.
    std::function<void(std::span<double>)> largest{};

    void add_up(std::span<double> values) const {
        if (sum) sum(values);
    }
    void add_up(double& value) const { add_up(std::span(&value, 1)); }
    void keep_largest(std::span<double> values) const {
        if (largest) largest(values);
    }
    bool first() const { return index == 0; }
};

}  // namespace vog
