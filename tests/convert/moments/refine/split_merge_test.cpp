// split_merge_test.cpp: whose error it is, and cells taken to where it is.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "compare/error_views.h"
#include "convert/moments/cells/uniform_cells.h"
#include "convert/moments/refine/split_merge.h"
#include "vog/convert_moments.h"
#include "vog/sample.h"

namespace vog {

using namespace comparison;
using namespace moments;
namespace {

TEST(moment_error, it_is_given_to_the_gaussians_that_have_it) {
    const Volume volume = sample_explosion({.size = 64});
    MomentOptions options;
    options.block_voxels = 8;
    Gaussians model = convert_moments(volume, options);
    const ErrorViews views(model);  // of itself: no error at first
    for (const float error : views.error_of_each_gaussian(model)) ASSERT_LT(error, 1e-9f);
    EXPECT_LT(views.visible_rms(model), 1e-6);
    const std::size_t spoiled = model.size() / 2;
    model.density[spoiled] *= 3;
    EXPECT_GT(views.visible_rms(model), 1e-4);
    const std::vector<float> errors = views.error_of_each_gaussian(model);
    EXPECT_EQ(std::ranges::max_element(errors) - errors.begin(),
              static_cast<std::ptrdiff_t>(spoiled));
}

TEST(moment_exchange, parts_the_worst_and_joins_others_with_their_moments) {
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
    // The worst have half their mass, of nobody else's pair; most cells stay as they are.
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
