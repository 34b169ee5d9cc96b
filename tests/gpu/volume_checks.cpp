// volume_checks.cpp: Pictures of voxels by OptiX, with fields, by value, as maxima and with clips, against the CPU's
// reference, which this machine computes.
#ifdef VOG_OPTIX
#include <algorithm>
#include <cmath>
#include <vector>

#include "option_checks.h"
#include "render/gpu/voxels/gpu_volumes.h"
#include "render/reference/fields/field_grid.h"
#include "render/reference/fields/field_moments.h"
#include "support/random_volume.h"

namespace vog::test {

namespace {

constexpr int kWidth = 120, kHeight = 90;

/// Values about 300, of one component or three.
VoxelField random_field(const Volume& volume, std::size_t components) {
    Random random(5);
    VoxelField field;
    field.name = "heat";
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

DepthImage as_image(const std::vector<float>& values) {
    DepthImage image(kWidth, kHeight);
    image.depth = values;
    return image;
}
DepthImage channel(const VolumeImage& picture, float Rgba::*of) {
    DepthImage image(kWidth, kHeight);
    std::ranges::transform(picture.pixel, image.depth.begin(), of);
    return image;
}

/// Maps of a field by the reference's walk, one ray a pixel.
FieldMaps walked_maps(const Volume& volume, const VoxelField& field, FieldPart part,
                      const Camera& camera, const Clipping& clip) {
    const reference::FieldGrid grid(volume, field, part);
    const CameraFrame frame = frame_of(camera, kWidth, kHeight);
    FieldMaps maps = empty_maps(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const Vec3d origin = frame.origin(x, y), direction = frame.direction(x, y);
            const reference::Segment seen = reference::visible_segment(clip, origin, direction);
            reference::FirstRelative sums;
            grid.walk(origin, direction, seen, [&](const reference::FieldCell& cell) {
                sums.add(
                    cell.density * (cell.segment.last - cell.segment.first) * length(direction),
                    cell.value);
                return true;
            });
            set_pixel(maps, static_cast<std::size_t>(y * kWidth + x), sums.sums, sums.sums.column,
                      sums.reference, 1);
        }
    return maps;
}

/// Share of pixels whose values differ; a ray within a plane between voxels may be in either.
double other_share(const std::vector<float>& found, const std::vector<float>& expected) {
    std::size_t other = 0;
    for (std::size_t n = 0; n < found.size(); ++n) {
        const bool both = std::isnan(found[n]) == std::isnan(expected[n]);
        other += !both || std::abs(found[n] - expected[n]) > 1e-3;
    }
    return static_cast<double>(other) / static_cast<double>(found.size());
}

}  // namespace

int check_volumes() {
    std::vector<Volume> volumes{random_volume(1), random_volume(2)};
    for (std::size_t n = 0; n < 2; ++n) {
        volumes[n].tiles.resize(2);
        volumes[n].world_from_index = grid_maps()[n == 0 ? 5 : 3].second;
    }
    Volume leaves = volumes[0];
    leaves.tiles.clear();
    const Box box = world_box(leaves);
    Camera camera;
    camera.eye = box.center() + 2.5 * box.radius() * Vec3d{0.8, 0.43, 0.61};
    camera.look_at = box.center();
    const std::vector<VoxelField> fields{random_field(volumes[0], 1), random_field(volumes[1], 1)};
    const VoxelField vector = random_field(volumes[0], 3);
    ReferenceOptions options;
    options.clip.planes = {{{0.4, -0.3, 1}, dot(Vec3d{0.4, -0.3, 1}, box.center())}};
    const ValueTransfer transfer{"suite",
                                 {{295, 0, 0, 1}, {305, 1, 0.5, 0}},
                                 {{295, 0.02}, {298, 0.3}, {298, 0}, {305, 0.4}},
                                 0.2 * box.radius()};
    VolumeLook look;
    look.light = true;

    int failures = 0;
    const std::string name = "optix_volumes";
    const auto maps_of = [&](const VoxelField& field, FieldPart part, const std::string& what) {
        const FieldMaps expected = walked_maps(volumes[0], field, part, camera, options.clip);
        const FieldMaps maps = GpuVolumes({&volumes[0], 1}, {&field, 1})
                                   .fields(part, camera, kWidth, kHeight, options);
        failures += check(name, what + " column",
                          worst_of(as_image(expected.column), as_image(maps.column)), 1e-5);
        failures += check(name, what + " mean",
                          worst_of(as_image(expected.mean), as_image(maps.mean)), 1e-5);
        failures += check(name, what + " deviation",
                          worst_of(as_image(expected.deviation), as_image(maps.deviation)), 1e-4);
    };
    maps_of(fields[0], FieldPart::value, "scalar");
    maps_of(vector, FieldPart::view, "along the view");
    for (const std::size_t count : {std::size_t{1}, std::size_t{2}}) {
        const std::span<const Volume> some = std::span(volumes).first(count);
        const std::span<const VoxelField> of = std::span(fields).first(count);
        GpuVolumes gpu(some, of);
        const VolumeImage expected =
            render_volume_reference(some, of, transfer, camera, kWidth, kHeight, options, look);
        const VolumeImage found = gpu.volume(transfer, camera, kWidth, kHeight, options, look);
        for (const auto& [letter, of_pixel] :
             {std::pair{"r", &Rgba::r}, {"g", &Rgba::g}, {"b", &Rgba::b}, {"a", &Rgba::a}})
            failures +=
                check(name, std::to_string(count) + " by value " + letter,
                      worst_of(channel(expected, of_pixel), channel(found, of_pixel)), 1e-4);
        failures += check(
            name, std::to_string(count) + " maxima, share of pixels",
            other_share(gpu.maximum(camera, kWidth, kHeight, options).value,
                        render_maximum_reference(some, of, camera, kWidth, kHeight, options).value),
            0.01);
    }
    return failures;
}

}  // namespace vog::test
#endif
