// lagrange_search.h: the price of a Gaussian at which the best cut has as many as a budget allows.
// At a price a cut is best where gains less prices are most: a subtree stays whole or is split by
// what its own subtrees are worth, bottom up, so that a split of little worth never hides better
// ones below it (Chou, Lookabaugh, Gray 1989, optimal pruning). The higher the price, the fewer.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace vog::moments {

/// At this price everything is split: gains may be 0.
inline constexpr double kNoPrice = -1;

/// A price at which count(price) is at most `budget`, and within a thousandth of it where there is
/// one: false position on the logarithms, for which the count is close to a power of the price.
/// most  no gain is more
template <class Count>
double price_of_budget(std::size_t budget, double most, const Count& count) {
    if (!(most > 0) || count(kNoPrice) <= budget) return kNoPrice;
    const auto enough = static_cast<double>(budget - budget / 1000);
    // Too many at `low`, few enough at `high`: logarithms of price and count.
    const double aim = std::log(0.5 * (enough + static_cast<double>(budget)));
    double high = std::log2(most), high_count = 0, low = high, low_count = 0, price = most;
    bool found_low = false;
    constexpr double kStep = 12, kLeast = -300, kResolution = 1e-7;
    for (double step = kStep; !found_low;) {
        const double tried = std::max(low - step, kLeast);
        const std::size_t found = count(std::exp2(tried));
        low = tried, low_count = std::log(static_cast<double>(found));
        found_low = found > budget;
        if (found_low) break;
        price = std::exp2(tried), high = tried, high_count = low_count;
        if (static_cast<double>(found) >= enough || tried <= kLeast) return price;
    }
    for (int tries = 0; high - low > kResolution; ++tries) {
        // Counts jump: every third step halves.
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
        high = tried, high_count = logarithm, price = std::exp2(tried);
        if (static_cast<double>(found) >= enough) break;
    }
    return price;
}

}  // namespace vog::moments
