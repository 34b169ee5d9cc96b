// subject_test.cpp: what views frame: the hull of what is seen, the same for a volume, its models and its parts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include "vog/camera.h"
#include "vog/convert_moments.h"
#include "vog/convert_paper.h"
#include "vog/dense.h"
#include "vog/levels.h"
#include "vog/picture.h"
#include "vog/ply.h"
#include "vog/subject.h"
#include "vog/vogz.h"

namespace vog {
namespace {

/// A ball of radius 10 voxels about (20, 24, 60) in a box of 40 x 48 x 120, in which a haze of a share of its density fills the rest.
Volume ball_in_haze(float haze) {
    const Vec3i size{40, 48, 120};
    std::vector<float> values;
    for (int x = 0; x < size.x; ++x)
        for (int y = 0; y < size.y; ++y)
            for (int z = 0; z < size.z; ++z)
                values.push_back(std::hypot(x - 20.0, y - 24.0, z - 60.0) < 10 ? 1 : haze);
    const DenseBlock block{values.data(), size, {48 * 120, 120, 1}, {}};
    return volume_from_dense({&block, 1}, affine_from_voxels({0.5, 0.5, 0.5}));
}

/// Extent of a hull along a direction, world units.
std::pair<double, double> extent(const std::vector<Vec3d>& hull, Vec3d along) {
    const auto [low, high] = std::ranges::minmax(hull, {}, [&](Vec3d p) { return dot(p, along); });
    return {dot(low, along), dot(high, along)};
}

TEST(subject, the_hull_holds_what_is_seen_from_everywhere_and_no_haze) {
    const Volume volume = ball_in_haze(1e-5f);
    const Content content = content_of({&volume, 1}, world_box(volume));
    EXPECT_EQ(content.voxels, (Box{{-0.25, -0.25, -0.25}, {19.75, 23.75, 59.75}}));
    const Vec3d center{10, 12, 30};
    const double cell = 60.0 / 96;
    for (const Vec3d v : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}, Vec3d{1, 1, 0},
                          Vec3d{1, -2, 3}, Vec3d{-5, 1, 2}}) {
        const Vec3d along = normalized(v);
        const auto [low, high] = extent(content.hull, along);
        EXPECT_NEAR(high, dot(center, along) + 5, 2 * cell);
        EXPECT_NEAR(low, dot(center, along) - 5, 2 * cell);
    }
    // A haze that is seen counts.
    const Volume dense = ball_in_haze(0.05f);
    const auto [low, high] = extent(content_of({&dense, 1}, world_box(dense)).hull, {0, 0, 1});
    EXPECT_LT(low, 1);
    EXPECT_GT(high, 59);
}

TEST(subject, a_model_has_its_volumes_subject_also_from_a_file) {
    Volume volume = ball_in_haze(1e-5f);
    volume.standing = {{0, 0, 1}, {0, 1, 0}};
    const Content content = content_of({&volume, 1}, world_box(volume));
    MomentOptions options;
    options.block_voxels = 4;
    Composite mesh = composite({{volume}, {}});
    const std::filesystem::path folder = testing::TempDir();
    for (const Gaussians& model : {convert_moments(volume, options), convert_moments(mesh, options),
                                   convert_paper(volume)}) {
        EXPECT_EQ(model.content.hull, content.hull);
        EXPECT_EQ(model.content.voxels, content.voxels);
        EXPECT_EQ(model.content.standing, content.standing);
        write_ply(folder / "subject_test.ply", model);
        write_vogz(folder / "subject_test.vogz", model);
        for (const Gaussians& read :
             {read_ply(folder / "subject_test.ply"), read_vogz(folder / "subject_test.vogz")}) {
            EXPECT_EQ(read.content.voxels, content.voxels);
            EXPECT_EQ(read.content.standing, content.standing);
            ASSERT_EQ(read.content.hull.size(), content.hull.size());
            for (std::size_t n = 0; n < content.hull.size(); ++n)
                EXPECT_LT(length(read.content.hull[n] - content.hull[n]), 1e-5);
        }
    }
    // A model that knows nothing of its source has the hull of its Gaussians.
    Gaussians other = convert_moments(volume, options);
    other.content = {};
    const Camera own = orbit_view(subject_of(other)),
                 known = orbit_view(subject_of(world_box(volume), content));
    EXPECT_NEAR(length(own.eye - own.look_at) / length(known.eye - known.look_at), 1, 0.03);
}

TEST(subject, several_models_are_framed_together) {
    Content one{{{0, 0, 0}, {1, 1, 1}}, {{0, 0, 0}, {1, 1, 1}}},
        two{{{2, 2, 2}, {3, 4, 5}}, {{3, 4, 5}}, {{0, 0, 1}, {}}};
    Content both = one;
    both.include(two);
    EXPECT_EQ(both.voxels, (Box{{0, 0, 0}, {3, 4, 5}}));
    EXPECT_EQ(both.hull.size(), 3);
    EXPECT_EQ(both.standing.up, (Vec3d{0, 0, 1}));
    both.include({});
    EXPECT_TRUE(both.hull.empty());  // of unknown parts nothing is known
}

TEST(subject, gaussians_of_few_voxels_lie_within_the_frame) {
    Volume two;
    two.world_from_index = affine_from_voxels({0.5, 0.5, 0.5}, {});
    two.leaves.emplace_back().set(0, 1), two.leaves.back().set(1, 3);
    const Gaussians model = convert_moments(two, {});
    const Image image = render(scene_of(model), {.width = 40, .height = 40}).image;
    for (int n = 0; n < 40; ++n)
        for (const auto& [x, y] : {std::pair{n, 0}, {n, 39}, {0, n}, {39, n}})
            EXPECT_EQ(image.at(x, y).r, 0) << x << ' ' << y;
}

TEST(subject, data_without_extent_or_light_have_a_view) {
    EXPECT_TRUE(content_of(std::span<const Volume>{}, {}).hull.empty());
    Volume empty;
    EXPECT_TRUE(voxel_box(empty).empty());
    EXPECT_NO_THROW((void)frame_of(orbit_view(subject_of(Gaussians{})), 8, 8));
    Volume dark;
    dark.leaves.emplace_back().set(77, 0);
    const Content content = content_of({&dark, 1}, world_box(dark));
    EXPECT_TRUE(content.hull.empty());
    EXPECT_FALSE(content.voxels.empty());
}

}  // namespace
}  // namespace vog
