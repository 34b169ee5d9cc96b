// field_reference.cpp: Maps of a field through the voxels themselves: constant in each voxel, or by grids of its
// moments, interpolated or of levels.
#include <algorithm>
#include <iterator>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "render/pixel_tiles.h"
#include "render/reference/fields/box_view.h"
#include "render/reference/fields/field_grid.h"
#include "render/reference/fields/field_moments.h"
#include "render/reference/fields/visible_parts.h"
#include "render/reference/parts/joint_pixels.h"
#include "render/reference/reference.h"
#include "render/shown_field.h"
#include "vog/error.h"

namespace vog {

using namespace reference;

namespace {

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

/// Maps of the voxels of several processes, a band of rows at a time.
/// draw  called with the first row of a band, its number of rows and its pixels, which receive this process's sums
template <class Draw>
FieldMaps joint_maps(const CameraFrame& frame, const ReferenceOptions& options,
                     const Collective& processes, const Draw& draw) {
    FieldMaps maps = empty_maps(frame.width, frame.height);
    constexpr int kMostPixels = 1 << 16;
    const auto width = static_cast<std::size_t>(frame.width);
    const int rows = std::max(kMostPixels / frame.width, BoxTile::kHeight);
    for_each_run(static_cast<std::size_t>(frame.height), static_cast<std::size_t>(rows),
                 options.progress, [&](std::size_t top, std::size_t height) {
                     std::vector<FirstRelative> pixels(height * width);
                     draw(static_cast<int>(top), static_cast<int>(height), std::span(pixels));
                     join(pixels, processes);
                     for (std::size_t n = 0; n < pixels.size(); ++n)
                         set_pixel(maps, top * width + n, pixels[n].sums,
                                   pixels[n].sums.column / (options.samples * options.samples),
                                   pixels[n].reference, 1);
                 });
    return maps;
}

/// Adds the voxels of a grid on a ray.
void add_part(const FieldGrid& grid, Vec3d origin, Vec3d direction, Segment seen,
              FirstRelative& to) {
    const double stretch = length(direction);
    grid.walk(origin, direction, seen, [&](const FieldCell& cell) {
        to.add(cell.density * (cell.segment.last - cell.segment.first) * stretch, cell.value);
        return true;
    });
}

void add_ray(const FieldGrid& grid, Vec3d origin, Vec3d direction, FirstRelative& to) {
    add_part(grid, origin, direction, {}, to);
}
FieldMaps maps_with_boxes(const DividedGrids<FieldGrid>& grids, const CameraFrame& frame,
                          const ReferenceOptions& options) {
    const auto place = [&](int column, int row) {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(frame.width) +
               static_cast<std::size_t>(column);
    };
    if (const Collective* processes = processes_of(options))
        return joint_maps(
            frame, options, *processes, [&](int top, int rows, std::span<FirstRelative> pixels) {
                grids.for_each_pixel(frame, top, rows, {}, add_ray,
                                     [&](int column, int row, const FirstRelative& pixel) {
                                         pixels[place(column, row - top)] = pixel;
                                     });
            });
    FieldMaps maps = empty_maps(frame.width, frame.height);
    grids.for_each_pixel(frame, 0, frame.height, options.progress, add_ray,
                         [&](int column, int row, const FirstRelative& pixel) {
                             set_pixel(maps, place(column, row), pixel.sums, pixel.sums.column,
                                       pixel.reference, 1);
                         });
    return maps;
}

}  // namespace

namespace reference {

FieldMaps maps_of_rays(const Camera& camera, int width, int height, const ReferenceOptions& options,
                       const AddRay& add) {
    check_samples(options.samples);
    validate(options.clip);
    const CameraFrame frame = frame_of(camera, width, height);
    const int samples = options.samples;
    const auto sums_of = [&](int column, int row) {
        check_interrupt();
        FirstRelative pixel;
        for (int y = 0; y < samples; ++y)
            for (int x = 0; x < samples; ++x) {
                const double at_x = column + sample_offset(x, samples);
                const double at_y = row + sample_offset(y, samples);
                add(frame.origin(at_x, at_y), frame.direction(at_x, at_y), pixel);
            }
        return pixel;
    };
    const auto place = [&](int column, int row) {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
               static_cast<std::size_t>(column);
    };
    if (const Collective* processes = processes_of(options))
        return joint_maps(frame, options, *processes,
                          [&](int top, int rows, std::span<FirstRelative> pixels) {
                              for_each_pixel(width, rows, {}, [&](int column, int row) {
                                  pixels[place(column, row)] = sums_of(column, top + row);
                              });
                          });
    FieldMaps maps = empty_maps(width, height);
    for_each_pixel(width, height, options.progress, [&](int column, int row) {
        const FirstRelative pixel = sums_of(column, row);
        set_pixel(maps, place(column, row), pixel.sums, pixel.sums.column / (samples * samples),
                  pixel.reference, 1);
    });
    return maps;
}

}  // namespace reference

FieldMaps render_field_reference(std::span<const Volume> volumes,
                                 std::span<const VoxelField> fields, FieldPart part,
                                 const Camera& camera, int width, int height,
                                 const ReferenceOptions& options, const VoxelGridOptions& voxels) {
    const auto of = [&](const Progress& progress) {
        return ReferenceOptions{progress, options.samples, options.clip, options.collective};
    };
    const auto constant = [&](FieldPart shown, const Progress& progress) {
        check_samples(options.samples);
        validate(options.clip);
        const std::vector<FieldGrid> grids = field_grids(volumes, fields, shown);
        const CameraFrame frame = frame_of(camera, width, height);
        const DividedGrids<FieldGrid> parts(grids, frame, options);
        if (!parts.boxes.empty()) return maps_with_boxes(parts, frame, of(progress));
        return maps_of_rays(camera, width, height, of(progress),
                            [&](Vec3d origin, Vec3d direction, FirstRelative& to) {
                                const Segment seen =
                                    visible_segment(options.clip, origin, direction);
                                for (const FieldGrid& grid : grids)
                                    add_part(grid, origin, direction, seen, to);
                            });
    };
    const auto linear = [&](FieldPart shown, const Progress& progress) {
        require_no_clip(options);
        const std::vector<VoxelField> valued = with_values(volumes, fields, shown);
        ComponentRanges ranges(shown);
        ranges.include(volumes, valued);
        const MomentUnits units = ranges.units(processes_of(options));
        std::vector<MomentGrids<VoxelGrid>> grids;
        for (std::size_t n = 0; n < volumes.size(); ++n)
            grids.push_back(moment_grids<VoxelGrid>(units, [&](int a, int b) {
                return voxel_grid(moment_volume(volumes[n], valued[n], units, a, b), voxels);
            }));
        return maps_of_rays(camera, width, height, of(progress),
                            [&](Vec3d origin, Vec3d direction, FirstRelative& to) {
                                for (const auto& grid : grids)
                                    to.add(grid.along(origin, normalized(direction)));
                            });
    };
    return voxels.interpolation == Interpolation::constant
               ? of_part(part, options.progress, constant)
               : of_part(part, options.progress, linear);
}

FieldMaps render_field_reference(std::span<const Levels* const> parts,
                                 std::span<const std::span<const VoxelField>> fields,
                                 FieldPart part, const Camera& camera, int width, int height,
                                 const ReferenceOptions& options, const VoxelGridOptions& voxels) {
    std::vector<std::vector<VoxelField>> valued;
    for (std::size_t n = 0; n < parts.size(); ++n)
        valued.push_back(with_values(parts[n]->volumes, fields[n], part));
    if (voxels.interpolation == Interpolation::constant) {
        std::optional<VisibleParts> all{std::in_place};
        for (std::size_t n = 0; n < parts.size() && all; ++n) {
            auto one = visible_parts(*parts[n], valued[n]);
            if (!one) {
                all.reset();
                break;
            }
            std::ranges::move(one->volumes, std::back_inserter(all->volumes));
            std::ranges::move(one->fields, std::back_inserter(all->fields));
        }
        double unfit = all ? 0 : 1;  // one way for all processes
        if (const Collective* processes = processes_of(options))
            processes->max(std::span(&unfit, 1));
        if (unfit == 0)
            return render_field_reference(all->volumes, all->fields, part, camera, width, height,
                                          options, voxels);
    }
    require_no_clip(options);
    return of_part(part, options.progress, [&](FieldPart shown, const Progress& progress) {
        ComponentRanges ranges(shown);
        for (std::size_t n = 0; n < parts.size(); ++n) ranges.include(parts[n]->volumes, valued[n]);
        const MomentUnits units = ranges.units(processes_of(options));
        std::vector<MomentGrids<LevelGrids>> grids;
        for (std::size_t n = 0; n < parts.size(); ++n) {
            grids.push_back(moment_grids<LevelGrids>(units, [&](int a, int b) {
                Levels moments{{}, parts[n]->masks};
                // Without masks the active voxels are the domain, which all moments share.
                for (std::size_t v = 0; v < valued[n].size(); ++v)
                    moments.volumes.push_back(
                        moment_volume(parts[n]->volumes[v], valued[n][v], units, a, b));
                return level_grids(moments, voxels);
            }));
        }
        return maps_of_rays(camera, width, height,
                            ReferenceOptions{progress, options.samples, {}, options.collective},
                            [&](Vec3d origin, Vec3d direction, FirstRelative& to) {
                                for (const auto& one : grids)
                                    to.add(one.along(origin, normalized(direction)));
                            });
    });
}

FieldMaps render_field_reference(const Levels& levels, std::span<const VoxelField> fields,
                                 FieldPart part, const Camera& camera, int width, int height,
                                 const ReferenceOptions& options, const VoxelGridOptions& voxels) {
    const Levels* const one = &levels;
    return render_field_reference(std::span(&one, 1), std::span(&fields, 1), part, camera, width,
                                  height, options, voxels);
}

}  // namespace vog
