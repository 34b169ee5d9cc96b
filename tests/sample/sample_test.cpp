// sample_test.cpp: synthetic volumes: reproducible bytes, the documented mix of leaves and tiles,
// one shape at every size.
#include "vog/sample.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/morton.h"
#include "sample/density_field.h"
#include "vog/error.h"
#include "vog/levels.h"

namespace vog {

using namespace sampling;
namespace {

struct Kind {
    const char* name;
    Volume (*sample)(const SampleOptions&);
    std::unique_ptr<DensityField> (*field)(std::uint32_t seed, float voxel);
    double low_share, high_share;  ///< of active voxels among size^3
    std::uint64_t bytes_hash;      ///< at size 64, seed 1
};

void PrintTo(const Kind& kind, std::ostream* out) { *out << kind.name; }

Volume sample(const Kind& kind, int size, std::uint32_t seed = 1) {
    SampleOptions options;
    options.size = size;
    options.seed = seed;
    return kind.sample(options);
}

/// Volume of size 128, shared by several tests.
const Volume& sample_128(const Kind& kind) {
    static std::map<std::string, Volume> volumes;
    const auto found = volumes.find(kind.name);
    return found != volumes.end() ? found->second
                                  : volumes.emplace(kind.name, sample(kind, 128)).first->second;
}

bool same_bytes(const Volume& a, const Volume& b) {
    if (a.leaves.size() != b.leaves.size() || a.tiles.size() != b.tiles.size()) return false;
    for (std::size_t i = 0; i < a.leaves.size(); ++i) {
        const Leaf &x = a.leaves[i], &y = b.leaves[i];
        if (x.origin != y.origin || x.mask != y.mask ||
            std::memcmp(x.value.data(), y.value.data(), sizeof x.value) != 0)
            return false;
    }
    for (std::size_t i = 0; i < a.tiles.size(); ++i) {
        const Tile &x = a.tiles[i], &y = b.tiles[i];
        if (x.origin != y.origin || x.edge != y.edge ||
            std::memcmp(&x.value, &y.value, sizeof x.value) != 0)
            return false;
    }
    return a.world_from_index == b.world_from_index;
}

/// FNV-1a hash of the data that same_bytes compares.
class Hash {
  public:
    template <class T>
    void add(const T& value) {
        unsigned char bytes[sizeof value];
        std::memcpy(bytes, &value, sizeof value);
        for (const unsigned char byte : bytes) state_ = (state_ ^ byte) * 0x100000001b3u;
    }
    std::uint64_t state() const { return state_; }

