// volumes_test.cpp: Pictures of voxels by OptiX against the reference's: maps of fields, light by value, maxima, clips,
// samples, levels of meshes, and what they refuse.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "render/gpu/voxels/gpu_volumes.h"
#include "support/gpus.h"
#include "support/level_volumes.h"
#include "support/random_volume.h"
#include "support/refusal.h"
#include "vog/distributed.h"
#include "vog/picture.h"

namespace vog::test {

namespace {

constexpr int kVoxelsWidth = 15, kVoxelsHeight = 12;

/// Values about 300 at every voxel of a volume.
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
    field.lower = 295, field.upper = 305;
    return field;
}
VoxelField own(const Volume&) {
    VoxelField field;
    field.name = "density";
    field.component.resize(1);
    return field;
}

/// Leaves alone, whose box a camera fills with voxels of all sizes of nodes behind.
Volume leaves_and_tiles(std::uint64_t seed, const Affine& map) {
    Volume volume = random_volume(seed);
    volume.world_from_index = map;
    volume.tiles.resize(2);  // of 8 and 128 voxels
    return volume;
}

Box box_of_leaves(Volume volume) {
    volume.tiles.clear();
    return world_box(volume);
}
Camera looking_at(const Box& box, double distance, double width = 0) {
    Camera camera;
    camera.eye = box.center() + distance * box.radius() * Vec3d{0.8, 0.43, 0.61};
    camera.look_at = box.center() + 0.1 * box.radius() * Vec3d{0.3, 0.2, -0.1};
    camera.fov_degrees = 40;
    camera.orthographic_width = width * box.radius();
    return camera;
}
/// From without, from within, parallel.
std::vector<Camera> cameras_of(const Box& box) {
    return {looking_at(box, 2.5), looking_at(box, 0.4), looking_at(box, 2, 1.6)};
}

Clipping clip_of(const Box& box) {
    Clipping clip;
    clip.planes = {{{0.4, -0.3, 1}, dot(Vec3d{0.4, -0.3, 1}, box.center()) - 0.1 * box.radius()}};
    clip.box = Box{box.center() - 0.45 * (box.upper - box.lower),
                   box.center() + 0.3 * (box.upper - box.lower)};
    return clip;
}

/// A step, a ramp, a gap, and a plateau over a field's range.
ValueTransfer colors_of(double low, double range, double unit_distance) {
    return {"colors",
            {{low, 0, 0, 1}, {low + 0.4 * range, 0, 1, 0}, {low + range, 1, 0.5, 0}},
            {{low, 0.02},
             {low + 0.3 * range, 0.3},
             {low + 0.3 * range, 0},
             {low + 0.5 * range, 0},
             {low + 0.6 * range, 1e-5},
             {low + 0.8 * range, 0.4}},
            unit_distance};
}

VolumeLook lit_look() {
    VolumeLook look;
    look.light = true;
    look.lights = {{{0.3, 1, 0.2}}};
    return look;
}

void expect_same(const std::vector<float>& found, const std::vector<float>& expected,
                 double tolerance) {
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t n = 0; n < found.size(); ++n) {
        ASSERT_EQ(std::isnan(found[n]), std::isnan(expected[n])) << n;
        if (!std::isnan(expected[n])) {
            ASSERT_NEAR(found[n], expected[n], tolerance) << n;
        }
    }
}
double largest_of(const std::vector<float>& values) {
    double largest = 0;
    for (const float value : values)
        if (!std::isnan(value)) largest = std::max(largest, double{value});
    return largest;
}
/// deviation  rounding of the deviations
void expect_same(const FieldMaps& found, const FieldMaps& expected, double deviation = 1e-6) {
    // Rounding to floats.
    const double column = largest_of(expected.column), mean = largest_of(expected.mean);
    EXPECT_GT(column, 0);
    expect_same(found.column, expected.column, 1e-6 * column);
    expect_same(found.mean, expected.mean, 1e-6 * mean);
    // Squares of differences of a few units, in double precision.
    expect_same(found.deviation, expected.deviation,
                deviation * (largest_of(expected.deviation) + 1));
}
/// Both are in double precision; rays of the reference end at a ten-thousandth of a display step, too.
void expect_same(const VolumeImage& found, const VolumeImage& expected) {
    ASSERT_EQ(found.pixel.size(), expected.pixel.size());
    float most = 0;
    for (std::size_t n = 0; n < found.pixel.size(); ++n)
        for (const auto channel : {&Rgba::r, &Rgba::g, &Rgba::b, &Rgba::a}) {
            ASSERT_NEAR(found.pixel[n].*channel, expected.pixel[n].*channel, 1e-6) << n;
            most = std::max(most, expected.pixel[n].*channel);
        }
    EXPECT_GT(most, 0.05F);
}

