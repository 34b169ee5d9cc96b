// error_views_test.cpp: cropped depth images, and errors attributed to single Gaussians.
#include "compare/error_views.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "vog/convert_moments.h"
#include "vog/sample.h"

namespace vog {

using namespace comparison;
namespace {

TEST(error_views, cropped_rows_return_every_pixel) {
    DepthImage image(5, 3);
    image.at(1, 0) = 2, image.at(3, 0) = 1, image.at(4, 2) = 3;
    const CroppedDepth cropped(image);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) EXPECT_EQ(cropped.at(x, y), image.at(x, y));
}

TEST(error_views, a_spoiled_gaussian_has_the_largest_error) {
    const Volume volume = sample_explosion({.size = 64});
    MomentOptions options;
    options.block_voxels = 8;
    Gaussians model = convert_moments(volume, options);
    const ErrorViews views(model);  // its own reference: no error yet
    for (const float error : views.error_of_each_gaussian(model)) ASSERT_LT(error, 1e-9f);
    EXPECT_LT(views.visible_rms(model), 1e-6);
    const std::size_t spoiled = model.size() / 2;
    model.density[spoiled] *= 3;
    EXPECT_GT(views.visible_rms(model), 1e-4);
    const std::vector<float> errors = views.error_of_each_gaussian(model);
    EXPECT_EQ(std::ranges::max_element(errors) - errors.begin(),
              static_cast<std::ptrdiff_t>(spoiled));
}

}  // namespace
}  // namespace vog
