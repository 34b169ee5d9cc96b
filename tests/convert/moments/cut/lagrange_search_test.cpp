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
    // Things of different worth, some of the same: as many as are worth more than the lambda.
    std::mt19937 random(3);
    std::uniform_real_distribution<double> logarithm(-40, 3);
    std::vector<double> worth;
    for (int n = 0; n < 5000; ++n) worth.push_back(std::exp(logarithm(random)));
    for (int n = 0; n < 500; ++n) worth.push_back(0.25), worth.push_back(0);
    int calls = 0;
    const auto count = [&](double lambda) {
        ++calls;
        return std::size_t(1) +
               std::size_t(std::ranges::count_if(worth, [&](double one) { return one > lambda; }));
    };
    const double most = std::ranges::max(worth);
    for (const std::size_t budget : {1, 2, 7, 100, 1000, 3000, 5000, 5900, 6001, 7000}) {
        calls = 0;
        const std::size_t found = count(lambda_of_budget(budget, most, count));
        EXPECT_LE(found, budget);
        EXPECT_LT(calls, 60);
        // 501 of one worth are taken together or not at all.
        if (budget < 1000 || budget > 5100) {
            EXPECT_GE(found + budget / 100 + 1,
                      std::min<std::size_t>(budget, budget < 6001 ? 5501 : 6001));
        }
    }
    EXPECT_EQ(lambda_of_budget(10, 0, [](double) { return std::size_t(1); }), kSplitAll);
}

}  // namespace
}  // namespace vog
