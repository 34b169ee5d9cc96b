// field_boxes_test.cpp: Maps of fields by boxes, the way of parallel rays and large voxels, against the walk from voxel
// to voxel, which any clip chooses.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "render/reference/fields/box_view.h"
#include "render/reference/reference.h"
#include "support/random_volume.h"
#include "vog/field_maps.h"
#include "vog/progress.h"

namespace vog::test {

namespace {

VoxelField field_at(const Volume& volume, std::size_t components, std::uint64_t seed) {
    Random random(seed);
    VoxelField field;
    field.name = "field";
    for (std::size_t c = 0; c < components; ++c) {
        VoxelValues& values = field.component.emplace_back();
        values.leaf.resize(volume.leaves.size());
        for (auto& leaf : values.leaf)
            for (float& value : leaf) value = static_cast<float>(300 + random(-5, 5));
        for (std::size_t n = 0; n < volume.tiles.size(); ++n)
            values.tile.push_back(static_cast<float>(300 + random(-5, 5)));
    }
    return field;
}

/// Clip that leaves everything: pictures with one are drawn ray by ray.
ReferenceOptions by_rays() {
    ReferenceOptions options;
    options.clip.planes.push_back({{0.3, 0.5, 0.7}, -1e15});
    return options;
}

/// Camera with parallel rays towards the voxels around index 0.
/// away  direction to the eye, world;  width  of the picture, world
Camera parallel_camera(const Volume& volume, Vec3d away, double width) {
    Camera camera;
    camera.look_at = volume.world_from_index({3.3, 4.1, 4.7});
    camera.eye = camera.look_at + away;
    camera.up = {0.1, 0.2, 1};
    camera.orthographic_width = width;
    return camera;
}

void expect_same(const FieldMaps& boxes, const FieldMaps& rays, const std::string& name) {
    float most = 0;
    for (const float column : rays.column) most = std::max(most, column);
    ASSERT_GT(most, 0) << name;
    for (std::size_t n = 0; n < rays.column.size(); ++n) {
        // Rays that graze a voxel's edge have lengths of rounding, by either way.
        const double grazing = 1e-12 * double{most};
        ASSERT_NEAR(boxes.column[n], rays.column[n], 2e-7 * rays.column[n] + grazing) << name;
        if (!(rays.column[n] > 1e3 * grazing)) continue;
        ASSERT_NEAR(boxes.mean[n], rays.mean[n], 4e-5) << name;  // an ulp of 300
        ASSERT_NEAR(boxes.deviation[n], rays.deviation[n], 1e-6) << name;
    }
}

bool drawn_by_boxes(const Volume& volume, const VoxelField& field, FieldPart part,
                    const Camera& camera, int width, int height) {
    const reference::FieldGrid grid(volume, field, part);
    return reference::BoxView<reference::FieldGrid>(grid, frame_of(camera, width, height))
        .faster_than_rays();
}

constexpr int kWidth = 70, kHeight = 50;  // tiles of pixels in part

}  // namespace

TEST(field_boxes, are_the_walk_in_any_lattice) {
    auto maps = grid_maps();
    maps.push_back({"far", {maps.back().second.linear, {3e6, -2e6, 1e6}}});
    for (const auto& [name, map] : maps) {
        std::vector<Volume> volumes{random_volume(3)};
        volumes[0].world_from_index = map;
        const double edge = std::cbrt(voxel_volume(volumes[0]));
        // Eyes beside the voxels, and among them.
        for (const Vec3d away : {400 * edge * Vec3d{1, 0.7, 0.5}, edge * Vec3d{-0.3, 0.1, -0.2}})
            for (const FieldPart part : {FieldPart::value, FieldPart::view}) {
                const Camera camera = parallel_camera(volumes[0], away, 20 * edge);
                const std::vector<VoxelField> fields{
                    field_at(volumes[0], part == FieldPart::value ? 1 : 3, 5)};
                ASSERT_TRUE(drawn_by_boxes(volumes[0], fields[0], part, camera, kWidth, kHeight))
                    << name;
                const auto render = [&](const ReferenceOptions& options) {
                    return render_field_reference(volumes, fields, part, camera, kWidth, kHeight,
                                                  options);
                };
                const FieldMaps rays = render(by_rays());
                expect_same(render({}), rays, name);
                const VoxelGrid grid = voxel_grid(volumes[0]);
                const DepthImage depths = render_reference({&grid, 1}, camera, kWidth, kHeight);
                const float most = std::ranges::max(rays.column);
                for (std::size_t n = 0; n < rays.column.size(); ++n)
                    ASSERT_NEAR(depths.depth[n], rays.column[n],
                                3e-7 * rays.column[n] + 1e-9 * double{most})
                        << name;
            }
    }
}

TEST(field_boxes, rays_in_faces_belong_to_one_voxel) {
    // A voxel has 4 pixels, the first on its face.
    std::vector<Volume> volumes{random_volume(4)};
    const std::vector<VoxelField> fields{field_at(volumes[0], 1, 6)};
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-1.0, 1.0}) {
            Camera camera;
            camera.look_at = {0.5, 0.5, 0.5};
            camera.eye = camera.look_at;
            camera.eye[axis] += 64 * side;
            camera.up = axis == 1 ? Vec3d{0, 0, 1} : Vec3d{0, 1, 0};
            camera.orthographic_width = 65.0 / 4;  // an odd size has a pixel in the middle
            const auto render = [&](const ReferenceOptions& options) {
                return render_field_reference(volumes, fields, FieldPart::value, camera, 65, 65,
                                              options);
            };
            expect_same(render({}), render(by_rays()), std::to_string(axis));
        }
}

