// carried_fields_test.cpp: adaptive cuts that follow the fields of their model.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "render/reference/reference.h"
#include "render/splat/fields/field_splat.h"
#include "support/level_volumes.h"
#include "support/made_fields.h"
#include "support/moment_volumes.h"
#include "vog/compare_maps.h"
#include "vog/convert_fields.h"
#include "vog/distributed.h"
#include "vog/field_maps.h"
#include "vog/levels.h"

namespace vog {
namespace {

using test::field_of;
using Fields = std::vector<std::vector<VoxelField>>;

constexpr double kEdge = 48;  // of the mesh, world units
const Vec3d kCenter{kEdge / 2, kEdge / 2, kEdge / 2}, kClump{30, 30, 24};

/// Cube of voxels of `edge` from `lower` to `upper`, world units; a smooth density that a clump draws the cut to.
Volume smooth_level(double edge, double lower, double upper) {
    test::VolumeMaker maker;
    for (Vec3d& row : maker.volume.world_from_index.linear.row) row = edge * row;
    maker.volume.world_from_index.translation = {lower + edge / 2, lower + edge / 2,
                                                 lower + edge / 2};
    const int across = static_cast<int>(std::lround((upper - lower) / edge));
    for (int x = 0; x < across; ++x)
        for (int y = 0; y < across; ++y)
            for (int z = 0; z < across; ++z) {
                const Vec3d d =
                    maker.volume.world_from_index({double(x), double(y), double(z)}) - kClump;
                maker.set({x, y, z}, static_cast<float>(0.2 + 10 * std::exp(-dot(d, d) / 50)));
            }
    Volume volume = maker.finish();
    volume.name = "density";
    return volume;
}

/// A mesh of two levels, the finer one in the middle.
Composite smooth_mesh() {
    Levels levels;
    levels.volumes = {smooth_level(2, 0, kEdge), smooth_level(1, kEdge / 4, 3 * kEdge / 4)};
    return composite(levels);
}

/// Hot inside a sphere of radius 4, cold outside; a front as wide as two voxels, which Gaussians of their size can follow.
double front(Vec3d at) { return 1 + 999 / (1 + std::exp(length(at - Vec3d{18, 18, 24}) - 4)); }

template <class... Function>
std::vector<VoxelField> at_parts(const Composite& mesh, const std::string& name,
                                 const Function&... function) {
    std::vector<VoxelField> field;
    for (const Volume& part : mesh.parts) field.push_back(field_of(name, part, function...));
    return field;
}

/// Worst relative L2 of the mean of a field, and of the column, along x, y and z.
struct MapErrors {
    double mean = 0, column = 0;
};
MapErrors map_errors(const Gaussians& model, const Composite& mesh,
                     const std::vector<VoxelField>& field) {
    MapErrors worst;
    for (int axis = 0; axis < 3; ++axis) {
        Camera camera;
        camera.look_at = kCenter, camera.eye = kCenter;
        camera.eye[axis] -= 2 * kEdge;
        camera.up = {axis == 1 ? 1.0 : 0.0, axis == 1 ? 0.0 : 1.0, 0};
        camera.orthographic_width = kEdge;
        const FieldPart part = field.front().is_vector() ? FieldPart::x : FieldPart::value;
        const FieldDifference difference =
            compare(render_field_reference(mesh.parts, field, part, camera, 96, 96),
                    render_field_splat(model, {field.front().name, part}, camera, 96, 96));
        worst.mean = std::max(worst.mean, difference.mean_l2);
        worst.column = std::max(worst.column, difference.column_l2);
    }
    return worst;
}

/// The model whose cut follows the density alone.
Gaussians without_following(const Composite& mesh, const Fields& fields,
                            const MomentOptions& options) {
    Gaussians model = convert_moments(mesh, options);
    add_fields(model, mesh.parts, fields);
    return model;
}

TEST(carried_fields, a_mean_errs_at_most_twice_as_much_as_the_column) {
    const Composite mesh = smooth_mesh();
    const Fields fields{at_parts(mesh, "temperature", front)};
    MomentOptions options;
    options.budget = static_cast<std::size_t>(mesh.voxels / 16);
    const MapErrors blind = map_errors(without_following(mesh, fields, options), mesh, fields[0]);
    const MapErrors follows =
        map_errors(convert_for_field(mesh, fields, options, {}), mesh, fields[0]);
    // At most twice the error of the column, which stays: 0.110 and 0.068 when this was written. A cut by the density only
    // has 0.169.
    EXPECT_LE(follows.mean, 2 * follows.column);
    EXPECT_GT(blind.mean, 2 * blind.column);
    EXPECT_LE(follows.column, 1.03 * blind.column);
}

TEST(carried_fields, errors_of_means_are_reported_beside_those_of_t) {
    const Composite mesh = smooth_mesh();
    Fields fields{at_parts(mesh, "temperature", front),
                  at_parts(mesh, "cold", [](Vec3d) { return 7.0; }),
                  {}};
    for (const Volume& part : mesh.parts) fields[2].push_back(measure_field(part, "density"));
    MomentOptions options;
    options.budget = static_cast<std::size_t>(mesh.voxels / 16);
    MomentReport report;
    (void)convert_for_field(mesh, fields, options, {}, &report);
    EXPECT_TRUE(report.field_errors.empty());
    options.measure = true;
    const Gaussians model = convert_for_field(mesh, fields, options, {}, &report);
    ASSERT_EQ(report.field_errors.size(), 2u);
    const auto [name, error] = report.field_errors.front();
    EXPECT_EQ(name, "temperature");
    // Other views have the same field, not the same pixels.
    const double along_axes = map_errors(model, mesh, fields[0]).mean;
    EXPECT_GT(error, 0.8 * along_axes);
    EXPECT_LT(error, 1.5 * along_axes);
    EXPECT_LT(report.field_errors.back().second, 0.01);  // pixels at the rim
    EXPECT_NE(detail_text(report).find("means along rays in the worst view: temperature 0."),
              std::string::npos);
}

TEST(carried_fields, vectors_count_by_all_components) {
    const Composite mesh = smooth_mesh();
    const auto zero = [](Vec3d) { return 0.0; };
    const Fields fields{at_parts(mesh, "velocity", front, zero, zero)};
    MomentOptions options;
    options.budget = default_count(mesh.voxels);
    const Gaussians vector = convert_for_field(mesh, fields, options, {});
    const Gaussians scalar =
        convert_for_field(mesh, Fields{at_parts(mesh, "temperature", front)}, options, {});
    EXPECT_EQ(vector.mean, scalar.mean);
    EXPECT_EQ(vector.scale, scalar.scale);
}

TEST(carried_fields, constant_fields_and_own_values_change_no_cut) {
    const Composite mesh = smooth_mesh();
    Fields fields{at_parts(mesh, "cold", [](Vec3d) { return 0.1; }), {}};
    for (const Volume& part : mesh.parts) fields[1].push_back(measure_field(part, "density"));
    EXPECT_TRUE(carried_fields(mesh.parts, fields).empty());
    MomentOptions options;
    options.budget = 300;
    const Gaussians with = convert_for_field(mesh, fields, options, {}),
                    without = without_following(mesh, fields, options);
    EXPECT_EQ(with.mean, without.mean);
    EXPECT_EQ(with.scale, without.scale);
    EXPECT_EQ(with.density, without.density);
}

TEST(carried_fields, units_and_offsets_of_a_field_do_not_count) {
    // Powers of two and sums of whole numbers: the same up to rounding in the last place, which moves no split.
    const Composite mesh = smooth_mesh();
    const auto scaled = [](Vec3d at) { return 64 * front(at) - 8192; };
    MomentOptions options;
    options.budget = 500;
    const Gaussians a = convert_for_field(mesh, Fields{at_parts(mesh, "f", front)}, options, {}),
                    b = convert_for_field(mesh, Fields{at_parts(mesh, "f", scaled)}, options, {});
    EXPECT_EQ(a.mean, b.mean);
    EXPECT_EQ(a.scale, b.scale);
}

TEST(carried_fields, deviations_weigh_by_mass_over_levels_and_processes) {
    // 1000 voxels of density 1 with the value 1, and 8^3 of density 3 and an eighth of the volume with the value -1.
    Volume coarse = test::cube_of(10, 1, Affine{});
    const Affine fine = test::nested_map(Affine{}, 2, {20, 0, 0});
    const std::vector<Volume> parts{coarse, test::cube_of(8, 3, fine)};
    const auto side = [](Vec3d at) { return at.x < 15 ? 1.0 : -1.0; };
    const Fields fields{{field_of("s", parts[0], side), field_of("s", parts[1], side)}};
    const auto found = carried_fields(parts, fields);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].levels, &fields[0]);
    const double a = 1000, b = 8 * 8 * 8 * 3 / 8.0;
    EXPECT_NEAR(found[0].deviation, 2 * std::sqrt(a * b) / (a + b), 1e-12);