  private:
    std::uint64_t state_ = 0xcbf29ce484222325u;
};

std::uint64_t hash_of(const Volume& volume) {
    Hash hash;
    for (const Leaf& leaf : volume.leaves) {
        hash.add(leaf.origin);
        hash.add(leaf.mask);
        hash.add(leaf.value);
    }
    for (const Tile& tile : volume.tiles) {
        hash.add(tile.origin);
        hash.add(tile.edge);
        hash.add(tile.value);
    }
    return hash.state();
}

double partial_share(const Volume& volume) {
    double partial = 0;
    for (const Leaf& leaf : volume.leaves) partial += leaf.dense() ? 0 : 1;
    return partial / static_cast<double>(volume.leaves.size());
}

/// World bounding box of the centres of active voxels.
Box active_box(const Volume& volume) {
    Box box;
    for (const Leaf& leaf : volume.leaves)
        for (int n = 0; n < kLeafVoxels; ++n)
            if (leaf.active(n))
                box.include(volume.world_from_index(
                    vec_cast<double>(leaf.origin + Vec3i{n >> 6, (n >> 3) & 7, n & 7})));
    for (const Tile& tile : volume.tiles) {
        const Vec3i last = tile.origin + (tile.edge - 1) * Vec3i{1, 1, 1};
        box.include(volume.world_from_index(vec_cast<double>(tile.origin)));
        box.include(volume.world_from_index(vec_cast<double>(last)));
    }
    return box;
}

/// Mass in each of 8^3 world cells of edge 1/8, comparable between sizes. Sizes must be multiples
/// of 64, so that each leaf is within one cell.
std::vector<double> coarse_masses(const Volume& volume) {
    std::vector<double> masses(512, 0.0);
    const double voxel = voxel_volume(volume);
    const auto add = [&](Vec3i origin, double mass) {
        const Vec3d world = volume.world_from_index(vec_cast<double>(origin));
        std::size_t cell = 0;
        for (int axis = 0; axis < 3; ++axis)
            cell = cell * 8 + static_cast<std::size_t>(std::floor((world[axis] + 0.5) * 8));
        masses.at(cell) += mass * voxel;
    };
    for (const Leaf& leaf : volume.leaves) {
        double sum = 0;
        for (const float value : leaf.value) sum += value;
        add(leaf.origin, sum);
    }
    for (const Tile& tile : volume.tiles)
        add(tile.origin, static_cast<double>(tile.value) * tile.edge * tile.edge * tile.edge);
    return masses;
}

/// Field without its bounds, so that every leaf of [-1/2, 1/2]^3 is evaluated.
class Unbounded final : public DensityField {
  public:
    explicit Unbounded(const DensityField& field) : field_(field) {}
    Interval range(Vec3f center, float radius) const override {
        const Vec3f far{std::abs(center.x), std::abs(center.y), std::abs(center.z)};
        return {0, std::max({far.x, far.y, far.z}) - radius > 0.5f ? 0.0f : 1.0f};
    }
    void evaluate(const LeafPoints& points, LeafValues density) const override {
        field_.evaluate(points, density);
    }

