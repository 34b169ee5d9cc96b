// field_reference.cpp: Maps of a field through the voxels themselves: constant in each voxel, or by grids of its
// moments, interpolated or of levels.
#include <algorithm>
#include <memory>
#include <vector>

#include "render/pixel_tiles.h"
#include "render/reference/fields/box_view.h"
#include "render/reference/fields/field_grid.h"
#include "render/reference/fields/field_moments.h"
#include "render/reference/fields/visible_parts.h"
#include "render/shown_field.h"
#include "vog/error.h"

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
    /// Adds a whole ray.
    void add(const RayMoments& ray) {
        if (!(ray.sums.column > 0)) return;
        if (!met) reference = ray.reference, met = true;
        const double shift = ray.reference - reference;
        sums.column += ray.sums.column;
        sums.first += ray.sums.first + shift * ray.sums.column;
        sums.second +=
            ray.sums.second + 2 * shift * ray.sums.first + shift * shift * ray.sums.column;
    }
};

/// Fields with values, for grids of moments.
/// throws vog::Error as check_fields does
std::vector<VoxelField> with_values(std::span<const Volume> volumes,
                                    std::span<const VoxelField> fields, FieldPart part) {
    check_fields(volumes, fields, part);
    std::vector<VoxelField> all(fields.begin(), fields.end());
    for (std::size_t n = 0; n < all.size(); ++n)
        if (is_own(all[n])) all[n] = own_field(volumes[n], all[n].name);
    return all;
}
void require_no_clip(const ReferenceOptions& options) {
    if (!options.clip.empty())
        throw Error(
            "reference: a clip of interpolated voxels or levels with a field, expected voxels of "
            "constant value");
}

/// Sums over the rays of every pixel.
/// add  called with a ray and the sums that receive it
template <class Add>
FieldMaps maps_of(const Camera& camera, int width, int height, const ReferenceOptions& options,
                  const Add& add) {
    check_samples(options.samples);
    validate(options.clip);
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
                add(frame.origin(at_x, at_y), frame.direction(at_x, at_y), pixel);
            }
        const std::size_t n = static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                              static_cast<std::size_t>(column);
        set_pixel(maps, n, pixel.sums, pixel.sums.column / (samples * samples), pixel.reference, 1);
    });
    return maps;
}

/// Adds the voxels of a grid on a ray.
void add_ray(const FieldGrid& grid, Vec3d origin, Vec3d direction, Segment seen,
             FirstRelative& to) {
    const double stretch = length(direction);
    grid.walk(origin, direction, seen, [&](const FieldCell& cell) {
        to.add(cell.density * (cell.segment.last - cell.segment.first) * stretch, cell.value);
        return true;
    });
}

/// Grids of a picture by the way that their voxels are added.
struct DividedGrids {
    std::vector<BoxView> boxes;
    std::vector<const FieldGrid*> rays;
};
DividedGrids divided(const std::vector<FieldGrid>& grids, const CameraFrame& frame,
                     const ReferenceOptions& options) {
    DividedGrids all;
    for (const FieldGrid& grid : grids) {
        if (frame.orthographic && options.samples == 1 && options.clip.empty()) {
            const BoxView view(grid, frame);
            if (view.faster_than_rays()) {
                all.boxes.push_back(view);
                continue;
            }
        }
        all.rays.push_back(&grid);
    }
    return all;
}

/// Sums over one ray a pixel, with boxes in some grids.
FieldMaps maps_with_boxes(const DividedGrids& grids, const CameraFrame& frame,
                          const Progress& progress) {
    FieldMaps maps = empty_maps(frame.width, frame.height);
    const auto draw = [&](int left, int top) {
        const auto tile = std::make_unique<BoxTile>();
        for (const BoxView& boxes : grids.boxes) boxes.add_to(*tile, left, top);
        const int width = std::min(BoxTile::kWidth, frame.width - left);
        const int height = std::min(BoxTile::kHeight, frame.height - top);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                check_interrupt();
                const double column = tile->column[y][x];
                FirstRelative pixel{{column, tile->first[y][x], tile->second[y][x]},
                                    tile->reference[y][x],
                                    column > 0};
                for (const FieldGrid* grid : grids.rays)
                    add_ray(*grid, frame.origin(left + x, top + y),
                            frame.direction(left + x, top + y), {}, pixel);
                const auto n =
                    static_cast<std::size_t>(top + y) * static_cast<std::size_t>(frame.width) +
                    static_cast<std::size_t>(left + x);
                set_pixel(maps, n, pixel.sums, pixel.sums.column, pixel.reference, 1);
            }
        return true;
    };
    for_each_tile({frame.width, frame.height, BoxTile::kWidth, BoxTile::kHeight}, progress, draw,
                  [](bool) {});
    return maps;
}

