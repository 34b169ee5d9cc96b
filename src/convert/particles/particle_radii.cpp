// particle_radii.cpp: distances to neighbours, also across the faces of a periodic box, and radii of stated kernels.
#include "convert/particles/particle_radii.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "convert/particles/nearest_neighbours.h"
#include "core/paging.h"
#include "core/parallel.h"
#include "vog/distributed.h"
#include "vog/error.h"
#include "vog/units.h"

namespace vog::particles {

namespace {

std::string name_of(const Points& points) {
    return points.source.empty() ? "points" : points.source;
}

/// Distances to the k-th neighbour, world units, in the order of the particles. Each process searches for its share of the
/// particles, the slowest step of a conversion; the shares are summed.
BigVector<double> distances(const Points& points, const PointGrid& grid,
                            const PointOptions& options) {
    BigVector<Vec3f> places;
    resize_kept(places, grid.size());
    vog::parallel_for(std::size_t{0}, places.size(),
                      [&](std::size_t n) { places[n] = vec_cast<float>(grid.place(points, n)); });
    const Collective& collective = collective_or_single(options.collective);
    BigVector<float> found =
        neighbour_distances(places, options.neighbours, collective.index, collective.count);
    if (collective.count > 1) {
        std::vector<double> all(found.begin(), found.end());
        collective.sum(all);
        found.assign(all.begin(), all.end());
    }
    BigVector<double> distance;
    resize_kept(distance, grid.size());
    vog::parallel_for(std::size_t{0}, grid.size(), [&](std::size_t n) {
        distance[grid.index[n]] = double{found[n]} * grid.voxel_size;
    });
    return distance;
}

/// Positions with their images as far beyond the faces of the box as balls of these radii reach.
/// radius  [N] at least the distance to the neighbour that is looked for, world units
Points with_images(const Points& points, const BigVector<double>& radius, const Box& box) {
    Box reach = box;
    for (std::size_t n = 0; n < points.size(); ++n) {
        const Vec3d r{radius[n], radius[n], radius[n]};
        reach.include({points.position[n] - r, points.position[n] + r});
        keep_memory_at(n);
    }
    const Vec3d edges = box.upper - box.lower;
    Points all;
    all.position = points.position;
    for (int shift = 0; shift < 27; ++shift) {
        const Vec3d by{(shift % 3 - 1) * edges.x, (shift / 3 % 3 - 1) * edges.y,
                       (shift / 9 - 1) * edges.z};
        if (by == Vec3d{}) continue;
        for (const Vec3d position : points.position) {
            const Vec3d at = position + by;
            bool near = true;
            for (int axis = 0; axis < 3; ++axis)
                near &= at[axis] >= reach.lower[axis] && at[axis] <= reach.upper[axis];
            if (near) all.position.push_back(at);
        }
    }
    return all;
}

}  // namespace

BigVector<double> adaptive_radii(const Points& points, const PointGrid& grid,
                                 const PointOptions& options, const std::optional<Box>& period) {
    constexpr double kShare = 0.5;
    BigVector<double> radius = distances(points, grid, options);
    if (period) {
        const Points all = with_images(points, radius, *period);
        radius = distances(all, point_grid(all), options);
        radius.resize(points.size());
    }
    double largest = 0;
    for (std::size_t n = 0; n < radius.size(); ++n) {
        largest = std::max(largest, radius[n]);
        keep_memory_at(n);
    }
    if (!(largest > 0))
        throw Error(fmt::format(
            "{}: {}, so there is no spacing for an adaptive radius, expected a constant one "
            "(--radius X)",
            name_of(points),
            points.size() == 1 ? "one particle"
                               : fmt::format("all {} particles lie in one place", points.size())));
    // Lower bound, for more than k particles in one place: 2^-20 of the data's extent, which
    // float32 positions resolve.
    const double least = std::ldexp(grid.voxel_size, grid.root_log2 - 20);
    for (double& one : radius) one = std::max(kShare * one, least);
    return radius;
}

BigVector<double> smoothing_radii(const Points& points, const SmoothingRadius& smoothing) {
    const std::string unit = point_value_unit(points, smoothing.name);
    std::optional<double> in_positions = 1;
    if (!unit.empty() && !points.length_unit.empty())
        in_positions = unit_factor(unit, points.length_unit);
    if (!in_positions)
        throw Error(
            fmt::format("{}: '{}' in '{}', expected a length as positions in '{}' (--radius "
                        "adaptive measures the distances of neighbours instead)",
                        name_of(points), smoothing.name, unit, points.length_unit));
    const double share = std::sqrt(3.0 / 40) * smoothing.factor * *in_positions;
    const BigVector<float> values = point_values(points, smoothing.name);
    BigVector<double> radius;
    resize_kept(radius, values.size());
    for (std::size_t n = 0; n < values.size(); ++n) {
        if (!(values[n] > 0))
            throw Error(
                fmt::format("{}: '{}' of particle {} is {}, expected a radius above 0 (--radius "
                            "adaptive measures the distances of neighbours instead)",
                            name_of(points), smoothing.name, n, values[n]));
        radius[n] = share * double{values[n]};
        keep_memory_at(n);
    }
    return radius;
}

}  // namespace vog::particles
