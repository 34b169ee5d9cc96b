// volume_reference.cpp: Emission and absorption by value through the voxels themselves, exact for voxels of constant
// value, by steps between interpolated ones: Max, "Optical models for direct volume rendering", 1995, piece by piece.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "render/light/illumination.h"
#include "render/pixel_tiles.h"
#include "render/reference/fields/field_grid.h"
#include "render/reference/fields/linear_volume.h"
#include "render/reference/fields/ray_light.h"
#include "render/reference/parts/joint_pixels.h"
#include "render/reference/parts/ray_exchange.h"
#include "render/reference/reference.h"
#include "vog/error.h"
#include "vog/volume_picture.h"

namespace vog::reference {

using namespace by_value;

namespace {

/// Light of a voxel: extinction per world unit and colour.
class VoxelLight : public FieldLight {
  public:
    using FieldLight::FieldLight;
    /// Calls visit(segment, light) for pieces of a voxel's part of a ray, of one light each, as long as it returns true.
    template <class Visit>
    bool operator()(const FieldGrid& grid, const FieldCell& cell, const WorldRay& ray,
                    const Visit& visit) const {
        return each_piece(
            cell.segment, cell.value, grid.own() ? 1 : cell.density, ray,
            [&] { return grid.gradient(cell); }, visit);
    }
    ValueLight operator()(const LinearVolume& grid, const LinearVolume::Sample& sample,
                          const WorldRay& ray, double t) const {
        return lit(sample.value, grid.own() ? 1 : sample.density, ray, t,
                   [&] { return sample.gradient(); });
    }
};

/// Appends the pieces of a ray.
void add_pieces(const std::vector<FieldGrid>& grids, const VoxelLight& lighting,
                const WorldRay& ray, Segment within, std::vector<LitPiece>& pieces) {
    for (const FieldGrid& grid : grids)
        grid.walk(ray.origin, ray.direction, within, [&](const FieldCell& cell) {
            return lighting(grid, cell, ray, [&](Segment part, const ValueLight& of_part) {
                if (of_part.extinction > 0 && !part.empty()) pieces.push_back({part, of_part});
                return true;
            });
        });
}
void add_pieces(const LinearVolume& grid, const VoxelLight& lighting, const WorldRay& ray,
                Segment within, std::vector<LitPiece>& pieces) {
    grid.walk(ray.origin, ray.direction, within,
              [&](const LinearVolume::Sample& sample, double t, double dt) {
                  const ValueLight here = lighting(grid, sample, ray, t);
                  const Segment part{t - 0.5 * dt, t + 0.5 * dt};
                  if (here.extinction > 0 && !part.empty()) pieces.push_back({part, here});
                  return true;
              });
}

/// Adds the light along one ray under each of several transfer functions.
/// light  [lighting]
void add_light(const std::vector<FieldGrid>& grids, std::span<const VoxelLight> lighting,
               const WorldRay& ray, Segment within, std::span<Compositor> light) {
    if (grids.size() == 1) {
        grids[0].walk(ray.origin, ray.direction, within, [&](const FieldCell& cell) {
            bool goes_on = false;
            for (std::size_t n = 0; n < light.size(); ++n)
                goes_on |=
                    !light[n].opaque() &&
                    lighting[n](grids[0], cell, ray, [&](Segment part, const ValueLight& of) {
                        const double span = part.last - part.first;
                        const double depth = of.extinction * span * ray.stretch;
                        if (depth > 0) light[n].add(depth, of.r, of.g, of.b);
                        return !light[n].opaque();
                    });
            return goes_on;
        });
        return;
    }
    thread_local std::vector<LitPiece> pieces;
    for (std::size_t n = 0; n < light.size(); ++n) {
        pieces.clear();
        add_pieces(grids, lighting[n], ray, within, pieces);
        composite(pieces, ray.stretch, light[n]);
    }
}

/// The same through interpolated voxels, classified sample by sample.
void add_light(const LinearVolume& grid, std::span<const VoxelLight> lighting, const WorldRay& ray,
               Segment within, std::span<Compositor> light) {
    grid.walk(ray.origin, ray.direction, within,
              [&](const LinearVolume::Sample& sample, double t, double dt) {
                  bool goes_on = false;
                  for (std::size_t n = 0; n < light.size(); ++n) {
                      const ValueLight here = lighting[n](grid, sample, ray, t);
                      if (const double depth = here.extinction * dt * ray.stretch; depth > 0)
                          light[n].add(depth, here.r, here.g, here.b);
                      goes_on |= !light[n].opaque();
                  }
                  return goes_on;
              });
}

Segment both(Segment a, Segment b) {
    return {std::max(a.first, b.first), std::min(a.last, b.last)};
}

/// This process's pieces of a ray.
std::vector<LitPiece> pieces_along(const std::vector<FieldGrid>& grids, const VoxelLight& lighting,
                                   const WorldRay& ray, Segment within, bool joined) {
    RayPieces pieces(joined);
    for (const FieldGrid& grid : grids) {
        pieces.begin();
        grid.walk(ray.origin, ray.direction, within, [&](const FieldCell& cell) {
            if (cell.segment.empty()) return true;
            return lighting(grid, cell, ray, [&](Segment part, const ValueLight& light) {
                const double span = part.last - part.first;
                return pieces.add(part, light.extinction * span * ray.stretch, light);
            });
        });
    }
    return pieces.finish();
}

/// The picture of several processes' voxels, complete on the root.
/// most_rays  at a time, of this process
/// pieces_of(ray, within)  returns this process's pieces of a ray
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
        return pieces_of(WorldRay(origin, direction), within);
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

/// throws  vog::Error unless there is one volume, as interpolation needs
const Volume& one_of(std::span<const Volume> volumes) {
    if (volumes.size() == 1) return volumes[0];
    throw Error(
        fmt::format("reference: {} volumes, interpolated, in a picture by value, expected one",
                    volumes.size()));
}

/// Averages rays over the pixels of several pictures.
/// add_light(ray, within, light)  adds that along a ray to a Compositor of each picture
template <class AddLight>
std::vector<VolumeImage> pictures_of(std::size_t count, const Camera& camera, int width, int height,
                                     const ReferenceOptions& options, const Clipping& clip,
                                     const AddLight& add_light) {
    const CameraFrame frame = frame_of(camera, width, height);
    std::vector<VolumeImage> images(count, {width, height, {}});
    for (VolumeImage& image : images)
        image.pixel.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    const int samples = options.samples;
    for_each_pixel(width, height, options.progress, [&](int column, int row) {
        if (options.fifth && !is_fifth(column, row)) return;
        check_interrupt();
        thread_local std::vector<Compositor> light, sum;
        sum.assign(count, {0, 0, 0, 0});
        for (int n = 0; n < samples * samples; ++n) {
            const double x = column + sample_offset(n % samples, samples);
            const double y = row + sample_offset(n / samples, samples);
            const Vec3d origin = frame.origin(x, y), direction = frame.direction(x, y);
            const Segment within = both(visible_segment(options.clip, origin, direction),
                                        visible_segment(clip, origin, direction));
            light.assign(count, {});
            if (!within.empty()) add_light(WorldRay(origin, direction), within, std::span(light));
            for (std::size_t k = 0; k < count; ++k) {
                sum[k].r += light[k].r, sum[k].g += light[k].g, sum[k].b += light[k].b;
                sum[k].transmittance += light[k].transmittance;
            }
        }
        const double share = 1.0 / (samples * samples);
        const std::size_t pixel = static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                                  static_cast<std::size_t>(column);
        for (std::size_t k = 0; k < count; ++k)
            images[k].pixel[pixel] = {static_cast<float>(share * sum[k].r),
                                      static_cast<float>(share * sum[k].g),
                                      static_cast<float>(share * sum[k].b),
                                      static_cast<float>(1 - share * sum[k].transmittance)};
    });
    return images;
}

/// Grids of a field, with the voxels of other processes beside them.
void set_grids(std::span<const Volume> volumes, std::span<const VoxelField> fields,
               const OtherVoxels& others, std::vector<FieldGrid>& grids,
               std::vector<FieldGrid>& beside) {
    grids = field_grids(volumes, fields, FieldPart::value);
    beside = field_grids(others.beside, others.field, FieldPart::value);
    for (std::size_t n = 0; n < beside.size(); ++n)
        if (!others.beside[n].empty()) grids.at(n).set_beside(beside[n]);
}

/// Rays of several processes at a time, each with runs of pieces, or with all pieces.
constexpr std::size_t kMostRays = std::size_t{1} << 15, kMostVoxelByVoxel = kMostRays / 4;

}  // namespace

struct VoxelRays::State {
    VoxelLight lighting;
    std::vector<FieldGrid> grids;        ///< of constant voxels
    std::vector<FieldGrid> beside;       ///< next to them, of other processes
    std::optional<LinearVolume> linear;  ///< of interpolated ones
};

VoxelRays::VoxelRays(std::span<const Volume> volumes, std::span<const VoxelField> fields,
                     const ValueTransfer& transfer, const VolumeLook& look,
                     const lights::Illumination& reached, const VoxelGridOptions& voxels,
                     const OtherVoxels& others) {
    check_fields(volumes, fields, FieldPart::value);
    state_ = std::make_unique<State>(State{VoxelLight(transfer, look, reached), {}, {}, {}});
    if (voxels.interpolation == Interpolation::constant)
        set_grids(volumes, fields, others, state_->grids, state_->beside);
    else
        state_->linear.emplace(one_of(volumes), fields.front(), voxels);
}
VoxelRays::~VoxelRays() = default;

void VoxelRays::add(Vec3d origin, Vec3d direction, Segment& within,
                    std::vector<LitPiece>& pieces) const {
    const WorldRay ray(origin, direction);
    state_->linear ? add_pieces(*state_->linear, state_->lighting, ray, within, pieces)
                   : add_pieces(state_->grids, state_->lighting, ray, within, pieces);
}

VolumeImage render_layers_reference(std::span<const std::unique_ptr<LitRays>> layers,
                                    const Camera& camera, int width, int height,
                                    const ReferenceOptions& options, const VolumeLook& look) {
    const auto add = [&](const WorldRay& ray, Segment within, std::vector<LitPiece>& pieces) {
        for (const std::unique_ptr<LitRays>& layer : layers)
            layer->add(ray.origin, ray.direction, within, pieces);
    };
    if (const Collective* processes = processes_of(options))
        return joint_picture(camera, width, height, options, look.clip, *processes,
                             kMostVoxelByVoxel, [&](const WorldRay& ray, Segment within) {
                                 std::vector<LitPiece> pieces;
                                 add(ray, within, pieces);
                                 for (LitPiece& piece : pieces)
                                     piece.light.extinction *= ray.stretch;
                                 return pieces;
                             });
    return std::move(
        pictures_of(1, camera, width, height, options, look.clip,
                    [&](const WorldRay& ray, Segment within, std::span<Compositor> light) {
                        thread_local std::vector<LitPiece> pieces;
                        pieces.clear();
                        add(ray, within, pieces);
                        composite(pieces, ray.stretch, light.front());
                    })
            .front());
}

}  // namespace vog::reference