class gpu_volumes : public GpuTest {
  protected:
    void SetUp() override {
        GpuTest::SetUp();
        if (!IsSkipped() && gpus().back().renderer != Renderer::optix)
            GTEST_SKIP() << "needs OptiX";
    }
    /// Calls body in every way of traversing a hierarchy.
    template <class Body>
    static void each_traversal(const Body& body) {
        for (const Gpu& gpu : gpus()) {
            if (gpu.renderer != Renderer::optix) continue;
            SCOPED_TRACE(gpu.name);
            gpu.prepare();
            body();
        }
    }
};

}  // namespace

TEST_F(gpu_volumes, have_the_references_maps_of_fields) {
    for (const auto& [name, map] : grid_maps()) {
        if (name == "swapped" || name == "rotated") continue;  // time
        SCOPED_TRACE(name);
        const std::vector<Volume> volumes{leaves_and_tiles(1, map), leaves_and_tiles(2, map)};
        const Box box = box_of_leaves(volumes[0]);
        for (const bool vector : {false, true}) {
            const std::vector<VoxelField> fields{
                random_field(volumes[0], vector ? 3 : 1, 3),
                vector ? random_field(volumes[1], 3, 4) : own(volumes[1])};
            const std::vector<FieldPart> parts =
                vector ? std::vector{FieldPart::view, FieldPart::y, FieldPart::magnitude}
                       : std::vector{FieldPart::value};
            each_traversal([&] {
                GpuVolumes gpu(volumes, fields);
                std::size_t view = 0;
                for (const Camera& camera : cameras_of(box))
                    for (const FieldPart part : parts) {
                        ReferenceOptions options;
                        options.samples = 1 + static_cast<int>(view % 2);
                        if (view++ % 3) options.clip = clip_of(box);
                        expect_same(gpu.fields(part, camera, kVoxelsWidth, kVoxelsHeight, options),
                                    render_field_reference(volumes, fields, part, camera,
                                                           kVoxelsWidth, kVoxelsHeight, options));
                    }
                EXPECT_GE(gpu.gpu_ms(), 0);
            });
        }
    }
}

TEST_F(gpu_volumes, by_value_are_the_references) {
    const Affine map = grid_maps().back().second;  // sheared
    const std::vector<Volume> both{leaves_and_tiles(5, map),
                                   leaves_and_tiles(6, grid_maps()[3].second)};
    const Box box = box_of_leaves(both[0]);
    const double unit = 0.2 * box.radius();
    const auto draw = [&](std::span<const Volume> volumes, const std::vector<VoxelField>& fields,
                          const ValueTransfer& transfer) {
        each_traversal([&] {
            GpuVolumes gpu(volumes, fields);
            int view = 0;
            for (const Camera& camera : cameras_of(box)) {
                VolumeLook look = view % 2 ? VolumeLook{} : lit_look();
                ReferenceOptions options;
                options.samples = view == 2 ? 2 : 1;
                if (view == 1) look.clip = clip_of(box);
                if (view == 2) options.clip = clip_of(box);
                ++view;
                const VolumeImage found =
                    gpu.volume(transfer, camera, kVoxelsWidth, kVoxelsHeight, options, look);
                expect_same(found,
                            render_volume_reference(volumes, fields, transfer, camera, kVoxelsWidth,
                                                    kVoxelsHeight, options, look));
            }
        });
    };
    const std::vector<VoxelField> owns{own(both[0]), own(both[1])};
    const std::vector<VoxelField> fields{random_field(both[0], 1, 7), random_field(both[1], 1, 8)};
    const ValueTransfer of_density = colors_of(0, 2, unit), of_field = colors_of(295, 10, unit);
    draw(std::span(both).first(1), {owns[0]}, of_density);
    draw(std::span(both).first(1), {fields[0]}, of_field);
    draw(both, fields, of_field);  // overlapping: extinctions add up
    ValueTransfer by_gradient = of_field;
    by_gradient.gradient = {{0, 0.1}, {2, 0.5}, {20, 1}};
    draw(both, fields, by_gradient);
    // Opaque: rays end.
    draw(std::span(both).first(1), {owns[0]}, colors_of(0, 2, 1e-4 * unit));
    draw(both, owns, colors_of(0, 2, 1e-4 * unit));
}

