// add_fields_test.cpp: fields against sums over voxels, in double precision.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "support/made_fields.h"
#include "support/moment_volumes.h"
#include "vog/convert_fields.h"
#include "vog/convert_moments.h"
#include "vog/progress.h"

namespace vog {
namespace {

using test::field_of, test::set_range, test::values_of;

double wavy(Vec3d p) { return 300 + 2 * std::sin(0.7 * p.x) + 0.3 * p.y - p.z * p.z / 40; }

/// Field whose planes are far from the ends of its range: nothing limits them (field_limits_test.cpp).
VoxelField unlimited(VoxelField field) {
    const double room = field.upper - field.lower;
    field.lower -= room, field.upper += room;
    return field;
}

/// Leaves alone, so that every cell has voxels of its own.
Volume leaves_of(std::uint64_t seed, double share) {
    Volume volume = test::random_volume(seed, share);
    volume.tiles.clear();
    return volume;
}

Gaussians hard_model(const Volume& volume, int block) {
    MomentOptions options;
    options.block_voxels = block, options.soft_steps = 0, options.mass_threshold = 0;
    return convert_moments(volume, options);
}

void add(Gaussians& model, const Volume& volume, const VoxelField& field,
         const FieldOptions& options = {}) {
    const std::vector<std::vector<VoxelField>> fields{{field}};
    add_fields(model, std::span(&volume, 1), fields, options);
}

/// Voxels of one cell of a hard cut.
struct Cell {
    struct Voxel {
        double mass, value;
        Vec3d at;
    };
    std::vector<Voxel> voxels;
};

/// Index-space cell of a voxel or of a Gaussian's mean.
std::tuple<int, int, int> cell_at(Vec3d index, int block) {
    const auto along = [&](double at) { return static_cast<int>(std::floor((at + 0.5) / block)); };
    return {along(index.x), along(index.y), along(index.z)};
}

std::map<std::tuple<int, int, int>, Cell> cells_of(const Volume& volume, const VoxelField& field,
                                                   int block) {
    std::map<std::tuple<int, int, int>, Cell> cells;
    for (std::size_t l = 0; l < volume.leaves.size(); ++l)
        for (int n = 0; n < kLeafVoxels; ++n) {
            const Leaf& leaf = volume.leaves[l];
            const auto at = static_cast<std::size_t>(n);
            if (leaf.value[at] <= 0) continue;
            const Vec3d index = vec_cast<double>(leaf.origin + Vec3i{n >> 6, n >> 3 & 7, n & 7});
            cells[cell_at(index, block)].voxels.push_back({double{leaf.value[at]},
                                                           double{field.component[0].leaf[l][at]},
                                                           volume.world_from_index(index)});
        }
    return cells;
}

TEST(add_fields, hard_cells_have_the_plane_of_least_squares_of_their_voxels) {
    for (const int block : {1, 2, 4, 8, 16}) {
        const Volume volume = leaves_of(31, 0.4);
        const VoxelField field = unlimited(field_of("temperature", volume, wavy));
        Gaussians model = hard_model(volume, block);
        add(model, volume, field, {UniformCells{block}});
        ASSERT_EQ(model.fields.scalar.size(), 1u);
        const ScalarField& made = model.fields.scalar[0];
        EXPECT_EQ(made.name, "temperature");
        EXPECT_EQ(made.unit, "K");
        const auto cells = cells_of(volume, field, block);
        ASSERT_EQ(cells.size(), model.size());
        const Affine back = inverse(volume.world_from_index);
        const Mat3& map = volume.world_from_index.linear;
        double worst = 0;
        for (std::size_t i = 0; i < model.size(); ++i) {
            const Vec3d mean = world_mean(model, i);
            const auto place = cells.find(cell_at(back(mean), block));
            ASSERT_NE(place, cells.end());
            double mass = 0, value = 0, left = 0, cubes = 0;
            for (const Cell::Voxel& v : place->second.voxels)
                mass += v.mass, value += v.mass * v.value;
            const Vec3d g = vec_cast<double>(made.gradient[i]);
            for (const Cell::Voxel& v : place->second.voxels) {
                const double z = v.value - double{made.value[i]} - dot(g, v.at - mean);
                left += v.mass / mass * z * z, cubes += v.mass / mass * z * z * z;
            }
            // The plane's mean is that of the voxels, whose mean position is the Gaussian's.
            EXPECT_NEAR(double{made.value[i]}, value / mass, 2e-4) << block;
            EXPECT_NEAR(double{made.deviation[i]}, std::sqrt(left), 3e-4) << block;
            const double skewness = std::clamp(cubes / std::pow(left, 1.5), -3.0, 3.0);
            EXPECT_NEAR(double{made.skewness[i]}, left > 1e-4 ? skewness : double{made.skewness[i]},
                        2e-2);
            // Normal equations: C g = c, with the boxes' own variance in C.
            Vec3d error;
            for (const Cell::Voxel& v : place->second.voxels) {
                const Vec3d d = v.at - mean;
                error = error + (v.mass / mass) * ((v.value - value / mass - dot(g, d)) * d);
            }
            const Vec3d box = (1.0 / 12) * (map * (transpose(map) * g));
            worst = std::max(worst, length(error - box));
        }
        EXPECT_LT(worst, 1e-3) << block;
    }
}

/// Sums of windows, by hand: a half cell belongs to its own cell and along each axis to the one it borders, with the
/// weights 7/8 and 1/8, divided by their sum over the cells that have a voxel.
TEST(add_fields, windows_have_the_plane_of_least_squares_of_their_voxels) {
    for (const int block : {2, 4, 8}) {
        const Volume volume = leaves_of(41, 0.4);
        const VoxelField field = unlimited(field_of("temperature", volume, wavy));
        const auto occupied = cells_of(volume, field, block);
        // Cells with half an edge of empty space between share no voxels.
        const auto are_apart = [&](const Cell& a, const Cell& b) {
            std::array<Box, 2> bounds;
            for (const Cell::Voxel& voxel : a.voxels)
                bounds[0].include(inverse(volume.world_from_index)(voxel.at));
            for (const Cell::Voxel& voxel : b.voxels)
                bounds[1].include(inverse(volume.world_from_index)(voxel.at));
            for (int axis = 0; axis < 3; ++axis)
                for (const auto& [low, high] : {std::pair{0u, 1u}, std::pair{1u, 0u}})
                    if (bounds[high].lower[axis] - bounds[low].upper[axis] - 1 > 0.5 * block - 0.01)
                        return true;
            return false;
        };
        struct Sample {
            double weight, value;
            Vec3d at;
        };
        std::map<std::tuple<int, int, int>, std::vector<Sample>> windows;
        for (const auto& [own, cell] : occupied)
            for (const Cell::Voxel& voxel : cell.voxels) {
                const Vec3d index = inverse(volume.world_from_index)(voxel.at);
                std::vector<std::pair<std::tuple<int, int, int>, double>> shares;
                double all = 0;
                for (int k = 0; k < 8; ++k) {
                    std::array<int, 3> at{std::get<0>(own), std::get<1>(own), std::get<2>(own)};
                    double weight = 1;
                    for (int axis = 0; axis < 3; ++axis) {
                        const auto a = static_cast<std::size_t>(axis);
                        const double center = (at[a] + 0.5) * block - 0.5;
                        const bool next = k >> axis & 1;
                        weight *= next ? 0.125 : 0.875;
                        if (next) at[a] += index[axis] > center ? 1 : -1;
                    }
                    const std::tuple place{at[0], at[1], at[2]};
                    const auto other = occupied.find(place);
                    if (other == occupied.end() || are_apart(cell, other->second)) continue;
                    shares.emplace_back(place, weight), all += weight;
                }
                for (const auto& [place, weight] : shares)
                    windows[place].push_back({voxel.mass * weight / all, voxel.value, voxel.at});
            }
        // Hard cells are as many, in the same order; their fields depend on the windows alone.
        Gaussians model = hard_model(volume, block);
        ASSERT_EQ(model.size(), windows.size());
        add(model, volume, field, {UniformCells{block, true}});
        const ScalarField& made = model.fields.scalar[0];
        for (std::size_t i = 0; i < model.size(); ++i) {
            const auto& samples =
                windows[cell_at(inverse(volume.world_from_index)(world_mean(model, i)), block)];
            double m = 0, value = 0, left = 0;
            Vec3d mean;
            for (const Sample& s : samples)
                m += s.weight, value += s.weight * s.value, mean = mean + s.weight * s.at;
            mean = (1 / m) * mean;
            const Vec3d g = vec_cast<double>(made.gradient[i]);
            Vec3d with;
            for (const Sample& s : samples) {
                const double z = s.value - value / m - dot(g, s.at - mean);
                left += s.weight / m * z * z;
                with = with + (s.weight / m * z) * (s.at - mean);
            }
            const Mat3& map = volume.world_from_index.linear;
            const Vec3d box = (1.0 / 12) * (map * (transpose(map) * g));
            EXPECT_NEAR(double{made.value[i]}, value / m, 2e-4);
            EXPECT_NEAR(double{made.deviation[i]}, std::sqrt(left), 2e-4);
            EXPECT_LT(length(with - box), 5e-4 * block + 1e-3);
        }
    }
}

TEST(add_fields, soft_shares_conserve_the_weighted_field) {
    const Volume volume = test::random_volume(33, 0.3);
    const VoxelField field = field_of("temperature", volume, wavy);
    for (const std::size_t budget : {40, 400}) {
        MomentOptions options;
        options.budget = budget, options.mass_threshold = 0;
        Gaussians model = convert_moments(volume, options);
        add(model, volume, field);
        const ScalarField& made = model.fields.scalar[0];
        double voxels = 0, model_sum = 0;
        for (std::size_t l = 0; l < volume.leaves.size(); ++l)
            for (std::size_t n = 0; n < kLeafVoxels; ++n)
                voxels += double{volume.leaves[l].value[n]} *
                          (double{field.component[0].leaf[l][n]} - 300);
        for (std::size_t t = 0; t < volume.tiles.size(); ++t)
            voxels += double{volume.tiles[t].value} * std::pow(volume.tiles[t].edge, 3) *
                      (double{field.component[0].tile[t]} - 300);
        voxels *= voxel_volume(volume);
        for (std::size_t i = 0; i < model.size(); ++i)
            model_sum += mass(model, i) * (double{made.value[i]} - 300);
        // The shares are those of one more step; means of Gaussians are those of the step before.
        EXPECT_NEAR(model_sum / mass(volume), voxels / mass(volume), 0.05) << budget;
    }
}

TEST(add_fields, a_constant_field_has_no_gradient_and_no_residual) {
    const Volume volume = test::random_volume(35, 0.1);
    const VoxelField field = field_of("temperature", volume, [](Vec3d) { return 0.1; });
    MomentOptions options;
    options.budget = 100;
    Gaussians model = convert_moments(volume, options);
    add(model, volume, field);
    const ScalarField& made = model.fields.scalar[0];
    for (std::size_t i = 0; i < model.size(); ++i) {
        EXPECT_FLOAT_EQ(made.value[i], 0.1f);
        EXPECT_LT(length(vec_cast<double>(made.gradient[i])), 1e-6);
        EXPECT_EQ(made.deviation[i], 0);
    }
}

TEST(add_fields, a_linear_field_has_its_gradient) {
    const Volume volume = leaves_of(36, 0.9);
    const Vec3d slope{0.5, -2, 1.25};
    const VoxelField field =
        field_of("height", volume, [&](Vec3d p) { return 40 + dot(slope, p); });
    MomentOptions options;
    options.budget = 60;
    Gaussians model = convert_moments(volume, options);
    add(model, volume, field);
    const ScalarField& made = model.fields.scalar[0];
    double sum = 0;
    for (std::size_t i = 0; i < model.size(); ++i) {
        const double error = length(vec_cast<double>(made.gradient[i]) - slope);
        // The boxes' own variance makes gradients smaller, by 1 / (12 variance): most in cells of few voxels.
        EXPECT_LT(error, 0.25 * length(slope));
        sum += error;
        EXPECT_NEAR(double{made.value[i]}, 40 + dot(slope, world_mean(model, i)), 0.1);
    }
    EXPECT_LT(sum / static_cast<double>(model.size()), 0.05 * length(slope));
}

TEST(add_fields, a_vector_field_is_three_scalar_ones_and_their_products) {
    const Volume volume = test::random_volume(37, 0.2);
    const auto x = [](Vec3d p) { return std::sin(p.x); };
    const auto y = [](Vec3d p) { return std::cos(p.y) + 0.2 * std::sin(p.x); };
    const auto z = [](Vec3d p) { return 0.1 * p.z; };
    MomentOptions options;
    options.budget = 80;
    Gaussians model = convert_moments(volume, options);
    add(model, volume, field_of("velocity", volume, x, y, z));
    add(model, volume, unlimited(field_of("x", volume, x)));
    add(model, volume, unlimited(field_of("sum", volume, [&](Vec3d p) { return x(p) + y(p); })));
    const VectorField& v = model.fields.vector[0];
    const ScalarField &vx = model.fields.scalar[0], &sum = model.fields.scalar[1];
    for (std::size_t i = 0; i < model.size(); ++i) {
        EXPECT_NEAR(v.value[i].x, vx.value[i], 1e-5);
        EXPECT_LT(length(vec_cast<double>(v.gradient[0][i] - vx.gradient[i])), 1e-4);
        EXPECT_NEAR(std::sqrt(v.covariance[i][0]), vx.deviation[i], 1e-4);
        EXPECT_NEAR(v.covariance[i][0] + 2 * v.covariance[i][1] + v.covariance[i][3],
                    sum.deviation[i] * sum.deviation[i], 1e-4);
    }
}

TEST(add_fields, any_number_of_threads_gives_the_same_bytes) {
    const Volume volume = test::random_volume(38, 0.1);
    const VoxelField field = field_of("temperature", volume, wavy);
    for (const bool by_cells : {false, true}) {
        MomentOptions options;
        options.block_voxels = 4, options.soft_steps = 0;
        Gaussians model = convert_moments(volume, options), one;
        for (const int threads : {1, 2, 3, 8}) {
            const ThreadLimit limit(threads);
            Gaussians made = model;
            add(made, volume, field, {by_cells ? std::optional(UniformCells{4}) : std::nullopt});
            if (threads == 1) one = made;
            EXPECT_EQ(one.fields.scalar[0].value, made.fields.scalar[0].value);
            EXPECT_EQ(one.fields.scalar[0].deviation, made.fields.scalar[0].deviation);
            EXPECT_EQ(one.fields.scalar[0].skewness, made.fields.scalar[0].skewness);
        }
    }
}

/// As two processes hold parts of a volume.
TEST(add_fields, cells_of_the_parts_of_a_volume_are_those_of_the_whole) {
    const Volume volume = leaves_of(39, 0.2);
    const VoxelField field = field_of("temperature", volume, wavy);
    Gaussians whole = hard_model(volume, 4);
    add(whole, volume, field, {UniformCells{4}});
    std::size_t i = 0;
    std::map<std::tuple<float, float, float>, float> value_at;
    for (; i < whole.size(); ++i)
        value_at[{whole.mean[i].x, whole.mean[i].y, whole.mean[i].z}] =
            whole.fields.scalar[0].skewness[i];
    std::size_t found = 0;
    for (const bool upper : {false, true}) {
        Volume part = volume;
        VoxelField of_part = field;
        part.leaves.clear(), of_part.component[0].leaf.clear();
        for (std::size_t l = 0; l < volume.leaves.size(); ++l)
            if ((l >= volume.leaves.size() / 2) == upper) {
                part.leaves.push_back(volume.leaves[l]);
                of_part.component[0].leaf.push_back(field.component[0].leaf[l]);
            }
        MomentOptions options;
        options.block_voxels = 4, options.soft_steps = 0, options.mass_threshold = 0;
        options.origin = whole.origin;
        Gaussians model = convert_moments(part, options);
        add(model, part, of_part, {UniformCells{4}});
        for (std::size_t n = 0; n < model.size(); ++n, ++found) {
            const Vec3f m = model.mean[n];
            ASSERT_TRUE((value_at.contains({m.x, m.y, m.z})));
            EXPECT_EQ((value_at[{m.x, m.y, m.z}]), model.fields.scalar[0].skewness[n]);
        }
    }
    EXPECT_EQ(found, whole.size());
}

/// The volume's own values need no copy.
TEST(add_fields, own_values_are_the_measure) {
    const Volume volume = test::random_volume(40, 0.2);
    VoxelField copied = field_of("density", volume, [](Vec3d) { return 0; });
    for (std::size_t l = 0; l < volume.leaves.size(); ++l)
        copied.component[0].leaf[l] = volume.leaves[l].value;
    for (std::size_t t = 0; t < volume.tiles.size(); ++t)
        copied.component[0].tile[t] = volume.tiles[t].value;
    set_range(copied);
    VoxelField own = copied;
    own.component[0] = {};
    Gaussians first = hard_model(volume, 8), second = first;
    add(first, volume, copied);
    add(second, volume, own);
    EXPECT_EQ(first.fields.scalar[0].value, second.fields.scalar[0].value);
    EXPECT_EQ(first.fields.scalar[0].skewness, second.fields.scalar[0].skewness);
}

}  // namespace
}  // namespace vog
