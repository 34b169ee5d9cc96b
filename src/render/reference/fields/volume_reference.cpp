// volume_reference.cpp: Emission and absorption by value through the voxels themselves, exact for voxels of constant
// value, by steps between interpolated ones: Max, "Optical models for direct volume rendering", 1995, piece by piece.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "render/by_value/lighting.h"
#include "render/by_value/value_pieces.h"
#include "render/pixel_tiles.h"
#include "render/reference/fields/field_grid.h"
#include "render/reference/fields/linear_volume.h"
#include "render/reference/fields/ray_light.h"
#include "render/reference/parts/joint_pixels.h"
#include "render/reference/parts/ray_exchange.h"
#include "render/reference/reference.h"
#include "vog/error.h"
#include "vog/volume_picture.h"

namespace vog {

using namespace by_value;
using namespace reference;

namespace {

/// Light of a voxel: extinction per world unit and colour.
class VoxelLight {
  public:
    VoxelLight(const ValueTransfer& transfer, const VolumeLook& look)
        : pieces_(transfer), lighting_(look) {}
    /// towards_eye  unit length
    ValueLight operator()(const FieldGrid& grid, const FieldCell& cell, Vec3d towards_eye) const {
        return lit(cell.value, grid.own() ? 1 : cell.density, towards_eye,
                   [&] { return grid.gradient(cell); });
    }
    ValueLight operator()(const LinearVolume& grid, const LinearVolume::Sample& sample,
                          Vec3d towards_eye) const {
        return lit(sample.value, grid.own() ? 1 : sample.density, towards_eye,
                   [&] { return grid.world_gradient(sample); });
    }

  private:
    template <class Gradient>
    ValueLight lit(double value, double weight, Vec3d towards_eye, const Gradient& gradient) const {
        ValueLight light = pieces_(value);
        light.extinction *= weight;
        if (!lighting_.on() || !(light.extinction > 0)) return light;
        const auto [body, shine] = lighting_(gradient(), towards_eye);
        for (double* c : {&light.r, &light.g, &light.b}) *c = std::min(body * *c + shine, 1.0);
        return light;
    }

