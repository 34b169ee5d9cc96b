// error_search_test.cpp: budgets found for errors in closed form.
#include "convert/moments/error_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "vog/budget_search.h"
#include "vog/convert_moments.h"
#include "vog/distributed.h"

namespace vog {

using namespace moments;
namespace {

constexpr std::size_t kFinest = 1000000;
constexpr double kTolerance = 1.05;

/// Calls of the error function, in order.
struct Calls {
    std::vector<std::size_t> budgets;
    std::function<double(std::size_t)> error;

    double operator()(std::size_t budget) {
        budgets.push_back(budget);
        return error(budget);
    }
};

TEST(error_search, powers_of_the_count_are_inverted_to_five_percent) {
    for (const double power : {-0.15, -0.35, -0.6, -0.95})
        for (const std::size_t exact : {3u, 60u, 4000u, 90000u, 900000u}) {
            SCOPED_TRACE(testing::Message() << "power " << power << ", budget " << exact);
            const auto error = [&](std::size_t budget) {
                return std::pow(static_cast<double>(budget), power);
            };
            const double target = error(exact);
            Calls calls{{}, error};
            const std::size_t found = smallest_budget(target, kFinest, std::ref(calls));
            EXPECT_LE(error(found), target);
            // One more where 5 % are less than one Gaussian.
            EXPECT_LE(static_cast<double>(found), kTolerance * static_cast<double>(exact) + 1);
            EXPECT_LE(calls.budgets.size(), 12u);
        }
}

TEST(error_search, each_budget_within_the_target_is_smaller_than_the_last) {
    // Errors in steps, as those of cuts are, and far from a power of the count.
    for (const double target : {0.02, 0.1, 0.3, 0.7}) {
        const auto error = [](std::size_t budget) {
            return std::exp(-std::floor(std::sqrt(static_cast<double>(budget)) / 20) / 5);
        };
        Calls calls{{}, error};
        const std::size_t found = smallest_budget(target, kFinest, std::ref(calls));
        std::size_t last = kFinest + 1;
        for (const std::size_t budget : calls.budgets) {
            if (error(budget) > target) continue;
            EXPECT_LT(budget, last);
            last = budget;
        }
        EXPECT_EQ(found, last) << "the last budget within the target is the result";
    }
}

TEST(error_search, a_target_below_the_finest_error_gives_the_finest) {
    for (const std::size_t finest : {1u, 2u, 1000u}) {
        Calls calls{{}, [](std::size_t) { return 0.5; }};
        EXPECT_EQ(smallest_budget(0.1, finest, std::ref(calls)), finest);
        EXPECT_EQ(calls.budgets.back(), finest);
        EXPECT_LE(calls.budgets.size(), 13u);
    }
}

TEST(error_search, an_error_of_zero_gives_few) {
    EXPECT_LE(smallest_budget(0.1, kFinest, [](std::size_t) { return 0.0; }), 1u);
}

TEST(error_search, a_good_first_guess_saves_tries) {
    const auto error = [](std::size_t budget) {
        return 3 * std::pow(static_cast<double>(budget), kErrorPower);
    };
    const auto tries = [&](double first) {
        Calls calls{{}, error};
        smallest_budget(error(200000), kFinest, std::ref(calls), first);
        return calls.budgets.size();
    };
    EXPECT_LT(tries(200000), 4u);
    EXPECT_GT(tries(10), tries(200000));
}

TEST(error_search, an_error_below_that_of_interpolation_is_enough) {
    const RelativeError interpolation{0.1, 0.05};
    constexpr std::size_t kLarge = kSmallCount + 1;
    const auto beyond = [&](double worst, double mean, double target, std::size_t finest) {
        return error_beyond_interpolation({worst, mean}, interpolation, target, finest);
    };
    EXPECT_DOUBLE_EQ(beyond(0.1, 0.05, 0.02, kLarge), 0.02);
    EXPECT_DOUBLE_EQ(beyond(0.2, 0.05, 0.02, kLarge), 0.04);
    EXPECT_DOUBLE_EQ(beyond(0.1, 0.1, 0.02, kLarge), 0.04) << "the mean counts, too";
    EXPECT_DOUBLE_EQ(beyond(0.3, 0.2, 0.15, kLarge), 0.3) << "a target above that of interpolation";
    EXPECT_DOUBLE_EQ(beyond(0.2, 0.05, 0.02, kSmallCount), 0.2) << "small data";
}

/// Search for 0.02 among up to 1,000,000 Gaussians, 1/16 of them first, whose error is 0.1 at 60,000; voxels alone have `voxels`.
ErrorSearch search_of(double voxels, std::vector<std::size_t>& tried, std::size_t& kept) {
    ErrorSearch search;
    search.target = 0.02;
    search.few = kFinest / kVoxelsPerGaussian;
    search.finest = kFinest;
    search.error_of_budget = [&](std::size_t budget) {
        tried.push_back(budget);
        const double error = 0.1 * std::pow(static_cast<double>(budget) / 60000, kErrorPower);
        return RelativeError{error, error};
    };
    search.keep = [&] { kept = tried.back(); };
    search.error_of_voxels = [voxels] { return RelativeError{voxels, voxels}; };
    return search;
}

TEST(error_search, a_gaussian_for_each_voxel_ends_a_search_where_it_is_as_far) {
    std::vector<std::size_t> tried;
    std::size_t kept = 0;
    RelativeError interpolation{0.03, 0.03};
    find_budget(search_of(0.09, tried, kept), interpolation);
    EXPECT_EQ(kept, kFinest / kVoxelsPerGaussian);
    EXPECT_DOUBLE_EQ(interpolation.worst, 1.125 * 0.09);

    tried.clear();
    interpolation = {0.05, 0.05};
    const RelativeError found = find_budget(search_of(0.04, tried, kept), interpolation);
    EXPECT_LE(found.worst, 0.05) << "more help";
    EXPECT_GT(kept, kFinest / kVoxelsPerGaussian);
    EXPECT_DOUBLE_EQ(interpolation.worst, 0.05);

    tried.clear();
    ErrorSearch search = search_of(0.04, tried, kept);
    search.beyond_few = false;
    find_budget(search, interpolation);
    EXPECT_EQ(kept, kFinest / kVoxelsPerGaussian) << "the default has no more";
}

}  // namespace
}  // namespace vog
