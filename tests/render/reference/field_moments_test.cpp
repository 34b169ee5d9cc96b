// field_moments_test.cpp: Maps of fields through interpolated voxels against sums along rays, and of levels
// against their composite.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "render/reference/reference.h"
#include "support/scenes.h"
#include "vog/field_maps.h"

namespace vog::test {

namespace {

/// One leaf at each origin, with values in [0, 2).
/// fill  share of the voxels that are active
Volume leaves_at(const std::vector<Vec3i>& origins, double edge, Vec3d corner, std::uint64_t seed,
                 double fill = 0.9) {
    Random random(seed);
    Volume volume;
    volume.name = "density";
    for (int axis = 0; axis < 3; ++axis) volume.world_from_index.linear(axis, axis) = edge;
    volume.world_from_index.translation = corner + Vec3d{edge / 2, edge / 2, edge / 2};
    for (const Vec3i origin : origins) {
        Leaf& leaf = volume.leaves.emplace_back();
        leaf.origin = origin;
        for (int n = 0; n < kLeafVoxels; ++n)
            if (random() < fill) leaf.set(n, static_cast<float>(random(0, 2)));
    }
    return volume;
}

VoxelField field_of(const Volume& volume, std::size_t components, std::uint64_t seed) {
    Random random(seed);
    VoxelField field;
    field.name = "field";
    for (std::size_t c = 0; c < components; ++c) {
        VoxelValues& values = field.component.emplace_back();
        values.leaf.resize(volume.leaves.size());
        for (auto& leaf : values.leaf)
            for (float& value : leaf) value = static_cast<float>(random(-3, 5));
    }
    return field;
}

Camera camera_of(double distance) {
    Camera camera;
    camera.eye = distance * Vec3d{1, 0.7, 0.5};
    camera.look_at = {0.8, 0.8, 0.8};
    camera.fov_degrees = 40;
    return camera;
}

double shown(FieldPart part, Vec3d to, Vec3d value) {
    return part == FieldPart::view ? dot(to, value) : part == FieldPart::z ? value.z : value.x;
}

/// Column, mean and deviation of tents around voxel centres, by the midpoint rule.
struct Along {
    double column = 0, mean = 0, deviation = 0;
};
Along by_tents(const Volume& volume, const VoxelField& field, FieldPart part, Vec3d origin,
               Vec3d direction) {
    const Vec3d to = normalized(direction);
    const Mat3 back = inverse(volume.world_from_index.linear);
    std::map<std::array<int, 3>, std::size_t> leaves;
    for (std::size_t n = 0; n < volume.leaves.size(); ++n) {
        const Vec3i at = volume.leaves[n].origin;
        leaves[{at.x, at.y, at.z}] = n;
    }
    constexpr int kSteps = 8000;
    const double step = 6.0 / kSteps;
    double w0 = 0, w1 = 0, w2 = 0;
    for (int k = 0; k < kSteps; ++k) {
        const Vec3d at =
            back * (origin + (k + 0.5) * step * to - volume.world_from_index.translation);
        for (int corner = 0; corner < 8; ++corner) {
            double weight = step;
            Vec3i voxel;
            for (int axis = 0; axis < 3; ++axis) {
                const double low = std::floor(at[axis]), t = at[axis] - low;
                const bool high = corner >> axis & 1;
                voxel[axis] = static_cast<int>(low) + high;
                weight *= high ? t : 1 - t;
            }
            const auto leaf = leaves.find({voxel.x & ~7, voxel.y & ~7, voxel.z & ~7});
            if (leaf == leaves.end()) continue;
            const int n = leaf_offset(voxel.x & 7, voxel.y & 7, voxel.z & 7);
            if (!volume.leaves[leaf->second].active(n)) continue;
            const auto i = static_cast<std::size_t>(n);
            weight *= double{volume.leaves[leaf->second].value[i]};
            Vec3d value;
            for (std::size_t c = 0; c < field.component.size(); ++c)
                value[static_cast<int>(c)] = double{field.component[c].leaf[leaf->second][i]};
            const double phi = shown(part, to, value);
            w0 += weight, w1 += weight * phi, w2 += weight * phi * phi;
        }
    }
    const double mean = w0 > 0 ? w1 / w0 : 0;
    return {w0, mean, w0 > 0 ? std::sqrt(std::max(w2 / w0 - mean * mean, 0.0)) : 0};
}

constexpr int kSize = 8;

}  // namespace

TEST(field_moments, are_sums_over_tents_for_linear_interpolation) {
    const Volume volume = leaves_at({{0, 0, 0}, {0, 0, 8}, {8, 8, 0}}, 0.1, {0, 0, 0}, 1);
    const std::vector<Volume> volumes{volume};
    const CameraFrame frame = frame_of(camera_of(3), kSize, kSize);
    for (const FieldPart part : {FieldPart::value, FieldPart::view, FieldPart::z}) {
        const std::vector<VoxelField> fields{field_of(volume, part == FieldPart::value ? 1 : 3, 2)};
        const FieldMaps maps =
            render_field_reference(volumes, fields, part, camera_of(3), kSize, kSize, {},
                                   {.interpolation = Interpolation::linear, .step_voxels = 0});
        int met = 0;
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x) {
                const Along right =
                    by_tents(volume, fields[0], part, frame.origin(x, y), frame.direction(x, y));
                const auto n = static_cast<std::size_t>(kSize * y + x);
                ASSERT_NEAR(maps.column[n], right.column, 2e-4);
                if (right.column < 0.05) continue;
                ++met;
                ASSERT_NEAR(maps.mean[n], right.mean, 2e-3);
                ASSERT_NEAR(maps.deviation[n], right.deviation, 2e-3);
            }
        EXPECT_GT(met, 10);
    }
}

