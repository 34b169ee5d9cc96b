// mass_lattice.h: Mass of data on a lattice, and the hull of what a picture shows of it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numeric>
#include <vector>

#include "core/paging.h"
#include "core/parallel.h"
#include "data/cells/cell_moments.h"
#include "vog/cells.h"
#include "vog/distributed.h"
#include "vog/gaussians.h"
#include "vog/volume.h"

namespace vog::views {

inline constexpr int kCells = 96;           // along the longest edge of the box
inline constexpr double kLargestDepth = 4;  // T of the 99th percentile of the columns
inline constexpr double kLeastLight = 0.02;
inline constexpr double kLeftOut =
    0.00025;  // share of the light on each side: 99.9 % of it in a view
inline constexpr double kHullAccuracy = 0.01;  // of the hull's radius

/// Directions to the lattice points on the surface of a cube of edge 2 n, one of each opposite pair.
inline std::vector<Vec3d> directions(int n) {
    std::vector<Vec3d> all;
    for (int x = -n; x <= n; ++x)
        for (int y = -n; y <= n; ++y)
            for (int z = -n; z <= n; ++z) {
                const bool outside = std::max({std::abs(x), std::abs(y), std::abs(z)}) == n;
                const bool first = x > 0 || (x == 0 && (y > 0 || (y == 0 && z > 0)));
                if (outside && first) all.push_back(normalized(Vec3d(x, y, z)));
            }
    return all;
}

/// Longest edge of a voxel, world units.
inline double longest_step(const Affine& map) {
    return std::max(
        {length(map.linear.column(0)), length(map.linear.column(1)), length(map.linear.column(2))});
}

/// Rounded to 24 bits of a length, to numbers of few digits, which files hold exactly.
inline Vec3d rounded(Vec3d point, double length) {
    const double unit = std::exp2(std::ilogb(length) - 24);
    for (int axis = 0; axis < 3; ++axis) point[axis] = unit * std::round(point[axis] / unit) + 0.0;
    return point;
}

/// Few points of a hull, from the farthest one along each direction.
template <class Farthest>
std::vector<Vec3d> hull_points(double radius, const Farthest& farthest) {
    const double slack = kHullAccuracy * radius;
    std::vector<Vec3d> points;
    for (const int fineness : {1, 3})
        for (const Vec3d& direction : directions(fineness))
            for (const Vec3d& d : {direction, -direction}) {
                const Vec3d last = farthest(d);
                const bool held = std::ranges::any_of(
                    points, [&](Vec3d p) { return dot(p, d) >= dot(last, d) - slack; });
                if (!held) points.push_back(rounded(last, radius));
            }
    return points;
}

/// Mass of the data on a lattice of cubic cells in a box.
class MassLattice {
  public:
    explicit MassLattice(const Box& box) : lower_(box.lower) {
        const Vec3d edge = box.upper - box.lower;
        cell_ = std::max({edge.x, edge.y, edge.z}) / kCells;
        for (int axis = 0; axis < 3; ++axis)
            count_[axis] =
                std::clamp(static_cast<int>(std::ceil(edge[axis] / cell_ - 1e-9)), 1, kCells);
        mass_.resize(static_cast<std::size_t>(count_.x) * static_cast<std::size_t>(count_.y) *
                     static_cast<std::size_t>(count_.z));
    }

    void add(const Volume& volume) {
        const double voxel = longest_step(volume.world_from_index);
        for (const Leaf& leaf : volume.leaves) {
            check_interrupt();
            if (kLeafEdge * voxel < cell_) {
                const double sum = std::reduce(leaf.value.begin(), leaf.value.end(), 0.0);
                add(volume.world_from_index(vec_cast<double>(leaf.origin) + Vec3d{3.5, 3.5, 3.5}),
                    sum * voxel_volume(volume));
                continue;
            }
            for (int n = 0; n < kLeafVoxels; ++n)
                if (const float value = leaf.value[static_cast<std::size_t>(n)]; value > 0)
                    add_cube(volume, leaf.origin + Vec3i{n >> 6, n >> 3 & 7, n & 7}, 1,
                             double{value});
        }
        for (const Tile& tile : volume.tiles)
            add_cube(volume, tile.origin, tile.edge, double{tile.value});
    }

