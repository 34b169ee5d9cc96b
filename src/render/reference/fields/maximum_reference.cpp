// maximum_reference.cpp: Maximum intensity projection of the voxels themselves.
#include <algorithm>
#include <limits>

#include "render/pixel_tiles.h"
#include "render/reference/fields/field_grid.h"
#include "render/reference/fields/field_moments.h"
#include "render/reference/parts/joint_pixels.h"
#include "render/reference/reference.h"

namespace vog {

using namespace reference;

namespace {

/// Value of a ray that meets no voxel.
constexpr double kNoVoxel = -std::numeric_limits<double>::infinity();

/// Largest values along the rays of a picture.
class LargestValues {
  public:
    LargestValues(const LargestOnRay& largest, const CameraFrame& frame,
                  const ReferenceOptions& options)
        : largest_(largest), frame_(frame), options_(options) {}

    int rays_per_pixel() const { return options_.samples * options_.samples; }
    double along(int column, int row, int ray) const {
        const int samples = options_.samples;
        const double x = column + sample_offset(ray % samples, samples);
        const double y = row + sample_offset(ray / samples, samples);
        const Vec3d origin = frame_.origin(x, y), direction = frame_.direction(x, y);
        const Segment within = visible_segment(options_.clip, origin, direction);
        return within.empty() ? kNoVoxel : largest_(origin, direction, within);
    }
    /// Value of a pixel.
    /// value(ray)  largest value on one of its rays
    template <class Value>
    float mean(const Value& value) const {
        double sum = 0;
        int met = 0;
        for (int n = 0; n < rays_per_pixel(); ++n)
            if (const double largest = value(n); largest > kNoVoxel) sum += largest, ++met;
        return met > 0 ? static_cast<float>(sum / met) : std::numeric_limits<float>::quiet_NaN();
    }

  private:
    const LargestOnRay& largest_;
    const CameraFrame& frame_;
    const ReferenceOptions& options_;
};

/// The map of several processes' voxels, complete on each.
void draw_joint(const LargestValues& values, const Collective& processes, const Progress& progress,
                ValueMap& map) {
    constexpr std::size_t kMostRays = std::size_t{1} << 17;  // 1 MB
    const auto rays = static_cast<std::size_t>(values.rays_per_pixel());
    for_each_run(map.value.size(), std::max<std::size_t>(kMostRays / rays, 1), progress,
                 [&](std::size_t first, std::size_t count) {
                     std::vector<double> largest(count * rays);
                     vog::parallel_for(std::size_t{0}, largest.size(), [&](std::size_t n) {
                         const auto pixel = static_cast<int>(first + n / rays);
                         largest[n] = values.along(pixel % map.width, pixel / map.width,
                                                   static_cast<int>(n % rays));
                     });
                     processes.max(largest);
                     for (std::size_t n = 0; n < count; ++n)
                         map.value[first + n] = values.mean([&](int ray) {
                             return largest[n * rays + static_cast<std::size_t>(ray)];
                         });
                 });
}

}  // namespace

ValueMap reference::maxima_of_rays(const Camera& camera, int width, int height,
                                   const ReferenceOptions& options, const LargestOnRay& largest) {
    check_samples(options.samples);
    validate(options.clip);
    const CameraFrame frame = frame_of(camera, width, height);
    const LargestValues values(largest, frame, options);
    ValueMap map{width, height, {}};
    map.value.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    if (const Collective* processes = processes_of(options)) {
        draw_joint(values, *processes, options.progress, map);
        return map;
    }
    for_each_pixel(width, height, options.progress, [&](int column, int row) {
        check_interrupt();
        map.value[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(column)] =
            values.mean([&](int ray) { return values.along(column, row, ray); });
    });
    return map;
}

ValueMap render_maximum_reference(std::span<const Volume> volumes,
                                  std::span<const VoxelField> fields, const Camera& camera,
                                  int width, int height, const ReferenceOptions& options) {
    check_samples(options.samples);
    const std::vector<FieldGrid> grids = field_grids(volumes, fields, FieldPart::value);
    const auto largest = [&](Vec3d origin, Vec3d direction, Segment within) {
        double most = kNoVoxel;
        for (const FieldGrid& grid : grids)
            grid.walk(origin, direction, within, [&](const FieldCell& cell) {
                if (!cell.segment.empty()) most = std::max(most, cell.value);
                return true;
            });
        return most;
    };
    return maxima_of_rays(camera, width, height, options, largest);
}

}  // namespace vog
