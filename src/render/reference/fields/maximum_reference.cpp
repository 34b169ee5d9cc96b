// maximum_reference.cpp: Maximum intensity projection of the voxels themselves.
#include <algorithm>
#include <limits>

#include "render/pixel_tiles.h"
#include "render/reference/fields/field_grid.h"
#include "vog/maximum_picture.h"

namespace vog {

using namespace reference;

ValueMap render_maximum_reference(std::span<const Volume> volumes,
                                  std::span<const VoxelField> fields, const Camera& camera,
                                  int width, int height, const ReferenceOptions& options) {
    check_samples(options.samples);
    validate(options.clip);
    const std::vector<FieldGrid> grids = field_grids(volumes, fields, FieldPart::value);
    const CameraFrame frame = frame_of(camera, width, height);
    constexpr double kNothing = -std::numeric_limits<double>::infinity();
    ValueMap map{width, height, {}};
    map.value.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                     std::numeric_limits<float>::quiet_NaN());
    const int samples = options.samples;
    for_each_pixel(width, height, options.progress, [&](int column, int row) {
        check_interrupt();
        double sum = 0;
        int met = 0;
        for (int n = 0; n < samples * samples; ++n) {
            const double x = column + sample_offset(n % samples, samples);
            const double y = row + sample_offset(n / samples, samples);
            const Vec3d origin = frame.origin(x, y), direction = frame.direction(x, y);
            const Segment within = visible_segment(options.clip, origin, direction);
            if (within.empty()) continue;
            double largest = kNothing;
            for (const FieldGrid& grid : grids)
                grid.walk(origin, direction, within, [&](const FieldCell& cell) {
                    if (!cell.segment.empty()) largest = std::max(largest, cell.value);
                    return true;
                });
            if (largest > kNothing) sum += largest, ++met;
        }
        if (met > 0)
            map.value[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(column)] = static_cast<float>(sum / met);
    });
    return map;
}

}  // namespace vog
