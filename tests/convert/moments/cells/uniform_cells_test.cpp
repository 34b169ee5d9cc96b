// uniform_cells_test.cpp: the cells held in memory against the model that is written without them.
#include "convert/moments/cells/uniform_cells.h"

#include <gtest/gtest.h>

#include "support/moment_volumes.h"
#include "vog/convert_moments.h"

namespace vog {

using namespace moments;
namespace {

/// convert_moments makes hard cells of up to 8 voxels from the leaves, without uniform_cells: no
/// cell but the result is held. Both have to make the same ones, of leaves and of tiles.
TEST(uniform_cells, are_the_gaussians_of_the_streamed_conversion) {
    for (const std::uint64_t seed : {31, 32, 33}) {
        const Volume volume = test::random_volume(seed, 0.02 * static_cast<double>(seed - 30));
        ASSERT_FALSE(volume.tiles.empty());
        const LatticeField field = lattice_field(volume);
        for (const int block : {1, 2, 4, 8}) {
            SCOPED_TRACE(testing::Message() << "seed " << seed << ", block " << block);
            MomentOptions options;
            options.block_voxels = block;
            options.soft_steps = 0;
            options.mass_threshold = 0;
            const Gaussians streamed = convert_moments(volume, options);
            const Gaussians held =
                uniform_cells(field, block)
                    .to_gaussians(moment_frame(volume.world_from_index, false, 1));
            ASSERT_EQ(held.size(), streamed.size());
            // Held cells are float32, as models are: a few roundings of 6e-8, means relative to the
            // middle of the data.
            constexpr double kFloat = 1e-6;
            const double extent = world_box(volume).radius();
            for (std::size_t i = 0; i < held.size(); ++i) {
                ASSERT_NEAR(mass(held, i) / mass(streamed, i), 1, kFloat) << i;
                ASSERT_LT(
                    length(vec_cast<double>(held.mean[i]) - vec_cast<double>(streamed.mean[i])),
                    kFloat * extent)
                    << i;
                const Mat3 a = test::covariance(held, i), b = test::covariance(streamed, i);
                const double size = a(0, 0) + a(1, 1) + a(2, 2);
                for (int row = 0; row < 3; ++row)
                    for (int column = 0; column < 3; ++column)
                        ASSERT_NEAR(a(row, column), b(row, column), 2 * kFloat * size) << i;
            }
        }
    }
}

}  // namespace
}  // namespace vog