    // The first part here, the second elsewhere: sums of another process with the mass b and the value -1.
    int call = 0;
    Collective other;
    other.count = 2;
    other.allreduce_max = [](std::span<double>) {};
    other.allreduce_sum = [&](std::span<double> sums) {
        const double value = -1 - (call++ ? (a - b) / (a + b) : 0);
        sums[0] += b, sums[1] += b * value, sums[4] += b * value * value;
    };
    const Fields here{{fields[0][0]}};
    const auto shared = carried_fields(std::span(parts).first(1), here, &other);
    ASSERT_EQ(shared.size(), 1u);
    EXPECT_NEAR(shared[0].deviation, found[0].deviation, 1e-12);
}

TEST(carried_fields, tiles_count_as_their_voxels) {
    // 8^3 voxels with a hot corner, and 8^3 of the same density that one value fills: a leaf, or a tile.
    Volume leaves = test::cube_of(8, 1, Affine{}), tile = leaves;
    Leaf second = leaves.leaves.front();
    second.origin.x = 8;
    leaves.leaves.push_back(second);
    tile.tiles.push_back({{8, 0, 0}, 8, 1});
    const auto corner = [](Vec3d at) { return at.x < 2 && at.y < 2 && at.z < 2 ? 1.0 : 0.0; };
    MomentOptions options;
    options.budget = 12, options.soft_steps = 0;
    const auto means = [&](const Volume& volume) {
        return convert_for_field(volume, Fields{{field_of("f", volume, corner)}}, options, {}).mean;
    };
    EXPECT_EQ(means(tile), means(leaves));
    EXPECT_NE(means(tile), convert_moments(tile, options).mean);
}

}  // namespace
}  // namespace vog