TEST_F(gpu_volumes, of_maxima_are_the_references) {
    const std::vector<Volume> volumes{leaves_and_tiles(9, grid_maps()[0].second),
                                      leaves_and_tiles(10, grid_maps()[0].second)};
    const Box box = box_of_leaves(volumes[0]);
    const std::vector<VoxelField> fields{random_field(volumes[0], 1, 11), own(volumes[1])};
    each_traversal([&] {
        GpuVolumes gpu(volumes, fields);
        int view = 0;
        for (const Camera& camera : cameras_of(box)) {
            ReferenceOptions options;
            options.samples = view == 1 ? 3 : 1;
            if (view++ == 2) options.clip = clip_of(box);
            const ValueMap expected = render_maximum_reference(
                volumes, fields, camera, kVoxelsWidth, kVoxelsHeight, options);
            EXPECT_GT(largest_of(expected.value), 300);
            expect_same(gpu.maximum(camera, kVoxelsWidth, kVoxelsHeight, options).value,
                        expected.value, 1e-4);
        }
    });
}

TEST_F(gpu_volumes, have_the_references_depth_with_clips) {
    const Volume volume = leaves_and_tiles(12, grid_maps()[1].second);
    const Box box = box_of_leaves(volume);
    const vog::Scene scene = scene_of(volume);
    PictureRequest request{.width = kVoxelsWidth, .height = kVoxelsHeight};
    request.options.clip = clip_of(box);
    request.options.samples = 2;
    for (const Camera& camera : cameras_of(box)) {
        request.camera = camera;
        request.renderer = Renderer::reference;
        PictureRenderer reference(scene);
        const DepthImage expected = bare_depth(reference, request);
        request.renderer = Renderer::optix;
        const double most = largest_of(expected.depth);
        EXPECT_GT(most, 0);
        each_traversal([&] {
            PictureRenderer optix(scene);
            const DepthImage found = bare_depth(optix, request);
            EXPECT_TRUE(optix.report().gpu_ms.has_value());
            expect_same(found.depth, expected.depth, 1e-6 * most);
        });
    }
}

/// Finer levels hide coarser ones, with fields: on faces of voxels, and on half of them, which are cut into pieces.
TEST_F(gpu_volumes, of_levels_are_the_references) {
    for (const double lower : {2.5, 2.0}) {
        SCOPED_TRACE(lower);
        const Levels levels = nested_cubes(8, turned_map(), {{2, {lower, lower, lower}, 6}});
        const std::vector<VoxelField> fields{random_field(levels.volumes[0], 3, 13),
                                             random_field(levels.volumes[1], 3, 14)};
        const std::vector<VoxelField> owns{own(levels.volumes[0]), own(levels.volumes[1])};
        const Camera camera = looking_at(world_box(levels.volumes[0]), 2.5);
        each_traversal([&] {
            GpuVolumes gpu(levels, fields);
            // Of cut voxels the reference has moments in floats (render/reference/reference.h): 3e-4 of the field's range, ten.
            expect_same(gpu.fields(FieldPart::view, camera, kVoxelsWidth, kVoxelsHeight),
                        render_field_reference(levels, fields, FieldPart::view, camera,
                                               kVoxelsWidth, kVoxelsHeight),
                        lower == 2.5 ? 1e-6 : 3e-3);
            GpuVolumes plain(levels, owns);
            const FieldMaps expected = render_field_reference(levels, owns, FieldPart::value,
                                                              camera, kVoxelsWidth, kVoxelsHeight);
            expect_same(plain.fields(FieldPart::value, camera, kVoxelsWidth, kVoxelsHeight).mean,
                        expected.mean, 1e-6);
        });
    }
}