/// Calls maps(part, progress) for the part, or for each component of a magnitude.
template <class Maps>
FieldMaps of_part(FieldPart part, const Progress& progress, const Maps& maps) {
    return part == FieldPart::magnitude ? magnitude_maps(progress, maps) : maps(part, progress);
}

}  // namespace

FieldMaps render_field_reference(std::span<const Volume> volumes,
                                 std::span<const VoxelField> fields, FieldPart part,
                                 const Camera& camera, int width, int height,
                                 const ReferenceOptions& options, const VoxelGridOptions& voxels) {
    const auto of = [&](const Progress& progress) {
        return ReferenceOptions{progress, options.samples, options.clip};
    };
    const auto constant = [&](FieldPart shown, const Progress& progress) {
        check_samples(options.samples);
        validate(options.clip);
        const std::vector<FieldGrid> grids = field_grids(volumes, fields, shown);
        const CameraFrame frame = frame_of(camera, width, height);
        const DividedGrids parts = divided(grids, frame, options);
        if (!parts.boxes.empty()) return maps_with_boxes(parts, frame, progress);
        return maps_of(camera, width, height, of(progress),
                       [&](Vec3d origin, Vec3d direction, FirstRelative& to) {
                           const Segment seen = visible_segment(options.clip, origin, direction);
                           for (const FieldGrid& grid : grids)
                               add_ray(grid, origin, direction, seen, to);
                       });
    };
    const auto linear = [&](FieldPart shown, const Progress& progress) {
        require_no_clip(options);
        const std::vector<VoxelField> valued = with_values(volumes, fields, shown);
        const MomentUnits units = moment_units(volumes, valued, shown);
        std::vector<MomentGrids<VoxelGrid>> grids;
        for (std::size_t n = 0; n < volumes.size(); ++n)
            grids.push_back(moment_grids<VoxelGrid>(units, [&](int a, int b) {
                return voxel_grid(moment_volume(volumes[n], valued[n], units, a, b), voxels);
            }));
        return maps_of(camera, width, height, of(progress),
                       [&](Vec3d origin, Vec3d direction, FirstRelative& to) {
                           for (const auto& grid : grids)
                               to.add(grid.along(origin, normalized(direction)));
                       });
    };
    return voxels.interpolation == Interpolation::constant
               ? of_part(part, options.progress, constant)
               : of_part(part, options.progress, linear);
}

FieldMaps render_field_reference(const Levels& levels, std::span<const VoxelField> fields,
                                 FieldPart part, const Camera& camera, int width, int height,
                                 const ReferenceOptions& options, const VoxelGridOptions& voxels) {
    const std::vector<VoxelField> valued = with_values(levels.volumes, fields, part);
    if (voxels.interpolation == Interpolation::constant)
        if (const auto parts = visible_parts(levels, valued))
            return render_field_reference(parts->volumes, parts->fields, part, camera, width,
                                          height, options, voxels);
    require_no_clip(options);
    return of_part(part, options.progress, [&](FieldPart shown, const Progress& progress) {
        const MomentUnits units = moment_units(levels.volumes, valued, shown);
        const auto grids = moment_grids<LevelGrids>(units, [&](int a, int b) {
            Levels moments{{}, levels.masks};
            // Without masks the active voxels are the domain, which all moments share.
            for (std::size_t n = 0; n < valued.size(); ++n)
                moments.volumes.push_back(moment_volume(levels.volumes[n], valued[n], units, a, b));
            return level_grids(moments, voxels);
        });
        return maps_of(camera, width, height, ReferenceOptions{progress, options.samples, {}},
                       [&](Vec3d origin, Vec3d direction, FirstRelative& to) {
                           to.add(grids.along(origin, normalized(direction)));
                       });
    });
}

}  // namespace vog