TEST(field_moments, of_samples_are_means_over_rays) {
    const std::vector<Volume> volumes{leaves_at({{0, 0, 0}}, 0.2, {0, 0, 0}, 3)};
    const std::vector<VoxelField> fields{field_of(volumes[0], 3, 4)};
    // Nine rays a pixel are the pixels of a picture three times as large.
    const VoxelGridOptions linear{.interpolation = Interpolation::linear, .step_voxels = 0};
    const FieldMaps few = render_field_reference(volumes, fields, FieldPart::view, camera_of(3),
                                                 kSize, kSize, {.samples = 3}, linear);
    const FieldMaps many = render_field_reference(volumes, fields, FieldPart::view, camera_of(3),
                                                  3 * kSize, 3 * kSize, {}, linear);
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            double w0 = 0, w1 = 0, w2 = 0;
            for (int n = 0; n < 9; ++n) {
                const auto at =
                    static_cast<std::size_t>((3 * y + n / 3) * 3 * kSize + 3 * x + n % 3);
                if (!(many.column[at] > 0)) continue;
                const double w{many.column[at]}, mean{many.mean[at]}, sd{many.deviation[at]};
                w0 += w, w1 += w * mean, w2 += w * (mean * mean + sd * sd);
            }
            const auto n = static_cast<std::size_t>(kSize * y + x);
            ASSERT_NEAR(few.column[n], w0 / 9, 1e-5);
            if (w0 < 0.1) continue;
            ASSERT_NEAR(few.mean[n], w1 / w0, 1e-4);
            ASSERT_NEAR(few.deviation[n], std::sqrt(w2 / w0 - w1 * w1 / (w0 * w0)), 1e-4);
        }
}

TEST(field_moments, of_levels_are_those_of_their_composite) {
    // 16^3 coarse voxels, and 8^3 of half their edge over a part, with and without masks.
    Levels levels;
    levels.volumes = {leaves_at({{0, 0, 0}, {0, 0, 8}, {8, 0, 0}}, 0.1, {0, 0, 0}, 5),
                      leaves_at({{0, 0, 0}, {0, 0, 8}}, 0.05, {0, 0, 0}, 6, 1.1)};
    levels.volumes[1].name = "fine";
    Levels masked = levels;
    masked.masks = {leaves_at({{0, 0, 0}, {8, 0, 0}}, 0.1, {0, 0, 0}, 7), levels.volumes[1]};
    for (const Levels& mesh : {levels, masked})
        for (const FieldPart part : {FieldPart::value, FieldPart::view}) {
            const std::size_t components = part == FieldPart::value ? 1 : 3;
            std::vector<VoxelField> fields, of_parts;
            for (std::size_t n = 0; n < 2; ++n)
                fields.push_back(field_of(mesh.volumes[n], components, 8 + n));
            const Composite whole = composite(mesh);
            for (std::size_t p = 0; p < whole.parts.size(); ++p) {
                // Voxels are whole, so that each leaf of a part is one of its level.
                const std::size_t level = whole.parts[p].name == mesh.volumes[0].name ? 0 : 1;
                VoxelField& field = of_parts.emplace_back();
                field.component.resize(components);
                for (const Leaf& leaf : whole.parts[p].leaves) {
                    const auto& all = mesh.volumes[level].leaves;
                    const auto same = std::ranges::find_if(
                        all, [&](const Leaf& one) { return one.origin == leaf.origin; });
                    ASSERT_NE(same, all.end());
                    for (std::size_t c = 0; c < components; ++c)
                        field.component[c].leaf.push_back(
                            fields[level]
                                .component[c]
                                .leaf[static_cast<std::size_t>(same - all.begin())]);
                }
            }
            const FieldMaps maps = render_field_reference(mesh, fields, part, camera_of(3), 16, 16);
            const FieldMaps right =
                render_field_reference(whole.parts, of_parts, part, camera_of(3), 16, 16);
            int met = 0;
            for (std::size_t n = 0; n < maps.column.size(); ++n) {
                ASSERT_NEAR(maps.column[n], right.column[n], 1e-6);
                if (right.column[n] < 0.01f) continue;
                ++met;
                ASSERT_NEAR(maps.mean[n], right.mean[n], 1e-5);
                ASSERT_NEAR(maps.deviation[n], right.deviation[n], 2e-3);  // 3e-4 of the range
            }
            EXPECT_GT(met, 20);
        }
}

