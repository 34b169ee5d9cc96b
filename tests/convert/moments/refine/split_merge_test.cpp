// split_merge_test.cpp: moments and counts of a split-and-merge step.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "convert/moments/cells/uniform_cells.h"
#include "convert/moments/refine/split_merge.h"
#include "vog/convert_moments.h"
#include "vog/sample.h"

namespace vog {

using namespace moments;
namespace {

TEST(split_merge, splits_the_worst_and_merges_pairs_with_their_moments) {
    const Volume volume = sample_explosion({.size = 64});
    const LatticeField field = lattice_field(volume);
    PackedCells cells = uniform_cells(field, 8);
    const std::size_t count = cells.size();
    std::vector<float> error(count);
    for (std::size_t i = 0; i < count; ++i) error[i] = static_cast<float>(i * 7919 % count);
    const auto whole = [&] {
        std::vector<Moments> all;
        for (std::size_t i = 0; i < cells.size(); ++i) all.push_back(cells[i]);
        return joined_moments(all);
    };
    const PackedCells before = cells;
    const Moments before_all = whole();
    split_and_merge(cells, error, 0.1, VisibilityWeight(field));
    ASSERT_EQ(cells.size(), count);
    const Moments after_all = whole();
    EXPECT_NEAR(after_all.mass / before_all.mass, 1, 1e-6);
    for (int axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(after_all.mean[axis], before_all.mean[axis], 1e-4);
    for (std::size_t n = 0; n < 6; ++n)
        EXPECT_NEAR(after_all.covariance[n], before_all.covariance[n],
                    1e-5 * before_all.covariance[0]);
    // The worst have half their mass; of three cells changed by each exchange all others are the
    // same.
    const auto parted = static_cast<float>(count - count / 10);
    std::size_t same = 0;
    for (std::size_t i = 0; i < count; ++i) {
        same += cells.mass(i) == before.mass(i);
        if (error[i] >= parted) {
            EXPECT_NEAR(cells.mass(i) / before.mass(i), 0.5, 1e-6) << i;
        }
    }
    EXPECT_EQ(same, count - 3 * (count / 10));
}

}  // namespace
}  // namespace vog
