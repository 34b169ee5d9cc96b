// cell_maps.cpp: sums over the pieces of rays, by Gauss's two points: density times the square of a value has the third degree.
#include "render/reference/cells/cell_maps.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/pixel_tiles.h"
#include "render/reference/fields/field_moments.h"
#include "render/reference/reference_grid.h"
#include "render/slice/slice_points.h"

namespace vog::reference {

namespace {

/// The shown part of a field at a point of a ray.
/// towards  of the ray, unit length
double shown(const CellPoint& point, FieldPart part, Vec3d towards) {
    const Vec3d value{point.value[0], point.value[1], point.value[2]};
    switch (part) {
        case FieldPart::view:
            return dot(value, towards);
        case FieldPart::y:
            return value.y;
        case FieldPart::z:
            return value.z;
        default:
            return value.x;
    }
}

/// Adds the pieces of a ray.
/// per_t  column of density 1 for each t
void add_pieces(const std::vector<CellPiece>& pieces, double per_t, FieldPart part, Vec3d towards,
                FirstRelative& to) {
    constexpr double kGauss = 0.28867513459481287;
    for (const CellPiece& piece : pieces)
        for (const double share : {0.5 - kGauss, 0.5 + kGauss}) {
            const CellPoint point = piece.at(share);
            const double extent = 0.5 * (piece.segment.last - piece.segment.first);
            // Densities of 0 have the field's value where nothing else has one.
            to.add(std::max(point.density, double{kLeastDensity}) * extent * per_t,
                   shown(point, part, towards));
        }
}

}  // namespace

FieldMaps render_cells_fields(const CellRays& rays, const CellValues& values, FieldPart part,
                              const Camera& camera, int width, int height,
                              const ReferenceOptions& options) {
    return of_part(part, options.progress, [&](FieldPart one, const Progress& progress) {
        ReferenceOptions own = options;
        own.progress = progress;
        return maps_of_rays(
            camera, width, height, own, [&](Vec3d origin, Vec3d direction, FirstRelative& to) {
                thread_local std::vector<CellPiece> pieces;
                pieces.clear();
                rays.add(origin, direction, visible_segment(options.clip, origin, direction),
                         pieces, &values);
                add_pieces(pieces, length(direction), one, normalized(direction), to);
            });
    });
}

ValueMap render_cells_maximum(const CellRays& rays, const CellValues& values, const Camera& camera,
                              int width, int height, const ReferenceOptions& options) {
    return maxima_of_rays(
        camera, width, height, options, [&](Vec3d origin, Vec3d direction, Segment within) {
            thread_local std::vector<CellPiece> pieces;
            pieces.clear();
            rays.add(origin, direction, within, pieces, &values);
            double most = -std::numeric_limits<double>::infinity();
            for (const CellPiece& piece : pieces)
                most = std::max({most, piece.first.value[0], piece.last.value[0]});
            return most;
        });
}

FieldMaps slice_cells(const CellRays& rays, const CellValues* values, FieldPart part,
                      const Camera& camera, int width, int height, const SliceOptions& options) {
    check_samples(options.samples);
    validate(options.clip);
    const CameraFrame frame = frame_of(camera, width, height);
    const slices::SlicePoints points(frame, options.plane, options.clip);
    const Vec3d across = normalized(options.plane.normal);
    // A short way behind the plane: faces of cells on it count in one of the two.
    const Segment behind{0, 1e-8 * rays.radius()};
    const int samples = options.samples;
    return of_part(part, options.progress, [&](FieldPart one, const Progress& progress) {
        FieldMaps maps = empty_maps(width, height);
        for_each_pixel(width, height, progress, [&](int column, int row) {
            check_interrupt();
            thread_local std::vector<CellPiece> pieces;
            FirstRelative pixel;
            for (int n = 0; n < samples * samples; ++n) {
                const double x = column + sample_offset(n % samples, samples);
                const double y = row + sample_offset(n / samples, samples);
                const auto point = points.at(x, y);
                if (!point) continue;
                pieces.clear();
                rays.add(*point, across, behind, pieces, values);
                add_pieces(pieces, 1 / behind.last, one, normalized(frame.direction(x, y)), pixel);
            }
            const auto at = static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                            static_cast<std::size_t>(column);
            set_pixel(maps, at, pixel.sums, pixel.sums.column / (samples * samples),
                      pixel.reference, 1);
        });
        return maps;
    });
}

}  // namespace vog::reference