    /// Each Gaussian as six points, which have its mass, mean and covariance.
    void add(const Gaussians& model) {
        const double spread = std::sqrt(3 * variance_within(double{model.cutoff}));
        for (std::size_t i = 0; i < model.size(); ++i) {
            keep_memory_at(i);
            const Mat3 axes = model.axis_aligned() ? Mat3{} : matrix_from_quat(model.rotation[i]);
            const Vec3d mean = world_mean(model, i), s = vec_cast<double>(model.scale[i]);
            const double share = mass(model, i) / 6;
            for (int axis = 0; axis < 3; ++axis)
                for (const double side : {-spread, spread})
                    add(mean + (side * s[axis]) * axes.column(axis), share);
        }
    }

    void add(const CellSource& source) {
        for (const std::uint32_t n : source.kept) {
            check_interrupt();
            const unstructured::Shape shape = unstructured::shape_of(*source.cells, n);
            unstructured::for_each_point(
                shape, cell_, [&](Vec3d place, const unstructured::CellPoint& at, double volume) {
                    add(shape.centre + place, std::max(at.density, 0.0) * volume);
                });
        }
    }

    void sum_over(const Collective& collective) { collective.sum(mass_); }

    /// Points whose hull holds what is seen; none where there is no mass.
    std::vector<Vec3d> hull() {
        to_light();
        const std::vector<Row> rows = rows_between(most_of_the_light());
        if (rows.empty()) return {};
        Box box;
        for (const Row& row : rows)
            for (const double side : {-1.0, 1.0}) box.include(corner(row, {side, side, side}));
        return hull_points(box.radius(), [&](Vec3d d) {
            const auto along = [&](const Row& row) { return dot(corner(row, d), d); };
            return corner(std::ranges::max(rows, {}, along), d);
        });
    }

  private:
    /// Cells between two ends along one direction.
    struct Slab {
        Vec3d direction;
        std::size_t low, high;
        static std::size_t bin(Vec3i cell, Vec3d direction) {
            return static_cast<std::size_t>(2 * dot(vec_cast<double>(cell), direction) +
                                            8 * kCells + 0.5);
        }
        bool holds(Vec3i cell) const {
            const std::size_t at = bin(cell, direction);
            return low <= at && at <= high;
        }
    };

    /// Cells of a row along z.
    struct Row {
        int x, y, low, high;
    };
    /// The corner of a row that is farthest along a direction.
    Vec3d corner(const Row& row, Vec3d along) const {
        return lower_ + cell_ * Vec3d(row.x + (along.x > 0), row.y + (along.y > 0),
                                      along.z > 0 ? row.high + 1 : row.low);
    }

    std::size_t at(Vec3i cell) const {
        return (static_cast<std::size_t>(cell.x) * static_cast<std::size_t>(count_.y) +
                static_cast<std::size_t>(cell.y)) *
                   static_cast<std::size_t>(count_.z) +
               static_cast<std::size_t>(cell.z);
    }
    void add(Vec3d point, double mass) {
        Vec3i cell;
        for (int axis = 0; axis < 3; ++axis)
            cell[axis] = static_cast<int>(
                std::clamp((point[axis] - lower_[axis]) / cell_, 0.0, count_[axis] - 1.0));
        mass_[at(cell)] += mass;
    }
    /// A cube of voxels of one value, in pieces no larger than a cell.
    void add_cube(const Volume& volume, Vec3i origin, int edge, double value) {
        const Affine& map = volume.world_from_index;
        Vec3i pieces;
        for (int axis = 0; axis < 3; ++axis)
            pieces[axis] = std::clamp(
                static_cast<int>(std::ceil(edge * length(map.linear.column(axis)) / cell_)), 1,
                2 * kCells);
        const Vec3d step{double(edge) / pieces.x, double(edge) / pieces.y, double(edge) / pieces.z};
        const double mass = value * voxel_volume(volume) * step.x * step.y * step.z;
        const Vec3d first = vec_cast<double>(origin) - Vec3d{0.5, 0.5, 0.5};
        for (int x = 0; x < pieces.x; ++x)
            for (int y = 0; y < pieces.y; ++y)
                for (int z = 0; z < pieces.z; ++z)
                    add(map(first +
                            Vec3d{(x + 0.5) * step.x, (y + 0.5) * step.y, (z + 0.5) * step.z}),
                        mass);
    }
    template <class Visit>
    void each_cell(const Visit& visit) const {
        Vec3i cell;
        for (cell.x = 0; cell.x < count_.x; ++cell.x)
            for (cell.y = 0; cell.y < count_.y; ++cell.y)
                for (cell.z = 0; cell.z < count_.z; ++cell.z)
                    if (const double mass = mass_[at(cell)]; mass > 0) visit(cell, mass);
    }