  private:
    const DensityField& field_;
};

class sample_kinds : public testing::TestWithParam<Kind> {};

TEST_P(sample_kinds, same_bytes_for_any_number_of_threads) {
    std::vector<Volume> volumes;
    for (const int threads : {1, 2, 8}) {
        const ThreadLimit limit(threads);
        volumes.push_back(sample(GetParam(), 80));
    }
    EXPECT_TRUE(same_bytes(volumes[0], volumes[1]));
    EXPECT_TRUE(same_bytes(volumes[0], volumes[2]));
}

TEST_P(sample_kinds, same_bytes_on_every_machine) {
    // Fails if a compiler rounds differently. A change of the shape needs the new hash.
    EXPECT_EQ(hash_of(sample(GetParam(), 64)), GetParam().bytes_hash);
}

TEST_P(sample_kinds, seed_changes_the_shape) {
    const Volume one = sample(GetParam(), 64, 1), two = sample(GetParam(), 64, 2);
    EXPECT_FALSE(same_bytes(one, two));
    EXPECT_NE(mass(one), mass(two));
}

TEST_P(sample_kinds, valid_and_within_the_density_range) {
    const Volume& volume = sample_128(GetParam());
    EXPECT_NO_THROW(validate(volume));
    EXPECT_EQ(volume.name, "density");
    EXPECT_EQ(volume.source, std::string("sample ") + GetParam().name);
    for (const Leaf& leaf : volume.leaves) {
        ASSERT_GT(leaf.active_count(), 0);
        for (int n = 0; n < kLeafVoxels; ++n) {
            const float value = leaf.value[static_cast<std::size_t>(n)];
            if (leaf.active(n))
                ASSERT_TRUE(value > kFaintestDensity && value <= 1.1f) << value;
            else
                ASSERT_EQ(value, 0);
        }
    }
}

TEST_P(sample_kinds, many_partly_filled_leaves_and_the_documented_share) {
    const Volume& volume = sample_128(GetParam());
    EXPECT_GT(partial_share(volume), 0.5);
    const double share = static_cast<double>(active_voxels(volume)) / (128.0 * 128 * 128);
    EXPECT_GE(share, GetParam().low_share);
    EXPECT_LE(share, GetParam().high_share);
}

TEST_P(sample_kinds, tiles_at_every_size) {
    // Also sizes that are no multiples of a leaf's edge, with leaves elsewhere in the world.
    for (const int size : {64, 71, 90})
        for (const std::uint32_t seed : {1u, 7u})
            EXPECT_FALSE(sample(GetParam(), size, seed).tiles.empty()) << size << " seed " << seed;
}

TEST_P(sample_kinds, about_one_world_unit_and_centred) {
    for (const std::uint32_t seed : {1u, 2u, 3u}) {
        const Volume volume = sample(GetParam(), 64, seed);
        EXPECT_DOUBLE_EQ(voxel_volume(volume), 1.0 / (64 * 64 * 64));
        const Box box = active_box(volume);
        const Vec3d size = box.upper - box.lower;
        EXPECT_GT(std::max({size.x, size.y, size.z}), 0.85) << "seed " << seed;
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_GE(box.lower[axis], -0.5) << "seed " << seed;
            EXPECT_LE(box.upper[axis], 0.5) << "seed " << seed;
        }
    }
}

TEST_P(sample_kinds, same_shape_at_two_sizes) {
    const Volume& small = sample_128(GetParam());
    const Volume large = sample(GetParam(), 192);
    // The larger volume has finer detail, which changes clamped densities: 4 % of the total mass,
    // and a sixth of the L1 norm for mass that moves between cells.
    EXPECT_NEAR(mass(small) / mass(large), 1, 0.04);
    const std::vector<double> a = coarse_masses(small), b = coarse_masses(large);
    double difference = 0;
    for (std::size_t i = 0; i < a.size(); ++i) difference += std::abs(a[i] - b[i]);
    EXPECT_LT(difference, mass(large) / 6);
}

TEST_P(sample_kinds, bounds_lose_nothing) {
    const auto field = GetParam().field(1, 1.0f / 128);
    SampleOptions options;
    options.size = 128;
    const Volume whole = sample_field(Unbounded(*field), "unbounded", options);
    EXPECT_TRUE(same_bytes(sample_128(GetParam()), whole));
}

TEST_P(sample_kinds, density_does_not_depend_on_the_leaf) {
    // Leaves shifted by half a leaf: the same positions with other neighbours.
    constexpr float kVoxel = 1.0f / 128;
    const auto field = GetParam().field(1, kVoxel);
    const auto evaluated = [&](Vec3f first) {
        LeafPoints points;
        for (std::size_t n = 0; n < kLeafVoxels; ++n) {
            points.x[n] = first.x + kVoxel * static_cast<float>(n >> 6);
            points.y[n] = first.y + kVoxel * static_cast<float>((n >> 3) & 7);
            points.z[n] = first.z + kVoxel * static_cast<float>(n & 7);
        }
        std::vector<float> density(kLeafVoxels);
        field->evaluate(points, LeafValues(density.data(), kLeafVoxels));
        return density;
    };
    constexpr std::size_t kHalf = kLeafVoxels / 2;
    int boundary = 0;
    for (int x = -8; x < 8; ++x)  // every leaf of one slab
        for (int y = -8; y < 8; ++y) {
            const Vec3f first = 0.0625f * Vec3f{static_cast<float>(x), static_cast<float>(y), 0};
            const std::vector<float> here = evaluated(first);
            const std::vector<float> moved = evaluated(first + Vec3f{4 * kVoxel, 0, 0});
            ASSERT_TRUE(std::equal(here.begin() + kHalf, here.end(), moved.begin()))
                << "leaf " << x << ", " << y;
            const auto empty = std::count(here.begin(), here.end(), 0.0f);
            boundary += empty > 0 && empty < kLeafVoxels;
        }
    EXPECT_GT(boundary, 20);  // the slab did meet leaves that are partly filled
}

TEST_P(sample_kinds, size_out_of_range_throws) {
    for (const int size : {-1, 0, 63, 1025}) {
        try {
            (void)sample(GetParam(), size);
            FAIL() << "size " << size << " was accepted";
        } catch (const Error& error) {
            EXPECT_EQ(error.what(), std::string("sample ") + GetParam().name + ": size " +
                                        std::to_string(size) + ", expected 64 to 1024 voxels");
        }
    }
}

TEST_P(sample_kinds, progress_rises_to_one_from_one_thread_at_a_time) {
    std::vector<double> reports;
    std::atomic<int> inside = 0;
    bool overlapped = false;
    SampleOptions options;
    options.size = 128;  // more leaves than one batch
    options.progress = [&](double done) {
        overlapped = overlapped || inside.fetch_add(1) != 0;
        reports.push_back(done);
        inside.fetch_sub(1);
    };
    (void)GetParam().sample(options);
    EXPECT_FALSE(overlapped);
    ASSERT_GE(reports.size(), 2u);
    EXPECT_TRUE(std::is_sorted(reports.begin(), reports.end()));
    EXPECT_EQ(reports.back(), 1);

    options.progress = [](double) { throw std::runtime_error("enough"); };
    EXPECT_THROW((void)GetParam().sample(options), std::runtime_error);
}

INSTANTIATE_TEST_SUITE_P(, sample_kinds,
                         testing::Values(Kind{"cloud", sample_cloud, cloud_field, 0.11, 0.13,
                                              12765396673320306789u},
                                         Kind{"explosion", sample_explosion, explosion_field, 0.11,
                                              0.14, 13333696303112702448u}),
                         [](const auto& test) { return test.param.name; });

TEST(sample_explosion, hollow_towards_the_centre) {
    SampleOptions options;
    options.size = 64;
    const Volume volume = sample_explosion(options);
    // Mean density by distance from the centre of the fireball: thin gas, then the shell.
    const Vec3d center{0.03, 0.12, 0.03};
    double inner = 0, shell = 0;
    int inner_count = 0, shell_count = 0;
    const auto add = [&](Vec3i index, double value) {
        const double r = length(volume.world_from_index(vec_cast<double>(index)) - center);
        if (r < 0.15) inner += value, ++inner_count;
        if (r > 0.22 && r < 0.27) shell += value, ++shell_count;
    };
    for (const Leaf& leaf : volume.leaves)
        for (int n = 0; n < kLeafVoxels; ++n)
            add(leaf.origin + Vec3i{n >> 6, (n >> 3) & 7, n & 7},
                leaf.value[static_cast<std::size_t>(n)]);
    for (const Tile& tile : volume.tiles)
        for (int n = 0; n < kLeafVoxels; ++n)
            add(tile.origin + Vec3i{n >> 6, (n >> 3) & 7, n & 7}, tile.value);
    ASSERT_GT(inner_count, 0);
    ASSERT_GT(shell_count, 0);
    EXPECT_GT(inner / inner_count, 0);
    EXPECT_LT(inner / inner_count, 0.25 * shell / shell_count);
}

TEST(sample_levels, nest_two_to_one_and_share_the_world) {
    SampleOptions options;
    for (const int size : {64, 100, 160}) {
        options.size = size;
        const std::vector<Volume> levels = sample_levels(options);
        ASSERT_EQ(levels.size(), 3u);
        std::uint64_t above = 0;
        for (std::size_t n = 0; n < levels.size(); ++n) {
            validate(levels[n]);
            EXPECT_EQ(levels[n].name, "density_L" + std::to_string(n));
            const std::uint64_t voxels = active_voxels(levels[n]);
            EXPECT_GT(voxels, 0u);
            if (n > 0) {
                EXPECT_LT(voxels, 4 * above) << "half of a level is not refined";
            }
            above = voxels;
        }
        const std::uint64_t across = static_cast<std::uint64_t>(size) / 4;
        EXPECT_EQ(active_voxels(levels[0]), across * across * across);
        const Composite data = composite({levels, {}});
        EXPECT_EQ(data.partly_hidden, 0u);
        EXPECT_EQ(8 * data.hidden, active_voxels(levels[1]) + active_voxels(levels[2]))
            << "every fine cell has a coarse one under it";
    }
}

TEST(sample_levels, same_bytes_for_any_number_of_threads_and_another_with_another_seed) {
    SampleOptions options;
    options.size = 64;
    const std::vector<Volume> levels = sample_levels(options);
    {
        const ThreadLimit limit(1);
        const std::vector<Volume> alone = sample_levels(options);
        for (std::size_t n = 0; n < levels.size(); ++n)
            EXPECT_EQ(hash_of(levels[n]), hash_of(alone[n]));
    }
    options.seed = 2;
    EXPECT_NE(hash_of(levels[0]), hash_of(sample_levels(options)[0]));
    options.size = 63;
    EXPECT_THROW((void)sample_levels(options), Error);
}

/// Value of the voxel around a point; 0 where none is active.
float value_at(const Volume& volume, Vec3d point) {
    const Vec3d at = inverse(volume.world_from_index)(point);
    const Vec3i voxel{static_cast<int>(std::lround(at.x)), static_cast<int>(std::lround(at.y)),
                      static_cast<int>(std::lround(at.z))};
    for (const Leaf& leaf : volume.leaves)
        if (leaf.origin == aligned(voxel, 3))
            return leaf.value[static_cast<std::size_t>(
                leaf_offset(voxel.x & 7, voxel.y & 7, voxel.z & 7))];
    return 0;
}

TEST(sample_head, tissues_have_their_hounsfield_units_where_they_lie_at_every_size) {
    for (const int size : {64, 150}) {
        const Volume head = sample_head({.size = size});
        validate(head);
        EXPECT_EQ(head.name, "ct");
        EXPECT_NEAR(length(head.world_from_index.linear * Vec3d{0, 0, 1}), 240.0 / size, 1e-12);
        const auto near = [&](Vec3d point, double units, double by) {
            EXPECT_NEAR(value_at(head, point) - 1000.0, units, by)
                << size << ": " << point.x << " " << point.y << " " << point.z;
        };
        near({0, -60, 40}, 36, 25);    // brain, within the texture
        near({29, -42, 48}, 75, 25);   // lesion
        near({0, 84, -32}, -950, 25);  // air of the nose
        near({31, 84, -14}, 15, 25);   // eye
        EXPECT_GT(value_at(head, {0, 0, 107}), 1300) << "skull, in part of a voxel";
        EXPECT_EQ(value_at(head, {100, 100, 100}), 0) << "air";
    }
    const Volume one = sample_head({.size = 64}), other = sample_head({.size = 64, .seed = 2});
    EXPECT_NE(hash_of(one), hash_of(other));
    const ThreadLimit limit(1);
    EXPECT_EQ(hash_of(one), hash_of(sample_head({.size = 64})));
    EXPECT_THROW((void)sample_head({.size = 63}), Error);
}

TEST(sample_fire, has_the_explosion_and_its_temperature) {
    const std::vector<Volume> fire = sample_fire({.size = 64});
    ASSERT_EQ(fire.size(), 2u);
    EXPECT_TRUE(same_bytes(fire[0], sample_explosion({.size = 64})));
    EXPECT_EQ(fire[1].name, "temperature");
    EXPECT_EQ(active_voxels(fire[0]), active_voxels(fire[1]));
    float coldest = 1e9f, hottest = 0;
    for (std::size_t i = 0; i < fire[0].leaves.size(); ++i)
        for (int n = 0; n < kLeafVoxels; ++n) {
            const Leaf& leaf = fire[1].leaves[i];
            ASSERT_EQ(leaf.active(n), fire[0].leaves[i].active(n));
            if (!leaf.active(n)) continue;
            coldest = std::min(coldest, leaf.value[static_cast<std::size_t>(n)]);
            hottest = std::max(hottest, leaf.value[static_cast<std::size_t>(n)]);
        }
    EXPECT_EQ(coldest, 400);
    EXPECT_GT(hottest, 1800);
    EXPECT_LE(hottest, 1900);
    // Tiles continue their neighbours: the core is as hot as its thin gas allows.
    for (const Tile& tile : fire[1].tiles) EXPECT_NEAR(tile.value, 1867, 1);
    const ThreadLimit limit(1);
    EXPECT_TRUE(same_bytes(fire[1], sample_fire({.size = 64})[1]));
}

}  // namespace
}  // namespace vog