namespace vog {

using namespace reference;

VolumeImage render_volume_reference(std::span<const Volume> volumes,
                                    std::span<const VoxelField> fields,
                                    const ValueTransfer& transfer, const Camera& camera, int width,
                                    int height, const ReferenceOptions& options,
                                    const VolumeLook& look, const VoxelGridOptions& voxels,
                                    const OtherVoxels& others) {
    check_samples(options.samples);
    validate(options.clip);
    validate(look);
    check_fields(volumes, fields, FieldPart::value);
    const Collective* processes = processes_of(options);
    const Vec3d forward = frame_of(camera, width, height).forward;
    const lights::Illumination reached =
        lights::illumination(volumes, fields, transfer, look, forward, processes);
    const VoxelLight lighting(transfer, look, reached);
    const auto drawn = [&](const auto& grid) {
        return std::move(
            pictures_of(1, camera, width, height, options, look.clip,
                        [&](const WorldRay& ray, Segment within, std::span<Compositor> light) {
                            add_light(grid, {&lighting, 1}, ray, within, light);
                        })
                .front());
    };
    if (processes && voxels.interpolation != Interpolation::constant)
        throw Error("reference: interpolated voxels of several processes, expected constant ones");
    if (processes) {
        std::vector<FieldGrid> grids, beside;
        set_grids(volumes, fields, others, grids, beside);
        return joint_picture(camera, width, height, options, look.clip, *processes,
                             others.overlap ? kMostVoxelByVoxel : kMostRays,
                             [&](const WorldRay& ray, Segment within) {
                                 return pieces_along(grids, lighting, ray, within, !others.overlap);
                             });
    }
    if (voxels.interpolation == Interpolation::constant)
        return drawn(field_grids(volumes, fields, FieldPart::value));
    return drawn(LinearVolume(one_of(volumes), fields[0], voxels));
}

std::vector<std::vector<VolumeImage>> render_volume_references(
    std::span<const Volume> volumes, std::span<const VoxelField> fields,
    std::span<const ValueTransfer> transfers, std::span<const Camera> cameras, int width,
    int height, const ReferenceOptions& options) {
    check_fields(volumes, fields, FieldPart::value);
    const std::vector<FieldGrid> grids = field_grids(volumes, fields, FieldPart::value);
    const lights::Illumination everywhere;
    std::vector<VoxelLight> lighting;
    for (const ValueTransfer& transfer : transfers)
        lighting.emplace_back(transfer, VolumeLook{}, everywhere);
    std::vector<std::vector<VolumeImage>> images;
    for (const Camera& camera : cameras)
        images.push_back(
            pictures_of(transfers.size(), camera, width, height, options, {},
                        [&](const WorldRay& ray, Segment within, std::span<Compositor> light) {
                            add_light(grids, lighting, ray, within, light);
                        }));
    return images;
}

}  // namespace vog
