// field_moments.h: Sums of a field along rays, and measures of its moments, each a grid of its own, with every rule of the
// reference, interpolation, levels and masks.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "render/reference/hierarchical_dda.h"
#include "render/reference/reference.h"
#include "render/shown_field.h"
#include "vog/distributed.h"

namespace vog::reference {

/// Components of a field in units of their own range over all volumes: u = (value - lower) / unit, [0, 1].
struct MomentUnits {
    std::vector<int> component;  ///< of the field: one, or the three of a component along rays
    Vec3d lower, unit{1, 1, 1};  ///< [components]
};

/// Least and largest components of a field, for these units.
class ComponentRanges {
  public:
    explicit ComponentRanges(FieldPart part);
    void include(std::span<const Volume> volumes, std::span<const VoxelField> fields);
    /// processes  whose ranges count as well; null: this one's alone
    MomentUnits units(const Collective* processes);

  private:
    std::vector<int> component_;
    std::vector<double> ends_;  ///< [components][2] minus the least, the largest
};

/// The volume with its density times u_a, or times u_a u_b.
/// a, b  places in units.component; b -1: none
Volume moment_volume(const Volume& volume, const VoxelField& field, const MomentUnits& units, int a,
                     int b);

/// Sums along a ray of the measure w, of w phi and w phi^2; phi minus its reference on this ray.
struct RayMoments {
    RaySums sums;
    double reference = 0;
};

/// Sums over the rays of a pixel, voxel by voxel or ray by ray.
struct FirstRelative : device::FirstRelative {
    using device::FirstRelative::add;
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

/// Grids of w, w u_a and w u_a u_b, a <= b.
template <class Grid>
struct MomentGrids {
    MomentUnits units;
    Grid measure;
    std::vector<Grid> first{}, second{};

    /// towards  unit length
    RayMoments along(Vec3d origin, Vec3d towards) const {
        RayMoments ray;
        const std::size_t count = units.component.size();
        ray.sums.column = optical_depth(measure, origin, towards);
        Vec3d factor = units.unit;  // of a scalar the unit alone
        for (int c = 0; c < static_cast<int>(count); ++c) {
            const double along = count > 1 ? towards[c] : 1;
            factor[c] *= along;
            ray.reference += along * units.lower[c];
        }
        if (!(ray.sums.column > 0)) return ray;
        std::size_t n = 0;
        for (std::size_t a = 0; a < count; ++a) {
            const double of_a = factor[static_cast<int>(a)];
            ray.sums.first += of_a * optical_depth(first[a], origin, towards);
            for (std::size_t b = a; b < count; ++b)
                ray.sums.second += (a == b ? 1 : 2) * of_a * factor[static_cast<int>(b)] *
                                   optical_depth(second[n++], origin, towards);
        }
        return ray;
    }
};

/// Prepares all grids.
/// prepare  called with (a, b), as moment_volume, -1 for none: returns that grid
template <class Grid, class Prepare>
MomentGrids<Grid> moment_grids(const MomentUnits& units, const Prepare& prepare) {
    MomentGrids<Grid> grids{units, prepare(-1, -1)};
    const int count = static_cast<int>(units.component.size());
    for (int a = 0; a < count; ++a) {
        grids.first.push_back(prepare(a, -1));
        for (int b = a; b < count; ++b) grids.second.push_back(prepare(a, b));
    }
    return grids;
}

/// Adds what a field has on a ray to the sums of a pixel.
using AddRay = std::function<void(Vec3d origin, Vec3d direction, FirstRelative& to)>;
/// Sums over the rays of every pixel.
FieldMaps maps_of_rays(const Camera& camera, int width, int height, const ReferenceOptions& options,
                       const AddRay& add);

/// Calls maps(part, progress) for the part, or for each component of a magnitude.
template <class Maps>
FieldMaps of_part(FieldPart part, const Progress& progress, const Maps& maps) {
    return part == FieldPart::magnitude ? magnitude_maps(progress, maps) : maps(part, progress);
}

/// Largest value of a field on a ray; minus infinity: it meets nothing.
using LargestOnRay = std::function<double(Vec3d origin, Vec3d direction, Segment within)>;
/// Largest values along the rays of every pixel, as render_maximum_reference has them.
ValueMap maxima_of_rays(const Camera& camera, int width, int height,
                        const ReferenceOptions& options, const LargestOnRay& largest);

}  // namespace vog::reference