    ValuePieces pieces_;
    Lighting lighting_;
};

/// The light along one ray.
Compositor light_along(const std::vector<FieldGrid>& grids, const VoxelLight& lighting,
                       Vec3d origin, Vec3d direction, Segment within) {
    Compositor light;
    const double stretch = length(direction);
    const Vec3d towards_eye = (-1 / stretch) * direction;
    if (grids.size() == 1) {
        grids[0].walk(origin, direction, within, [&](const FieldCell& cell) {
            const ValueLight of_cell = lighting(grids[0], cell, towards_eye);
            const double depth =
                of_cell.extinction * (cell.segment.last - cell.segment.first) * stretch;
            if (depth > 0) light.add(depth, of_cell.r, of_cell.g, of_cell.b);
            return !light.opaque();
        });
        return light;
    }
    thread_local std::vector<LitPiece> pieces;
    pieces.clear();
    for (const FieldGrid& grid : grids)
        grid.walk(origin, direction, within, [&](const FieldCell& cell) {
            const ValueLight of_cell = lighting(grid, cell, towards_eye);
            if (of_cell.extinction > 0 && !cell.segment.empty())
                pieces.push_back({cell.segment, of_cell});
            return true;
        });
    composite(pieces, stretch, light);
    return light;
}

/// The light along one ray through interpolated voxels, classified sample by sample.
Compositor light_along(const LinearVolume& grid, const VoxelLight& lighting, Vec3d origin,
                       Vec3d direction, Segment within) {
    Compositor light;
    const double stretch = length(direction);
    const Vec3d towards_eye = (-1 / stretch) * direction;
    grid.walk(origin, direction, within, [&](const LinearVolume::Sample& sample, double dt) {
        const ValueLight here = lighting(grid, sample, towards_eye);
        if (const double depth = here.extinction * dt * stretch; depth > 0)
            light.add(depth, here.r, here.g, here.b);
        return !light.opaque();
    });
    return light;
}

Segment both(Segment a, Segment b) {
    return {std::max(a.first, b.first), std::min(a.last, b.last)};
}

/// This process's pieces of a ray.
std::vector<LitPiece> pieces_along(const std::vector<FieldGrid>& grids, const VoxelLight& lighting,
                                   Vec3d origin, Vec3d direction, Segment within, bool joined) {
    RayPieces pieces(joined);
    const double stretch = length(direction);
    const Vec3d towards_eye = (-1 / stretch) * direction;
    for (const FieldGrid& grid : grids) {
        pieces.begin();
        grid.walk(origin, direction, within, [&](const FieldCell& cell) {
            if (cell.segment.empty()) return true;
            const ValueLight light = lighting(grid, cell, towards_eye);
            const double span = cell.segment.last - cell.segment.first;
            return pieces.add(cell.segment, light.extinction * span * stretch, light);
        });
    }
    return pieces.finish();
}

/// The picture of several processes' voxels, complete on the root.
/// most_rays  at a time, of this process
/// pieces_of(origin, direction, within)  returns this process's pieces of a ray
template <class PiecesOf>
VolumeImage joint_picture(const Camera& camera, int width, int height,
                          const ReferenceOptions& options, const Clipping& clip,
                          const Collective& processes, std::size_t most_rays,
                          const PiecesOf& pieces_of) {
    const CameraFrame frame = frame_of(camera, width, height);
    VolumeImage image{width, height, {}};
    image.pixel.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    const int samples = options.samples;
    const auto rays_per_pixel = static_cast<std::size_t>(samples * samples);
    const auto trace = [&](std::size_t pixel, int ray) -> std::vector<LitPiece> {
        const int column = static_cast<int>(pixel) % width, row = static_cast<int>(pixel) / width;
        const double x = column + sample_offset(ray % samples, samples);
        const double y = row + sample_offset(ray / samples, samples);
        const Vec3d origin = frame.origin(x, y), direction = frame.direction(x, y);
        const Segment within = both(visible_segment(options.clip, origin, direction),
                                    visible_segment(clip, origin, direction));
        if (within.empty()) return {};
        return pieces_of(origin, direction, within);
    };
    for_each_run(image.pixel.size(), std::max<std::size_t>(most_rays / rays_per_pixel, 1),
                 options.progress, [&](std::size_t first, std::size_t count) {
                     std::vector<std::vector<LitPiece>> rays(count * rays_per_pixel);
                     vog::parallel_for(std::size_t{0}, rays.size(), [&](std::size_t n) {
                         rays[n] = trace(first + n / rays_per_pixel,
                                         static_cast<int>(n % rays_per_pixel));
                     });
                     std::ranges::copy(composite_parts(rays, rays_per_pixel, processes),
                                       image.pixel.begin() + static_cast<std::ptrdiff_t>(first));
                 });
    return image;
}

/// Averages rays over pixels.
/// light_of(origin, direction, within)  returns a Compositor
template <class LightOf>
VolumeImage picture_of(const Camera& camera, int width, int height, const ReferenceOptions& options,
                       const Clipping& clip, const LightOf& light_of) {
    const CameraFrame frame = frame_of(camera, width, height);
    VolumeImage image{width, height, {}};
    image.pixel.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    const int samples = options.samples;
    for_each_pixel(width, height, options.progress, [&](int column, int row) {
        check_interrupt();
        double r = 0, g = 0, b = 0, passed = 0;
        for (int n = 0; n < samples * samples; ++n) {
            const double x = column + sample_offset(n % samples, samples);
            const double y = row + sample_offset(n / samples, samples);
            const Vec3d origin = frame.origin(x, y), direction = frame.direction(x, y);
            const Segment within = both(visible_segment(options.clip, origin, direction),
                                        visible_segment(clip, origin, direction));
            if (within.empty()) {
                ++passed;
                continue;
            }
            const Compositor light = light_of(origin, direction, within);
            r += light.r, g += light.g, b += light.b, passed += light.transmittance;
        }
        const double share = 1.0 / (samples * samples);
        image.pixel[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                    static_cast<std::size_t>(column)] = {
            static_cast<float>(share * r), static_cast<float>(share * g),
            static_cast<float>(share * b), static_cast<float>(1 - share * passed)};
    });
    return image;
}

}  // namespace

VolumeImage render_volume_reference(std::span<const Volume> volumes,
                                    std::span<const VoxelField> fields,
                                    const ValueTransfer& transfer, const Camera& camera, int width,
                                    int height, const ReferenceOptions& options,
                                    const VolumeLook& look, const VoxelGridOptions& voxels,
                                    const OtherVoxels& others) {
    check_samples(options.samples);
    validate(options.clip);
    validate(look);
    const VoxelLight lighting(transfer, look);
    check_fields(volumes, fields, FieldPart::value);
    const auto drawn = [&](const auto& grid) {
        return picture_of(camera, width, height, options, look.clip,
                          [&](Vec3d origin, Vec3d direction, Segment within) {
                              return light_along(grid, lighting, origin, direction, within);
                          });
    };
    const Collective* processes = processes_of(options);
    if (processes && voxels.interpolation != Interpolation::constant)
        throw Error("reference: interpolated voxels of several processes, expected constant ones");
    if (processes) {
        std::vector<FieldGrid> grids = field_grids(volumes, fields, FieldPart::value);
        const std::vector<FieldGrid> beside =
            field_grids(others.beside, others.field, FieldPart::value);
        for (std::size_t n = 0; n < beside.size(); ++n)
            if (!others.beside[n].empty()) grids.at(n).set_beside(beside[n]);
        constexpr std::size_t kMostRays = std::size_t{1} << 15, kMostVoxelByVoxel = kMostRays / 4;
        return joint_picture(camera, width, height, options, look.clip, *processes,
                             others.overlap ? kMostVoxelByVoxel : kMostRays,
                             [&](Vec3d origin, Vec3d direction, Segment within) {
                                 return pieces_along(grids, lighting, origin, direction, within,
                                                     !others.overlap);
                             });
    }
    if (voxels.interpolation == Interpolation::constant)
        return drawn(field_grids(volumes, fields, FieldPart::value));
    if (volumes.size() != 1)
        throw Error(
            fmt::format("reference: {} volumes, interpolated, in a picture by value, expected one",
                        volumes.size()));
    return drawn(LinearVolume(volumes[0], fields[0], voxels));
}

}  // namespace vog
