// lagrange_search_test.cpp: the multiplier of a budget, for counts with jumps.
#include "convert/moments/cut/lagrange_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace vog {

using namespace moments;
namespace {

TEST(lagrange_search, finds_the_multiplier_of_every_budget) {
    // Gains over 19 decades, 500 equal to 0.25 and 500 to 0. The count is 1 plus those above
    // lambda.
    std::mt19937 random(3);
    std::uniform_real_distribution<double> logarithm(-40, 3);
    std::vector<double> gains;
    for (int n = 0; n < 5000; ++n) gains.push_back(std::exp(logarithm(random)));
    for (int n = 0; n < 500; ++n) gains.push_back(0.25), gains.push_back(0);
    int calls = 0;
    const auto count = [&](double lambda) {
        ++calls;
        return std::size_t(1) +
               std::size_t(std::ranges::count_if(gains, [&](double one) { return one > lambda; }));
    };
    const double max_gain = std::ranges::max(gains);
    for (const std::size_t budget : {1, 2, 7, 100, 1000, 3000, 5000, 5900, 6001, 7000}) {
        calls = 0;
        const std::size_t found = count(lambda_of_budget(budget, max_gain, count));
        EXPECT_LE(found, budget);
        EXPECT_LT(calls, 60);
        // The equal gains are split together or not at all.
        if (budget < 1000 || budget > 5100) {
            EXPECT_GE(found + budget / 100 + 1,
                      std::min<std::size_t>(budget, budget < 6001 ? 5501 : 6001));
        }
    }
    EXPECT_EQ(lambda_of_budget(10, 0, [](double) { return std::size_t(1); }), kSplitAll);
}

}  // namespace
}  // namespace vog
