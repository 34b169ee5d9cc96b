// dense_volume_test.cpp: conversion between dense arrays and sparse volumes.
#include "vog/dense.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "vog/error.h"
#include "vog/progress.h"

namespace vog {
namespace {

/// Dense array in C order, z fastest.
struct Array {
    Vec3i size;
    std::vector<float> value;

    explicit Array(Vec3i shape, float fill = 0)
        : size(shape), value(static_cast<std::size_t>(shape.x * shape.y * shape.z), fill) {}
    float& at(Vec3i p) {
        return value[static_cast<std::size_t>((p.x * size.y + p.y) * size.z + p.z)];
    }
    DenseBlock block(Vec3i first = {}) const {
        return {value.data(), size, {size.y * size.z, size.z, 1}, first, nullptr, {}};
    }
};

/// Clusters of active voxels, about a third of all, so that some leaves have none.
Array random_array(Vec3i size, unsigned seed) {
    std::mt19937 random(seed);
    Array array(size);
    for (int x = 0; x < size.x; ++x)
        for (int y = 0; y < size.y; ++y)
            for (int z = 0; z < size.z; ++z)
                if ((x / 9 + y / 9 + z / 9) % 3 == 0)
                    array.at({x, y, z}) = static_cast<float>(random() % 1000) / 1000;
    return array;
}

std::vector<float> back(const Volume& volume, Vec3i first, Vec3i size) {
    std::vector<float> values(static_cast<std::size_t>(size.x * size.y * size.z), -1);
    copy_dense(volume, first, size, values);
    return values;
}

std::string message_of(std::span<const DenseBlock> blocks) {
    try {
        (void)volume_from_dense(blocks);
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

TEST(dense, comes_back_as_it_was_wherever_it_lies) {
    for (const Vec3i first : {Vec3i{}, {3, -5, 8}, {-17, 1000, -8}})
        for (const Vec3i size : {Vec3i{1, 1, 1}, {8, 8, 8}, {20, 33, 9}, {7, 1, 30}}) {
            Array array = random_array(size, 7);
            array.at({}) = 2;
            const DenseBlock block = array.block(first);
            const Volume volume = volume_from_dense({&block, 1});
            EXPECT_EQ(back(volume, first, size), array.value);
            std::uint64_t above = 0;
            for (const float v : array.value) above += v > 0;
            EXPECT_EQ(active_voxels(volume), above);
        }
}

TEST(dense, a_voxel_is_where_its_index_says) {
    Array array({30, 40, 50});
    array.at({11, 22, 33}) = 5;
    const DenseBlock block = array.block();
    const Volume volume = volume_from_dense({&block, 1}, affine_from_voxels({2, 3, 4}, {1, 1, 1}));
    const IndexBox box = active_box(volume);
    EXPECT_EQ(box.lower, (Vec3i{11, 22, 33}));
    EXPECT_EQ(box.upper, box.lower);
    EXPECT_EQ(volume.world_from_index(Vec3d{11, 22, 33}), (Vec3d{23, 67, 133}));
    EXPECT_DOUBLE_EQ(mass(volume), 5 * 24.0);
}

TEST(dense, any_strides_mean_the_same_volume) {
    Array array = random_array({18, 21, 10}, 3);
    // The same values with x fastest and reversed y.
    Array other({10, 21, 18});
    for (int x = 0; x < 18; ++x)
        for (int y = 0; y < 21; ++y)
            for (int z = 0; z < 10; ++z) other.at({z, 20 - y, x}) = array.at({x, y, z});
    const DenseBlock one = array.block();
    const DenseBlock two{&other.at({0, 20, 0}), array.size, {1, -18, 21 * 18}, {}, nullptr, {}};
    const Volume a = volume_from_dense({&one, 1}), b = volume_from_dense({&two, 1});
    ASSERT_EQ(a.leaves.size(), b.leaves.size());
    for (std::size_t n = 0; n < a.leaves.size(); ++n) {
        EXPECT_EQ(a.leaves[n].mask, b.leaves[n].mask);
        EXPECT_EQ(a.leaves[n].value, b.leaves[n].value);
    }
}

TEST(dense, a_mask_says_what_is_active_even_at_zero) {
    Array array({9, 9, 9}, 1);
    array.at({4, 4, 4}) = 0;
    array.at({0, 0, 0}) = std::numeric_limits<float>::quiet_NaN();
    std::vector<std::uint8_t> mask(729, 0);
    mask[(4 * 9 + 4) * 9 + 4] = 1;
    DenseBlock block = array.block();
    block.active = mask.data();
    block.active_stride = block.stride;
    const Volume volume = volume_from_dense({&block, 1});
    EXPECT_EQ(active_voxels(volume), 1u) << "what is not active is not looked at";
    EXPECT_EQ(mass(volume), 0);
}

TEST(dense, later_blocks_lie_over_earlier_ones) {
    const Array below({12, 12, 12}, 1), above({6, 6, 6}, 3);
    const std::vector<DenseBlock> blocks{below.block(), above.block({9, 9, 9}),
                                         above.block({-20, 0, 0})};
    const Volume volume = volume_from_dense(blocks);
    EXPECT_EQ(active_voxels(volume), 12u * 12 * 12 + 6 * 6 * 6 - 3 * 3 * 3 + 6 * 6 * 6);
    EXPECT_DOUBLE_EQ(mass(volume), 1728.0 - 27 + 2 * 3 * 216);
    EXPECT_EQ(back(volume, {9, 9, 9}, {1, 1, 1}).front(), 3);
    EXPECT_EQ(back(volume, {8, 9, 9}, {1, 1, 1}).front(), 1);
}

TEST(dense, the_same_for_any_number_of_threads) {
    const Array array = random_array({70, 40, 50}, 5);
    const DenseBlock block = array.block({-3, 2, 1});
    const Volume many = volume_from_dense({&block, 1});
    const ThreadLimit limit(1);
    const Volume one = volume_from_dense({&block, 1});
    ASSERT_EQ(one.leaves.size(), many.leaves.size());
    for (std::size_t n = 0; n < one.leaves.size(); ++n) {
        EXPECT_EQ(one.leaves[n].origin, many.leaves[n].origin);
        EXPECT_EQ(one.leaves[n].value, many.leaves[n].value);
    }
}

TEST(dense, what_is_no_density_is_counted_and_shown) {
    Array array({10, 10, 10}, 1);
    array.at({9, 1, 2}) = -2;
    array.at({3, 9, 4}) = std::numeric_limits<float>::infinity();
    array.at({1, 9, 4}) = std::numeric_limits<float>::quiet_NaN();
    const DenseBlock block = array.block();
    EXPECT_EQ(
        message_of({&block, 1}),
        "density: 3 values that are no densities, the first nan at [1, 9, 4], expected finite "
        "and >= 0 (skip_nonfinite leaves such voxels out, clip_negative sets them to 0)");
    array.at({9, 1, 2}) = -2;
    ValueNotes notes;
    const Volume volume = volume_from_dense({&block, 1}, {}, "density", {true, true}, &notes);
    EXPECT_EQ(notes.skipped_nonfinite, 2u);
    EXPECT_EQ(notes.clipped_negative, 1u);
    EXPECT_EQ(active_voxels(volume), 997u);
    EXPECT_THROW((void)volume_from_dense({&block, 1}, {}, "density", {true, false}), Error);
    EXPECT_THROW((void)volume_from_dense({&block, 1}, {}, "density", {false, true}), Error);
}

TEST(dense, arrays_that_are_no_volume_are_refused) {
    const Array empty({4, 4, 4});
    DenseBlock block = empty.block();
    EXPECT_EQ(message_of({&block, 1}), "density: no active voxel, expected some above 0");
    EXPECT_EQ(message_of({}), "density: no active voxel, expected some above 0");
    block.size.y = 0;
    EXPECT_EQ(message_of({&block, 1}), "density: 0 voxels along axis 1, expected at least 1");
    block = empty.block({0, 0, 1 << 30});
    EXPECT_NE(message_of({&block, 1}).find("expected within +-2^30"), std::string::npos);
    std::vector<float> three(3);
    EXPECT_THROW(copy_dense(Volume{}, {}, {1, 1, 4}, three), Error);
    EXPECT_THROW(copy_dense(Volume{}, {}, {0, 1, 1}, {}), Error);
    EXPECT_THROW((void)active_box(Volume{}), Error);
}

TEST(dense, tiles_are_filled) {
    Volume volume;
    volume.tiles.push_back({{8, 0, 0}, 8, 2.5f});
    volume.tiles.push_back({{128, 0, 0}, 128, 1});
    EXPECT_EQ(active_box(volume).lower, (Vec3i{8, 0, 0}));
    EXPECT_EQ(active_box(volume).upper, (Vec3i{255, 127, 127}));
    const std::vector<float> values = back(volume, {15, 7, 7}, {2, 2, 1});
    EXPECT_EQ(values, (std::vector<float>{2.5f, 0, 0, 0}));
    EXPECT_EQ(back(volume, {127, 0, 127}, {2, 1, 1}), (std::vector<float>{0, 1}));
}

TEST(dense, maps_from_matrices_and_voxels) {
    const std::array<double, 16> m{0, 2, 0, 5, 1, 0, 0, 6, 0, 0, 3, 7, 0, 0, 0, 1};
    EXPECT_EQ(affine_from_matrix(m)(Vec3d{1, 10, 100}), (Vec3d{25, 7, 307}));
    std::array<double, 16> row_vectors{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1};
    EXPECT_THROW((void)affine_from_matrix(row_vectors), Error);
    EXPECT_THROW((void)affine_from_matrix(
                     std::array<double, 16>{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1}),
                 Error);
    EXPECT_EQ(affine_from_voxels({1, 2, 3}, {4, 5, 6})(Vec3d{1, 1, 1}), (Vec3d{5, 7, 9}));
    EXPECT_THROW((void)affine_from_voxels({1, 0, 1}), Error);
    EXPECT_THROW((void)affine_from_voxels({1, 1, std::nan("")}), Error);
    EXPECT_THROW((void)affine_from_voxels({1, 1, 1}, {std::nan(""), 0, 0}), Error);
}

}  // namespace
}  // namespace vog
