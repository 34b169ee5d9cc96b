// volume_reference.cpp: Emission and absorption by value through the voxels themselves, exact for voxels of constant
// value, by steps between interpolated ones: Max, "Optical models for direct volume rendering", 1995, piece by piece.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "render/by_value/lighting.h"
#include "render/pixel_tiles.h"
#include "render/reference/fields/field_grid.h"
#include "render/reference/fields/linear_volume.h"
#include "shade/values/value_pieces.h"
#include "vog/error.h"
#include "vog/volume_picture.h"

namespace vog {

using namespace by_value;
using namespace reference;

namespace {

/// Light along a ray, front to back.
struct Compositor {
    // A ray ends at a ten-thousandth of a display step: less than the promised 1e-6.
    static constexpr double kOpaque = 1e-4 / 255;

    double r = 0, g = 0, b = 0, transmittance = 1;

    bool opaque() const { return transmittance < kOpaque; }
    /// Adds a piece of constant extinction and colour.
    /// depth  its extinction times its length
    void add(double depth, double red, double green, double blue) {
        const double passed = std::exp(-depth), weight = transmittance * (1 - passed);
        r += weight * red, g += weight * green, b += weight * blue;
        transmittance *= passed;
    }
};

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

    shading::ValuePieces pieces_;
    Lighting lighting_;
};

/// Piece of a ray in one of several volumes.
struct LitPiece {
    Segment segment;
    ValueLight light;
};

/// Composites the pieces of several volumes; where they overlap, extinctions add up.
/// stretch  world units of one t
void composite(std::vector<LitPiece>& pieces, double stretch, Compositor& to) {
    std::sort(pieces.begin(), pieces.end(), [](const LitPiece& a, const LitPiece& b) {
        return a.segment.first < b.segment.first;
    });
    thread_local std::vector<LitPiece> active;
    active.clear();
    double at = 0;
    for (std::size_t next = 0; (next < pieces.size() || !active.empty()) && !to.opaque();) {
        if (active.empty()) at = pieces[next].segment.first;
        while (next < pieces.size() && pieces[next].segment.first <= at)
            active.push_back(pieces[next++]);
        double until = next < pieces.size() ? pieces[next].segment.first
                                            : std::numeric_limits<double>::infinity();
        double extinction = 0, r = 0, g = 0, b = 0;
        for (const LitPiece& piece : active) {
            const ValueLight& light = piece.light;
            until = std::min(until, piece.segment.last);
            extinction += light.extinction;
            r += light.extinction * light.r, g += light.extinction * light.g;
            b += light.extinction * light.b;
        }
        to.add(extinction * (until - at) * stretch, r / extinction, g / extinction, b / extinction);
        at = until;
        std::erase_if(active, [&](const LitPiece& piece) { return piece.segment.last <= at; });
    }
}

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
                                    const VolumeLook& look, const VoxelGridOptions& voxels) {
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
    if (voxels.interpolation == Interpolation::constant)
        return drawn(field_grids(volumes, fields, FieldPart::value));
    if (volumes.size() != 1)
        throw Error(
            fmt::format("reference: {} volumes, interpolated, in a picture by value, expected one",
                        volumes.size()));
    return drawn(LinearVolume(volumes[0], fields[0], voxels));
}

}  // namespace vog
