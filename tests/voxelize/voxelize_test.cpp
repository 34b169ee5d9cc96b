// voxelize_test.cpp: averages of truncated kernels over voxels, against closed forms and dense sums.
#include "vog/voxelize.h"

#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <numbers>
#include <tuple>

#include "support/random_volume.h"
#include "support/refusal.h"
#include "support/scenes.h"
#include "vog/error.h"
#include "vog/memory.h"
#include "vog/periodic.h"
#include "vog/progress.h"

namespace vog::test {

namespace {

/// Truth and result differ by rounding to float, by the quadrature along two axes (below 1e-3 of the largest voxel), and
/// by the sums over 48^3 points that are the truth here: those miss the surface by up to a 48th of a voxel.
constexpr double kVoxelTolerance = 3e-3;
/// Voxels sum up in float, each rounded by 2^-24; pieces of the quadrature are within 1e-5, of either sign.
constexpr double kMassTolerance = 3e-6;

Gaussians one_gaussian(Vec3f mean, Vec3f scale, Quat rotation = {}, float cutoff = 2.25f) {
    Gaussians model;
    model.cutoff = cutoff;
    model.mean = {mean};
    model.scale = {scale};
    model.density = {1.5f};
    if (!(rotation == Quat{})) model.rotation = {rotation};
    return model;
}

/// Random model of Gaussians from thin to wide, in voxels of `edge`.
Gaussians random_model(std::uint64_t seed, std::size_t count, double edge) {
    Random random(seed);
    Gaussians model;
    for (std::size_t n = 0; n < count; ++n) {
        const auto scale = [&] { return static_cast<float>(edge * std::exp(random(-3, 1.5))); };
        const auto one = [&] { return static_cast<float>(random(-1, 1)); };
        const auto place = [&] { return static_cast<float>(edge * random(-12, 12)); };
        model.mean.push_back({place(), place(), place()});
        model.scale.push_back({scale(), scale(), scale()});
        model.rotation.push_back({one() + 2, one(), one(), one()});
        model.density.push_back(static_cast<float>(random(0.1, 2)));
    }
    return model;
}

using Voxels = std::map<std::tuple<int, int, int>, double>;

Voxels voxels_of(const Volume& volume) {
    Voxels voxels;
    for (const Leaf& leaf : volume.leaves)
        for (int n = 0; n < kLeafVoxels; ++n)
            if (leaf.active(n))
                voxels[{leaf.origin.x + (n >> 6), leaf.origin.y + (n >> 3 & 7),
                        leaf.origin.z + (n & 7)}] = leaf.value[static_cast<std::size_t>(n)];
    return voxels;
}

/// Mean over a voxel of density times f(x), by n^3 points.
template <class F>
double mean_over_voxel(const Gaussians& model, const Affine& map, std::tuple<int, int, int> voxel,
                       int n, const F& f) {
    double sum = 0;
    std::vector<Mat3> whiten;
    for (std::size_t i = 0; i < model.size(); ++i) whiten.push_back(whitening(model, i));
    const auto at = [n](int from, int k) { return from - 0.5 + (k + 0.5) / n; };
    for (int a = 0; a < n; ++a)
        for (int b = 0; b < n; ++b)
            for (int c = 0; c < n; ++c) {
                const Vec3d x = map(Vec3d{at(std::get<0>(voxel), a), at(std::get<1>(voxel), b),
                                          at(std::get<2>(voxel), c)});
                for (std::size_t i = 0; i < model.size(); ++i) {
                    const Vec3d u = whiten[i] * (x - world_mean(model, i));
                    if (dot(u, u) <= double{model.cutoff} * model.cutoff)
                        sum += model.density[i] * std::exp(-0.5 * dot(u, u)) * f(i, x);
                }
            }
    return sum / n / n / n;
}

void expect_mass(const Voxelized& made, const Gaussians& model) {
    EXPECT_NEAR(mass(made.volume) / mass(model), 1, kMassTolerance);
    EXPECT_NEAR(made.voxel_mass / made.mass, 1, kMassTolerance);
    EXPECT_NEAR(made.mass / mass(model), 1, 1e-12);
    EXPECT_NO_THROW(validate(made.volume));
}

/// Expects every `step`-th voxel to be the mean of density, and the mass to be whole.
void expect_means(const Gaussians& model, const Affine& map, std::size_t step = 1) {
    const Voxelized made = voxelize(model, map);
    expect_mass(made, model);
    const Voxels voxels = voxels_of(made.volume);
    double largest = 0;
    for (const auto& [voxel, value] : voxels) largest = std::max(largest, value);
    std::size_t n = 0;
    for (const auto& [voxel, value] : voxels) {
        if (n++ % step) continue;
        EXPECT_NEAR(value, mean_over_voxel(model, map, voxel, 48, [](auto, auto) { return 1.0; }),
                    kVoxelTolerance * largest)
            << std::get<0>(voxel) << " " << std::get<1>(voxel) << " " << std::get<2>(voxel);
    }
}

/// Same voxels and values, bit for bit.
void expect_same(const Volume& a, const Volume& b) {
    ASSERT_EQ(a.leaves.size(), b.leaves.size());
    for (std::size_t n = 0; n < a.leaves.size(); ++n) {
        EXPECT_EQ(a.leaves[n].origin, b.leaves[n].origin);
        EXPECT_EQ(a.leaves[n].mask, b.leaves[n].mask);
        EXPECT_EQ(a.leaves[n].value, b.leaves[n].value);
    }
}

}  // namespace

TEST(voxelize, gaussian_inside_one_voxel_is_its_mass) {
    const Gaussians model =
        one_gaussian({2.1f, -3.05f, 7}, {0.1f, 0.05f, 0.15f}, {0.9f, 0.1f, -0.3f, 0.2f});
    const Voxels voxels = voxels_of(voxelize(model, {}).volume);
    ASSERT_EQ(voxels.size(), 1u);
    EXPECT_NEAR(voxels.at({2, -3, 7}) / mass(model), 1, 1e-6);  // voxel volume 1
}

TEST(voxelize, gaussian_on_a_corner_has_eight_equal_voxels) {
    const Gaussians model = one_gaussian({0.5f, 0.5f, 0.5f}, {0.2f, 0.2f, 0.2f});
    const Voxels voxels = voxels_of(voxelize(model, {}).volume);
    ASSERT_EQ(voxels.size(), 8u);
    for (const auto& [voxel, value] : voxels) EXPECT_NEAR(value / (mass(model) / 8), 1, 1e-5);
}

TEST(voxelize, gaussian_on_a_face_has_two_equal_voxels) {
    const Gaussians model = one_gaussian({4, 0.5f, -2}, {0.1f, 0.1f, 0.1f});
    const Voxels voxels = voxels_of(voxelize(model, {}).volume);
    ASSERT_EQ(voxels.size(), 2u);
    EXPECT_NEAR(voxels.at({4, 0, -2}) / (mass(model) / 2), 1, 1e-6);
    EXPECT_NEAR(voxels.at({4, 1, -2}) / (mass(model) / 2), 1, 1e-6);
}

// Slab of voxels across x of a Gaussian whose support lies within one voxel along y and z: the mass between two planes
// of the truncated ball, 2 pi (e^(-u^2/2) - e^(-k^2/2)) du integrated from a to b.
TEST(voxelize, slices_of_one_gaussian_are_the_closed_form) {
    for (const float cutoff : {1.0f, 2.25f, 4.0f, 8.0f}) {
        const double s = 2.3, k = cutoff;
        const Gaussians model = one_gaussian({0.3f, 0, 0}, {2.3f, 0.05f, 0.02f}, {}, cutoff);
        const Voxels voxels = voxels_of(voxelize(model, {}).volume);
        const auto below = [&](double x) {
            const double u = std::clamp((x - double{0.3f}) / double{2.3f}, -k, k);
            return 2 * std::numbers::pi *
                   (std::sqrt(std::numbers::pi / 2) * std::erf(u / std::numbers::sqrt2) -
                    u * std::exp(-0.5 * k * k));
        };
        const double factor = 1.5 * s * double{0.05f} * double{0.02f};
        // Pieces are within 1e-5 of their integral; far in the tails relative to the middle's.
        const double largest = factor * (below(0.8) - below(-0.2));
        std::size_t found = 0;
        for (int x = -25; x <= 25; ++x) {
            const double expected = factor * (below(x + 0.5) - below(x - 0.5));
            if (!(expected > 0)) continue;
            const auto voxel = voxels.find({x, 0, 0});
            ASSERT_NE(voxel, voxels.end()) << cutoff << " " << x;
            EXPECT_NEAR(voxel->second, expected, 1e-5 * largest) << cutoff << " " << x;
            ++found;
        }
        EXPECT_EQ(found, voxels.size());
    }
}

TEST(voxelize, voxels_are_means_of_density) {
    const Quat turn{0.8f, 0.3f, -0.4f, 0.3f};
    expect_means(one_gaussian({0.2f, 0.1f, -0.3f}, {0.8f, 0.8f, 0.8f}), {});
    expect_means(one_gaussian({0.2f, 0.1f, -0.3f}, {1.6f, 0.7f, 0.9f}, turn), {}, 3);
    expect_means(one_gaussian({0.2f, 0.1f, -0.3f}, {2, 0.15f, 0.2f}, turn), {}, 3);       // needle
    expect_means(one_gaussian({0.2f, 0.1f, -0.3f}, {1.5f, 1.5f, 0.1f}, turn), {}, 3);     // plate
    expect_means(one_gaussian({0.2f, 0.1f, -0.3f}, {0.7f, 0.4f, 0.5f}, turn, 4), {}, 3);  // cutoff
    expect_means(one_gaussian({1, 2, 3}, {6, 5, 7}, turn), {}, 400);                      // wide
}

TEST(voxelize, lattices_may_be_any_affine_map) {
    for (const auto& [name, map] : grid_maps()) {
        SCOPED_TRACE(name);
        const double edge = std::cbrt(std::abs(determinant(map.linear)));
        Gaussians model =
            one_gaussian(vec_cast<float>(map(Vec3d{1.2, -3.4, 5.1})),
                         {static_cast<float>(1.2 * edge), static_cast<float>(0.6 * edge),
                          static_cast<float>(0.9 * edge)},
                         {0.7f, 0.1f, 0.5f, -0.4f});
        expect_means(model, map, 5);
    }
}

TEST(voxelize, mass_is_conserved_for_thin_and_wide_gaussians) {
    const Gaussians many = random_model(3, 40, 1);
    for (const double size : {0.5, 1.0, 30.0})
        expect_mass(voxelize(many, voxel_lattice(many, size)), many);
    // Aspects of 1e4, in every direction.
    Random random(8);
    for (int n = 0; n < 20; ++n) {
        const auto one = [&] { return static_cast<float>(random(-1, 1)); };
        const Gaussians model =
            one_gaussian({one(), one(), one()}, {8, n % 2 ? 8.0f : 1e-3f, 1e-3f},
                         {one(), one(), one(), one() + 0.1f});
        expect_mass(voxelize(model, {}), model);
    }
}

TEST(voxelize, gaussians_wider_than_blocks_keep_their_mass) {
    const Gaussians model = one_gaussian({5, 6, 7}, {22, 30, 18}, {0.9f, 0.2f, 0.3f, 0.1f});
    const Voxelized made = voxelize(model, {});
    expect_mass(made, model);
    EXPECT_GT(active_voxels(made.volume), 400'000u);
}

TEST(voxelize, mass_holds_far_from_the_origin) {
    Gaussians model = random_model(5, 30, 1);
    model.origin = {1e9, -2e9, 3e8};
    const Voxelized made = voxelize(model, voxel_lattice(model, 0.7));
    expect_mass(made, model);
    EXPECT_EQ(made.volume.world_from_index.translation, model.origin);
}

TEST(voxelize, fields_are_means_weighted_by_density) {
    Gaussians model =
        one_gaussian({0.2f, 0.1f, -0.3f}, {1.1f, 0.6f, 0.8f}, {0.8f, 0.3f, -0.4f, 0.3f});
    append(model, one_gaussian({1.4f, 0.4f, 0.2f}, {0.4f, 0.9f, 0.5f}, {0.8f, -0.3f, 0.1f, 0.3f}));
    ScalarField temperature;
    temperature.name = "temperature", temperature.unit = "K";
    temperature.value = {300, 20}, temperature.gradient = {{40, -20, 10}, {-3, 8, 100}};
    temperature.deviation = {1, 2}, temperature.skewness = {0, 0};
    ScalarField own;
    own.name = "density";
    own.is_measure = true;
    own.value = {1, 1}, own.gradient.resize(2), own.deviation = {0, 0}, own.skewness = {0, 0};
    VectorField velocity;
    velocity.name = "velocity", velocity.unit = "m/s";
    velocity.value = {{1, 2, 3}, {-4, 5, -6}};
    velocity.gradient[0] = {{1, 0, 0}, {0, 2, 0}}, velocity.gradient[1] = {{0, 0, 3}, {1, 1, 1}};
    velocity.gradient[2] = {{0, 1, 0}, {2, 0, 0}};
    velocity.covariance.resize(2);
    model.fields.scalar = {own, temperature};
    model.fields.vector = {velocity};
    const Affine map = grid_maps()[5].second;  // sheared
    VoxelizeOptions options;
    options.fields = true;
    options.name = "mass density";
    const Voxelized made = voxelize(model, map, options);
    EXPECT_EQ(made.volume.name, "mass density");
    ASSERT_EQ(made.fields.size(), 2u);  // the measure itself is the volume
    EXPECT_EQ(made.fields[0].name, "temperature");
    EXPECT_EQ(made.fields[0].unit, "K");
    EXPECT_EQ(made.fields[1].name, "velocity");
    ASSERT_TRUE(made.fields[1].is_vector());
    double largest = 0;
    for (const Leaf& leaf : made.volume.leaves)
        for (const float value : leaf.value) largest = std::max(largest, double{value});
    std::size_t compared = 0;
    double least = 1e9, most = -1e9;
    for (std::size_t leaf = 0; leaf < made.volume.leaves.size(); ++leaf)
        for (int n = 0; n < kLeafVoxels; ++n) {
            if (!made.volume.leaves[leaf].active(n)) {
                EXPECT_EQ(made.fields[0].component[0].leaf[leaf][static_cast<std::size_t>(n)], 0);
                continue;
            }
            const auto value = [&](const VoxelField& field, std::size_t c) {
                return double{field.component[c].leaf[leaf][static_cast<std::size_t>(n)]};
            };
            least = std::min(least, value(made.fields[0], 0)),
            most = std::max(most, value(made.fields[0], 0));
            const Vec3i o = made.volume.leaves[leaf].origin;
            const std::tuple voxel{o.x + (n >> 6), o.y + (n >> 3 & 7), o.z + (n & 7)};
            const double density = made.volume.leaves[leaf].value[static_cast<std::size_t>(n)];
            if (density < 0.02 * largest || compared++ % 7)
                continue;  // points resolve fuller voxels
            const auto plane = [&](const auto& values, const auto& gradients) {
                return mean_over_voxel(model, map, voxel, 32,
                                       [&](std::size_t i, Vec3d x) {
                                           return values(i) + dot(vec_cast<double>(gradients[i]),
                                                                  x - world_mean(model, i));
                                       }) /
                       density;
            };
            EXPECT_NEAR(
                value(made.fields[0], 0),
                plane([&](std::size_t i) { return temperature.value[i]; }, temperature.gradient),
                1.5);
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(value(made.fields[1], static_cast<std::size_t>(c)),
                            plane([&](std::size_t i) { return velocity.value[i][c]; },
                                  velocity.gradient[static_cast<std::size_t>(c)]),
                            0.06);
        }
    EXPECT_GT(compared, 20u);
    EXPECT_EQ(made.fields[0].lower, least);
    EXPECT_EQ(made.fields[0].upper, most);
}

TEST(voxelize, bytes_are_the_same_for_any_threads_and_memory) {
    const Gaussians model = random_model(11, 300, 1);
    const Affine map = grid_maps()[3].second;
    Volume one;
    {
        const ThreadLimit limit(1);
        one = voxelize(model, map).volume;
    }
    for (const int threads : {2, 5}) {
        const ThreadLimit limit(threads);
        expect_same(voxelize(model, map).volume, one);
    }
    const MemoryLimit memory(64 << 20);
    expect_same(voxelize(model, map).volume, one);
}

TEST(voxelize, extent_leaves_the_rest_out_and_nothing_else) {
    const Gaussians model = random_model(4, 60, 1);
    const Voxels all = voxels_of(voxelize(model, {}).volume);
    VoxelizeOptions options;
    options.extent = IndexBox{{-5, -3, -20}, {4, 9, 6}};
    const Voxelized part = voxelize(model, {}, options);
    EXPECT_LT(part.voxel_mass, part.mass);
    EXPECT_NEAR(part.voxel_mass, mass(part.volume), 1e-9 * part.mass);
    const Voxels inside = voxels_of(part.volume);
    std::size_t expected = 0;
    for (const auto& [voxel, value] : all) {
        const auto [x, y, z] = voxel;
        if (x < -5 || x > 4 || y < -3 || y > 9 || z < -20 || z > 6) continue;
        ++expected;
        ASSERT_TRUE(inside.contains(voxel));
        EXPECT_NEAR(inside.at(voxel) / value, 1, 1e-6);
    }
    EXPECT_EQ(inside.size(), expected);
    options.extent = IndexBox{{1000, 0, 0}, {1001, 1, 1}};
    EXPECT_NE(refusal([&] { (void)voxelize(model, {}, options); }).find("no mass in the extent"),
              std::string::npos);
}

TEST(voxelize, periodic_models_have_the_voxels_of_their_box) {
    Gaussians model = one_gaussian({0.2f, 3, 3}, {0.3f, 0.3f, 0.3f});
    const double whole = mass(model);
    add_periodic_images(model, {{0, 0, 0}, {6, 6, 6}});
    ASSERT_GT(mass(model), 1.5 * whole);
    const Voxelized made = voxelize(model, voxel_lattice(model, 0.5), {});
    EXPECT_NEAR(made.voxel_mass, whole, 1e-4 * whole);
    EXPECT_EQ(made.mass, whole);
    const IndexBox box = vog::active_box(made.volume);
    EXPECT_EQ(box.lower.x, 0);
    EXPECT_EQ(box.upper.x, 11) << "the image behind the opposite face";
}

TEST(voxelize, gaussians_without_density_are_no_voxels) {
    Gaussians model = one_gaussian({0, 0, 0}, {0.1f, 0.1f, 0.1f});
    append(model, one_gaussian({20, 0, 0}, {1, 1, 1}));
    model.density[1] = 0;
    EXPECT_EQ(active_voxels(voxelize(model, {}).volume), 1u);
    model.density[0] = 0;
    EXPECT_NE(refusal([&] { (void)voxelize(model, {}); }).find("no mass"), std::string::npos);
    EXPECT_NE(refusal([] { (void)voxelize(Gaussians{}, {}); }).find("no mass"), std::string::npos);
}

TEST(voxelize, refuses_what_is_out_of_range) {
    const Gaussians model = one_gaussian({0, 0, 0}, {1, 1, 1});
    for (const double size : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()})
        EXPECT_NE(refusal([&] { (void)voxel_lattice(model, size); }).find("voxel size"),
                  std::string::npos)
            << size;
    Affine flat;
    flat.linear.row[2] = flat.linear.row[1];
    EXPECT_NE(refusal([&] { (void)voxelize(model, flat); }).find("singular"), std::string::npos);
    flat.linear.row[2] = {0, 0, std::nan("")};
    EXPECT_NE(refusal([&] { (void)voxelize(model, flat); }).find("singular"), std::string::npos);
    EXPECT_NE(refusal([&] {
                  (void)voxelize(model, voxel_lattice(model, 1e-12));
              }).find("larger voxel size"),
              std::string::npos);
    EXPECT_NE(
        refusal([&] { (void)voxelize(model, voxel_lattice(model, 1e-5)); }).find("larger voxels"),
        std::string::npos);
    VoxelizeOptions options;
    options.most_bytes = 100'000;
    EXPECT_NE(refusal([&] {
                  (void)voxelize(model, voxel_lattice(model, 0.1), options);
              }).find("at most 0.0001 GB"),
              std::string::npos);
    options = {};
    options.fields = true;
    EXPECT_NE(refusal([&] { (void)voxelize(model, {}, options); }).find("no field"),
              std::string::npos);
    Gaussians dense = one_gaussian({0, 0, 0}, {1, 1, 1});
    dense.density[0] = 3e38f;
    append(dense, dense);
    EXPECT_NE(refusal([&] { (void)voxelize(dense, {}); }).find("in a voxel, expected at most"),
              std::string::npos);
}

TEST(voxelize, progress_runs_to_its_end) {
    double last = 0;
    VoxelizeOptions options;
    options.progress = [&](double done) {
        EXPECT_GE(done, last);
        last = done;
    };
    (void)voxelize(random_model(2, 50, 1), {}, options);
    EXPECT_DOUBLE_EQ(last, 1);
}

TEST(voxel_error, is_0_for_equal_volumes_and_counts_what_one_lacks) {
    Volume a = random_volume(3);
    std::erase_if(a.tiles, [](const Tile& tile) { return tile.edge > 8; });
    Volume b = a;
    b.tiles.clear();
    const Tile tile = a.tiles.front();  // as a leaf of constant density
    Leaf leaf;
    leaf.origin = tile.origin;
    for (int n = 0; n < kLeafVoxels; ++n) leaf.set(n, tile.value);
    b.leaves.push_back(leaf);
    sort_nodes(b);
    VoxelError error = voxel_error(a, b);
    EXPECT_EQ(error.relative_l2, 0);
    EXPECT_EQ(error.worst, 0);
    EXPECT_EQ(error.mean, 0);
    EXPECT_TRUE(std::isinf(error.psnr_db));

    double squares = 0, largest = 0, sum = 0;
    for (const Leaf& one : b.leaves)
        for (const float value : one.value) {
            squares += double{value} * value;
            largest = std::max(largest, double{value});
            sum += value;
        }
    Volume none = b;
    none.leaves.resize(1);
    none.leaves[0].origin = {800, 0, 0};  // all elsewhere
    none.leaves[0].value.fill(0);
    none.leaves[0].value[7] = 3;
    error = voxel_error(a, none);
    const double voxels = static_cast<double>(active_voxels(a));
    EXPECT_NEAR(error.relative_l2, std::sqrt((squares + 9) / squares), 1e-12);
    EXPECT_NEAR(error.psnr_db, 10 * std::log10(largest * largest * voxels / (squares + 9)), 1e-9);
    EXPECT_NEAR(error.mean, (sum + 3) / voxels / largest, 1e-9);
    EXPECT_NEAR(error.worst, 3 / largest, 1e-9);
}

TEST(voxel_error, tiles_count_where_leaves_cover_a_part) {
    Volume a;
    a.tiles = {{{0, 0, 0}, 128, 0.5f}};
    Volume b;
    Leaf leaf;
    leaf.origin = {8, 16, 120};
    for (int n = 0; n < kLeafVoxels; ++n) leaf.set(n, 0.75f);
    b.leaves = {leaf};
    const VoxelError error = voxel_error(a, b);
    const double all = 128.0 * 128 * 128;
    EXPECT_NEAR(error.relative_l2, std::sqrt(((all - 512) * 0.25 + 512 * 0.0625) / (all * 0.25)),
                1e-12);
    EXPECT_NEAR(error.worst, 1, 1e-12);
}

TEST(voxel_error, tiles_of_both_are_compared_where_they_are_the_same) {
    const Volume a = random_volume(3);
    Volume b = a;
    EXPECT_EQ(voxel_error(a, b).relative_l2, 0);
    const auto tile = std::ranges::find(b.tiles, 128, &Tile::edge);
    tile->value += 0.5f;
    const VoxelError error = voxel_error(a, b);
    const auto voxels = static_cast<double>(active_voxels(a));
    EXPECT_NEAR(error.mean * voxels, error.worst * 128 * 128 * 128, 1e-3);
    EXPECT_GT(error.worst, 0);
    tile->origin.x += 128;
    EXPECT_NE(refusal([&] { (void)voxel_error(a, b); }).find("a tile of 128^3 voxels"),
              std::string::npos);
}

TEST(voxel_error, refuses_other_lattices_and_nothing) {
    Volume a = random_volume(3), b = a;
    a.tiles.clear(), b.tiles.clear();
    b.world_from_index.translation.x += 0.1;
    EXPECT_NE(refusal([&] { (void)voxel_error(a, b); }).find("different lattices"),
              std::string::npos);
    Volume empty;
    EXPECT_NE(refusal([&] { (void)voxel_error(empty, empty); }).find("are 0"), std::string::npos);
}

/// Two lattices, the finer one of half the edge and shifted; every other voxel of either is active, and a tile.
TEST(voxel_error, of_parts_counts_their_active_voxels_by_volume) {
    const Gaussians model = random_model(5, 30, 0.5);
    std::vector<Volume> parts(2);
    double squares = 0, wanted = 0, absolute = 0, volume = 0, largest = 0, worst = 0;
    for (std::size_t k = 0; k < parts.size(); ++k) {
        const double edge = k == 0 ? 1 : 0.5;
        Volume& part = parts[k];
        part.world_from_index = voxel_lattice(model, edge);
        part.world_from_index.translation.x += 0.2 * edge;
        const Volume all = voxelize(model, part.world_from_index).volume;
        ASSERT_GT(all.leaves.size(), 3u);
        for (std::size_t n = 1; n < all.leaves.size(); ++n) {
            if (n == 2) continue;  // of the model alone
            Leaf leaf;
            leaf.origin = all.leaves[n].origin;
            for (int m = 0; m < kLeafVoxels; m += 2)
                leaf.set(m, 0.5f * all.leaves[n].value[static_cast<std::size_t>(m)] + 0.01f);
            part.leaves.push_back(leaf);
        }
        part.tiles = {{all.leaves.front().origin, 8, 0.25f}};
        const Voxels truth = voxels_of(all);
        const auto add = [&](Vec3i at, double value) {
            const auto found = truth.find({at.x, at.y, at.z});
            const double difference = (found == truth.end() ? 0 : found->second) - value;
            const double voxel = edge * edge * edge;
            squares += voxel * difference * difference, wanted += voxel * value * value;
            absolute += voxel * std::abs(difference), volume += voxel;
            worst = std::max(worst, std::abs(difference)), largest = std::max(largest, value);
        };
        for (const auto& [at, value] : voxels_of(part))
            add({std::get<0>(at), std::get<1>(at), std::get<2>(at)}, value);
        for (int n = 0; n < kLeafVoxels; ++n)
            add(part.tiles[0].origin + Vec3i{n & 7, n >> 3 & 7, n >> 6}, 0.25);
    }
    const VoxelError error = voxel_error(parts, model);
    // Sums of doubles in another order; the extent changes no voxel.
    EXPECT_NEAR(error.relative_l2 / std::sqrt(squares / wanted), 1, 1e-9);
    EXPECT_NEAR(error.psnr_db, 10 * std::log10(largest * largest * volume / squares), 1e-8);
    EXPECT_NEAR(error.mean / (absolute / volume / largest), 1, 1e-9);
    EXPECT_NEAR(error.worst / (worst / largest), 1, 1e-9);

    parts[1].world_from_index.translation.x += 1000;
    EXPECT_NE(refusal([&] { (void)voxel_error(parts, model); }), "no error");
    EXPECT_NE(refusal([&] { (void)voxel_error(std::span<const Volume>{}, model); }).find("are 0"),
              std::string::npos);
}

}  // namespace vog::test
