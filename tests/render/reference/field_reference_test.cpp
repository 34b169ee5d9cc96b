// field_reference_test.cpp: Maps of fields through the voxels against all voxels one by one.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <span>
#include <utility>

#include "render/reference/reference.h"
#include "render/shown_field.h"
#include "support/expected_maps.h"
#include "support/random_volume.h"
#include "support/ray_voxels.h"
#include "support/scenes.h"
#include "vog/error.h"

namespace vog::test {

namespace {

Camera camera_at(Vec3d eye, Vec3d look_at, double fov) {
    Camera camera;
    camera.eye = eye;
    camera.look_at = look_at;
    camera.fov_degrees = fov;
    return camera;
}

/// A value for every voxel of a volume.
VoxelField random_field(const Volume& volume, std::size_t components, std::uint64_t seed) {
    Random random(seed);
    VoxelField field;
    field.name = "field";
    for (std::size_t c = 0; c < components; ++c) {
        VoxelValues values;
        values.leaf.resize(volume.leaves.size());
        for (auto& leaf : values.leaf)
            for (float& value : leaf) value = static_cast<float>(300 + random(-5, 5));
        for (std::size_t n = 0; n < volume.tiles.size(); ++n)
            values.tile.push_back(static_cast<float>(300 + random(-5, 5)));
        field.component.push_back(std::move(values));
    }
    return field;
}

/// Sums along a ray by every voxel of the volume.
void add_by_voxels(const Volume& volume, const VoxelField& field, FieldPart part, Vec3d origin,
                   Vec3d direction, std::vector<FieldSums>& parts) {
    const IndexRay ray(volume, origin, direction);
    const Vec3d to = normalized(direction);
    const auto add = [&](double weight, const std::function<double(std::size_t)>& component) {
        double value = component(0);
        if (part == FieldPart::view)
            value = to.x * component(0) + to.y * component(1) + to.z * component(2);
        if (part == FieldPart::y) value = component(1);
        if (part == FieldPart::z) value = component(2);
        if (weight > 0) parts.push_back({weight, weight * value, weight * value * value});
    };
    for (std::size_t n = 0; n < volume.tiles.size(); ++n) {
        const Tile& tile = volume.tiles[n];
        add(double{tile.value} * ray.length_in(vec_cast<double>(tile.origin), tile.edge) *
                length(direction),
            [&](std::size_t c) { return double{field.component[c].tile[n]}; });
    }
    for (std::size_t n = 0; n < volume.leaves.size(); ++n) {
        const Vec3d corner = vec_cast<double>(volume.leaves[n].origin);
        if (ray.length_in(corner, kLeafEdge) == 0) continue;
        for (int v = 0; v < kLeafVoxels; ++v) {
            const auto at = static_cast<std::size_t>(v);
            if (!volume.leaves[n].active(v)) continue;
            const Vec3d center = corner + Vec3d{double(v >> 6), double(v >> 3 & 7), double(v & 7)};
            add(double{volume.leaves[n].value[at]} * ray.length_in(center, 1) * length(direction),
                [&](std::size_t c) { return double{field.component[c].leaf[n][at]}; });
        }
    }
}

}  // namespace

TEST(field_reference, is_the_sum_over_voxels) {
    for (const auto& [name, map] : grid_maps()) {
        std::vector<Volume> volumes{random_volume(91), random_volume(92)};
        for (Volume& volume : volumes) volume.world_from_index = map;
        volumes[1].tiles.clear();
        const Box box = world_box(volumes[1]);
        Camera camera = camera_at(box.center() + box.radius() * Vec3d{2, 1.5, 1}, box.center(), 30);
        for (const FieldPart part :
             {FieldPart::value, FieldPart::view, FieldPart::z, FieldPart::magnitude}) {
            const std::size_t components = part == FieldPart::value ? 1 : 3;
            const std::vector<VoxelField> fields{random_field(volumes[0], components, 93),
                                                 random_field(volumes[1], components, 94)};
            const FieldMaps maps =
                render_field_reference(volumes, fields, part, camera, 12, 10, {.samples = 2});
            const CameraFrame frame = frame_of(camera, 12, 10);
            for (int y = 0; y < 10; ++y)
                for (int x = 0; x < 12; ++x) {
                    const auto of_part = [&](FieldPart shown) {
                        std::vector<FieldSums> parts;
                        for (const double dx : {-0.25, 0.25})
                            for (const double dy : {-0.25, 0.25})
                                for (std::size_t n = 0; n < 2; ++n)
                                    add_by_voxels(volumes[n], fields[n], shown,
                                                  frame.origin(x + dx, y + dy),
                                                  frame.direction(x + dx, y + dy), parts);
                        return expected(parts);
                    };
                    const Expected exact =
                        part == FieldPart::magnitude ? magnitude_of(of_part) : of_part(part);
                    const auto at = static_cast<std::size_t>(12 * y + x);
                    ASSERT_NEAR(maps.column[at], exact.column / 4, 1e-6 * exact.column) << name;
                    if (exact.column == 0) {
                        ASSERT_TRUE(std::isnan(maps.mean[at])) << name;
                        continue;
                    }
                    ASSERT_NEAR(maps.mean[at], exact.mean, 1e-7 * std::abs(exact.mean)) << name;
                    ASSERT_NEAR(maps.deviation[at], exact.deviation, 1e-5) << name;
                }
        }
    }
}

TEST(field_reference, refuses_fields_of_other_volumes) {
    const std::vector<Volume> volumes{random_volume(91)};
    Volume other = volumes[0];
    other.leaves.pop_back();
    const Camera camera = camera_at({2, 1, 3}, {0, 0, 0}, 40);
    const std::vector<VoxelField> right{random_field(volumes[0], 1, 1)};
    const std::vector<VoxelField> wrong{random_field(other, 1, 1)};
    const auto render = [&](std::span<const VoxelField> fields, FieldPart part, int samples = 1) {
        (void)render_field_reference(volumes, fields, part, camera, 4, 4, {.samples = samples});
    };
    EXPECT_NO_THROW(render(right, FieldPart::value));
    EXPECT_THROW(render(wrong, FieldPart::value), Error);
    EXPECT_THROW(render(right, FieldPart::view), Error);
    EXPECT_THROW(render({}, FieldPart::value), Error);
    EXPECT_THROW(render(right, FieldPart::value, 0), Error);
}

}  // namespace vog::test