TEST(field_moments, of_levels_that_cut_voxels_are_sums_over_their_pieces) {
    // Fine voxels of 1/3 of a coarse edge, shifted by half a fine voxel: coarse voxels are hidden in part.
    Levels levels;
    levels.volumes = {leaves_at({{0, 0, 0}}, 0.3, {0, 0, 0}, 5, 1.1),
                      leaves_at({{0, 0, 0}}, 0.1, {0.35, 0.35, 0.35}, 6, 1.1)};
    const std::vector<VoxelField> fields{field_of(levels.volumes[0], 3, 8),
                                         field_of(levels.volumes[1], 3, 9)};
    const FieldMaps maps =
        render_field_reference(levels, fields, FieldPart::view, camera_of(5), kSize, kSize);
    const CameraFrame frame = frame_of(camera_of(5), kSize, kSize);
    const Mat3 to_coarse = inverse(levels.volumes[0].world_from_index.linear);
    const Mat3 to_fine = inverse(levels.volumes[1].world_from_index.linear);
    int met = 0;
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            const Vec3d to = normalized(frame.direction(x, y));
            constexpr int kSteps = 20000;
            const double step = 10.0 / kSteps;
            double w0 = 0, w1 = 0, w2 = 0;
            for (int k = 0; k < kSteps; ++k) {
                const Vec3d at = frame.origin(x, y) + (k + 0.5) * step * to;
                for (const std::size_t n : {1, 0}) {
                    const Volume& volume = levels.volumes[n];
                    const Vec3d p =
                        (n ? to_fine : to_coarse) * (at - volume.world_from_index.translation);
                    const Vec3i voxel{int(std::floor(p.x + 0.5)), int(std::floor(p.y + 0.5)),
                                      int(std::floor(p.z + 0.5))};
                    if (std::min({voxel.x, voxel.y, voxel.z}) < 0 ||
                        std::max({voxel.x, voxel.y, voxel.z}) > 7)
                        continue;
                    const auto i = static_cast<std::size_t>(leaf_offset(voxel.x, voxel.y, voxel.z));
                    Vec3d value;
                    for (std::size_t c = 0; c < 3; ++c)
                        value[static_cast<int>(c)] = double{fields[n].component[c].leaf[0][i]};
                    const double w = step * double{volume.leaves[0].value[i]};
                    const double phi = dot(to, value);
                    w0 += w, w1 += w * phi, w2 += w * phi * phi;
                    break;
                }
            }
            const auto n = static_cast<std::size_t>(kSize * y + x);
            ASSERT_NEAR(maps.column[n], w0, 5e-3);
            if (w0 < 0.3) continue;
            ++met;
            ASSERT_NEAR(maps.mean[n], w1 / w0, 0.02);
            ASSERT_NEAR(maps.deviation[n], std::sqrt(w2 / w0 - w1 * w1 / (w0 * w0)), 0.02);
        }
    EXPECT_GT(met, 10);
}

TEST(field_moments, of_interpolated_levels_have_their_column_and_are_linear_in_the_field) {
    Levels levels;
    levels.volumes = {leaves_at({{0, 0, 0}, {0, 0, 8}, {8, 0, 0}}, 0.1, {0, 0, 0}, 5),
                      leaves_at({{0, 0, 0}, {0, 0, 8}}, 0.05, {0, 0, 0}, 6)};
    const VoxelGridOptions linear{.interpolation = Interpolation::linear, .step_voxels = 0};
    std::vector<VoxelField> constant, any, twice;
    for (std::size_t n = 0; n < 2; ++n) {
        constant.push_back(field_of(levels.volumes[n], 1, 0));
        for (auto& leaf : constant[n].component[0].leaf) leaf.fill(-7);
        any.push_back(field_of(levels.volumes[n], 1, 9 + n));
        twice.push_back(any[n]);
        for (auto& leaf : twice[n].component[0].leaf)
            for (float& value : leaf) value = 2 * value + 100;
    }
    const auto render = [&](const std::vector<VoxelField>& fields) {
        return render_field_reference(levels, fields, FieldPart::value, camera_of(3), 12, 12, {},
                                      linear);
    };
    const DepthImage depth =
        render_reference(level_grids(levels, linear), camera_of(3), 12, 12, {});
    const FieldMaps same = render(constant), one = render(any), other = render(twice);
    int met = 0;
    for (std::size_t n = 0; n < depth.depth.size(); ++n) {
        ASSERT_NEAR(one.column[n], depth.depth[n], 1e-6);
        if (depth.depth[n] < 0.01f) continue;
        ++met;
        ASSERT_NEAR(same.mean[n], -7, 1e-6);
        ASSERT_NEAR(same.deviation[n], 0, 1e-6);
        ASSERT_NEAR(other.mean[n], 2 * one.mean[n] + 100, 1e-4);
        ASSERT_NEAR(other.deviation[n], 2 * one.deviation[n], 1e-3);
        EXPECT_GE(one.mean[n], -3);
        EXPECT_LE(one.mean[n], 5);
    }
    EXPECT_GT(met, 20);
}

}  // namespace vog::test