TEST_F(gpu_volumes, refuse_in_one_line) {
    const Volume volume = leaves_and_tiles(15, grid_maps()[0].second);
    const Camera camera = looking_at(box_of_leaves(volume), 2);
    const VoxelField field = random_field(volume, 1, 16), vector = random_field(volume, 3, 16);
    const ValueTransfer transfer = colors_of(295, 10, 1);
    EXPECT_EQ(refusal([&] {
                  GpuVolumes gpu({&volume, 1}, std::vector{field, field});
              }),
              "optix: 1 volumes and 2 fields, expected one for each");
    VoxelField other = field;
    other.component[0].leaf.pop_back();
    EXPECT_EQ(refusal([&] {
                  GpuVolumes gpu({&volume, 1}, {&other, 1});
              }),
              "optix: field 'field' has 26 leaves and 2 tiles, expected the volume's 27 and 2");
    GpuVolumes none({&volume, 1}), scalar({&volume, 1}, {&field, 1}),
        of_three({&volume, 1}, {&vector, 1});
    EXPECT_EQ(refusal([&] { (void)none.maximum(camera, 4, 4); }),
              "optix: volumes without a field, expected one for each");
    EXPECT_EQ(refusal([&] { (void)scalar.fields(FieldPart::x, camera, 4, 4); }),
              "optix: a field of 1 components, expected 3");
    EXPECT_EQ(refusal([&] { (void)of_three.volume(transfer, camera, 4, 4); }),
              "optix: a field of 3 components, expected 1");
    EXPECT_EQ(refusal([&] {
                  (void)scalar.depth(camera, 4, 4, {{}, 65});
              }),
              "65 x 65 rays a pixel, expected 1 to 64");
    Collective two;
    two.count = 2;
    EXPECT_EQ(refusal([&] {
                  (void)scalar.maximum(camera, 4, 4, {{}, 1, {}, &two});
              }),
              "optix: voxels of several processes, expected reference");
    Volume small;
    small.leaves.emplace_back().set(3, 1);
    const std::vector<Volume> many(33, small);
    const std::vector<VoxelField> of_many(33, own(small));
    GpuVolumes all(many, of_many);
    EXPECT_EQ(refusal([&] { (void)all.volume(transfer, camera, 4, 4); }),
              "optix: 33 volumes by value, expected at most 32");
    ValueTransfer invalid = transfer;
    invalid.opacity.clear();
    EXPECT_NE(refusal([&] { (void)scalar.volume(invalid, camera, 4, 4); }), "no error");
}

TEST_F(gpu_volumes, without_voxels_are_empty) {
    const Volume empty;
    const VoxelField field = own(empty);
    GpuVolumes gpu({&empty, 1}, {&field, 1});
    const Camera camera;
    EXPECT_EQ(gpu.depth(camera, 3, 2).depth, std::vector<float>(6));
    EXPECT_TRUE(std::isnan(gpu.maximum(camera, 3, 2).value[5]));
    EXPECT_TRUE(std::isnan(gpu.fields(FieldPart::value, camera, 3, 2).mean[0]));
    EXPECT_EQ(gpu.volume(colors_of(0, 1, 1), camera, 3, 2).pixel[3].a, 0);
}

}  // namespace vog::test