TEST(field_boxes, large_and_small_voxels_add_up) {
    // The coarse volume is drawn by boxes, the fine one beside it by rays.
    std::vector<Volume> volumes{random_volume(7), random_volume(8)};
    volumes[1].world_from_index.linear = {{Vec3d{0.2, 0, 0}, Vec3d{0, 0.2, 0}, Vec3d{0, 0, 0.2}}};
    const std::vector<VoxelField> fields{field_at(volumes[0], 3, 1), field_at(volumes[1], 3, 2)};
    const Camera camera = parallel_camera(volumes[0], {40, 30, 20}, 30);
    ASSERT_TRUE(drawn_by_boxes(volumes[0], fields[0], FieldPart::view, camera, kWidth, kHeight));
    ASSERT_FALSE(drawn_by_boxes(volumes[1], fields[1], FieldPart::view, camera, kWidth, kHeight));
    const auto render = [&](const ReferenceOptions& options) {
        return render_field_reference(volumes, fields, FieldPart::view, camera, kWidth, kHeight,
                                      options);
    };
    expect_same(render({}), render(by_rays()), "added");
}

TEST(field_boxes, levels_count_once) {
    // Two fine voxels along an edge of a coarse one; the fine leaf hides 4^3 coarse voxels.
    Random random(12);
    Volume coarse = random_volume(7), fine = coarse;
    fine.leaves = {random_leaf(random, {0, 0, 0}, 1.1)};
    fine.tiles.clear();
    fine.world_from_index = {{{Vec3d{0.5, 0, 0}, Vec3d{0, 0.5, 0}, Vec3d{0, 0, 0.5}}},
                             {-0.25, -0.25, -0.25}};
    const Levels levels{{coarse, fine}, {}};
    const std::vector<VoxelField> fields{field_at(coarse, 3, 1), field_at(fine, 3, 2)};
    const Camera camera = parallel_camera(coarse, {40, 30, 20}, 30);
    const auto render = [&](const ReferenceOptions& options) {
        return render_field_reference(levels, fields, FieldPart::y, camera, kWidth, kHeight,
                                      options);
    };
    expect_same(render({}), render(by_rays()), "levels");
}

TEST(field_boxes, any_number_of_threads_gives_the_same_bytes) {
    const std::vector<Volume> volumes{random_volume(9)};
    const std::vector<VoxelField> fields{field_at(volumes[0], 1, 2)};
    const Camera camera = parallel_camera(volumes[0], {40, 30, 20}, 20);
    const auto render = [&](int threads) {
        const ThreadLimit limit(threads);
        return render_field_reference(volumes, fields, FieldPart::value, camera, 130, 90);
    };
    const FieldMaps one = render(1), three = render(3);
    for (const auto map : {&FieldMaps::column, &FieldMaps::mean, &FieldMaps::deviation})
        EXPECT_EQ(0, std::memcmp((one.*map).data(), (three.*map).data(),
                                 sizeof(float) * one.column.size()));
}

}  // namespace vog::test
