// field_reference.cpp: Maps of a field through the voxels themselves, constant in each voxel.
#include "render/pixel_tiles.h"
#include "render/reference/fields/field_grid.h"
#include "render/shown_field.h"

namespace vog {

using namespace reference;

namespace {

/// Sums of a measure over one ray, or the rays of a pixel, with the field relative to its first value on
/// them: a field that hardly varies keeps its digits.
struct FirstRelative {
    RaySums sums{};
    double reference = 0;
    bool met = false;

    void add(double weight, double value) {
        if (!(weight > 0)) return;
        if (!met) reference = value, met = true;
        const double difference = value - reference;
        sums.column += weight;
        sums.first += weight * difference;
        sums.second += weight * difference * difference;
    }
};

}  // namespace

FieldMaps render_field_reference(std::span<const Volume> volumes,
                                 std::span<const VoxelField> fields, FieldPart part,
                                 const Camera& camera, int width, int height,
                                 const ReferenceOptions& options) {
    check_samples(options.samples);
    validate(options.clip);
    const std::vector<FieldGrid> grids = field_grids(volumes, fields, part);
    const CameraFrame frame = frame_of(camera, width, height);
    FieldMaps maps = empty_maps(width, height);
    const int samples = options.samples;
    for_each_pixel(width, height, options.progress, [&](int column, int row) {
        check_interrupt();
        FirstRelative pixel;
        for (int y = 0; y < samples; ++y)
            for (int x = 0; x < samples; ++x) {
                const double at_x = column + sample_offset(x, samples);
                const double at_y = row + sample_offset(y, samples);
                const Vec3d origin = frame.origin(at_x, at_y);
                const Vec3d direction = frame.direction(at_x, at_y);
                const double stretch = length(direction);
                for (const FieldGrid& grid : grids)
                    grid.walk(origin, direction, visible_segment(options.clip, origin, direction),
                              [&](const FieldCell& cell) {
                                  const Segment& part_of_ray = cell.segment;
                                  pixel.add(cell.density * (part_of_ray.last - part_of_ray.first) *
                                                stretch,
                                            cell.value);
                                  return true;
                              });
            }
        const std::size_t n = static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                              static_cast<std::size_t>(column);
        set_pixel(maps, n, pixel.sums, pixel.sums.column / (samples * samples), pixel.reference, 1);
    });
    return maps;
}

}  // namespace vog