    /// Replaces the mass of each cell by its share of the light of its three columns.
    void to_light() {
        std::array<std::vector<double>, 3> column;
        const auto place = [&](std::size_t axis, Vec3i cell) -> double& {
            const int u = (static_cast<int>(axis) + 1) % 3, v = (static_cast<int>(axis) + 2) % 3;
            return column[axis][static_cast<std::size_t>(cell[u] * count_[v] + cell[v])];
        };
        for (int axis = 0; axis < 3; ++axis)
            column[static_cast<std::size_t>(axis)].resize(
                static_cast<std::size_t>(count_[(axis + 1) % 3] * count_[(axis + 2) % 3]));
        each_cell([&](Vec3i cell, double mass) {
            for (std::size_t axis = 0; axis < 3; ++axis) place(axis, cell) += mass;
        });
        std::vector<double> all;
        for (const std::vector<double>& one : column)
            std::ranges::copy_if(one, std::back_inserter(all),
                                 [](double mass) { return mass > 0; });
        if (all.empty()) return;
        const auto percentile =
            all.begin() + static_cast<std::ptrdiff_t>(0.99 * double(all.size() - 1));
        std::ranges::nth_element(all, percentile);
        const double extinction = kLargestDepth / *percentile;
        // Light for each unit of mass.
        for (std::vector<double>& one : column)
            for (double& sum : one) {
                const double seen = -std::expm1(-extinction * sum);
                sum = seen >= kLeastLight ? seen / sum : 0;
            }
        each_cell([&](Vec3i cell, double mass) {
            mass_[at(cell)] = mass * (place(0, cell) + place(1, cell) + place(2, cell));
        });
    }

    /// The slabs along 13 axes between whose ends all but a share of the light lies.
    std::vector<Slab> most_of_the_light() const {
        const std::vector<Vec3d> axes = directions(1);
        std::vector<std::array<double, 16 * kCells>> light(axes.size());
        double all = 0;
        each_cell([&](Vec3i cell, double one) {
            for (std::size_t n = 0; n < axes.size(); ++n) light[n][Slab::bin(cell, axes[n])] += one;
            all += one;
        });
        if (all == 0) return {};
        std::vector<Slab> slabs;
        for (std::size_t n = 0; n < axes.size(); ++n) {
            std::size_t low = 0, high = light[n].size() - 1;
            for (double sum = light[n][low]; sum <= kLeftOut * all; sum += light[n][low]) ++low;
            for (double sum = light[n][high]; sum <= kLeftOut * all; sum += light[n][high]) --high;
            slabs.push_back({axes[n], low, high});
        }
        return slabs;
    }

    /// Each row along z between the slabs' ends, whose corners are all that a hull can have.
    std::vector<Row> rows_between(const std::vector<Slab>& slabs) const {
        std::vector<Row> rows;
        for (int x = 0; x < count_.x && !slabs.empty(); ++x)
            for (int y = 0; y < count_.y; ++y) {
                const auto dark = [&](int z) {
                    const auto holds = [&](const Slab& one) { return one.holds({x, y, z}); };
                    return !(mass_[at({x, y, z})] > 0) || !std::ranges::all_of(slabs, holds);
                };
                int low = 0, high = count_.z - 1;
                while (low <= high && dark(low)) ++low;
                while (low < high && dark(high)) --high;
                if (low <= high) rows.push_back({x, y, low, high});
            }
        return rows;
    }

    Vec3d lower_;
    double cell_ = 0;
    Vec3i count_;
    std::vector<double> mass_;  // z fastest; light after to_light()
};

}  // namespace vog::views
