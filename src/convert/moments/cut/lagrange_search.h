// lagrange_search.h: the Lagrange multiplier at which the optimal pruning has as many leaves as a
// budget.
// Optimal pruning (Chou, Lookabaugh, Gray 1989) maximises the sum over splits of gain - lambda.
// Bottom up, a subtree is split if its own split and its optimally pruned children are worth more
// than 0 together, so a split of little gain never hides better ones below it. The count of leaves
// falls with lambda.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace vog::moments {

/// Multiplier under which every split is made, even one of gain 0.
inline constexpr double kSplitAll = -1;

/// Finds lambda with count(lambda) <= budget, and within a thousandth of it unless the count jumps
/// there: false position on the logarithms, as the count is close to a power of lambda.
/// max_gain  largest gain of any split
/// count     leaves of the optimal pruning under a multiplier, not increasing in it
template <class Count>
double lambda_of_budget(std::size_t budget, double max_gain, const Count& count) {
    if (!(max_gain > 0) || count(kSplitAll) <= budget) return kSplitAll;
    const auto enough = static_cast<double>(budget - budget / 1000);
    const double aim = std::log(0.5 * (enough + static_cast<double>(budget)));
    // log2 of lambda: too many leaves at `low`, few enough at `high`.
    double high = std::log2(max_gain), high_count = 0, low = high, low_count = 0, lambda = max_gain;
    constexpr double kStep = 12, kLeast = -300, kResolution = 1e-7;
    for (bool found_low = false; !found_low;) {
        const double tried = std::max(low - kStep, kLeast);
        const std::size_t found = count(std::exp2(tried));
        low = tried, low_count = std::log(static_cast<double>(found));
        found_low = found > budget;
        if (found_low) break;
        lambda = std::exp2(tried), high = tried, high_count = low_count;
        if (static_cast<double>(found) >= enough || tried <= kLeast) return lambda;
    }
    for (int tries = 0; high - low > kResolution; ++tries) {
        // Counts jump: every third step bisects.
        const double share =
            tries % 3 == 2 ? 0.5
                           : std::clamp((low_count - aim) / (low_count - high_count), 0.02, 0.98);
        const double tried = low + share * (high - low);
        const std::size_t found = count(std::exp2(tried));
        const double logarithm = std::log(static_cast<double>(found));
        if (found > budget) {
            low = tried, low_count = logarithm;
            continue;
        }
        high = tried, high_count = logarithm, lambda = std::exp2(tried);
        if (static_cast<double>(found) >= enough) break;
    }
    return lambda;
}

}  // namespace vog::moments
