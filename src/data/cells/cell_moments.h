// cell_moments.h: integrals over a cell of any shape: mass, mean, covariance, and joint moments with values that are linear
// between its corners.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "vog/cells.h"

namespace vog::unstructured {

/// Most values at a corner, beside density and position.
inline constexpr std::size_t kMostValues = 3;

/// Density and a field at a point of a cell.
struct CellPoint {
    double density = 0;
    std::array<double, kMostValues> value{};  ///< relative to the cell's mean
};
/// A corner of a tetrahedron.
struct Corner : CellPoint {
    Vec3d place;  ///< world units, relative to the cell's centre
};

/// Corners of a cell, its faces, each with the corners in one sense around, and the centre.
struct Shape {
    std::array<Corner, 9> corner;  ///< the last one is the centre
    std::size_t corners = 0;
    std::span<const std::array<std::int8_t, 4>> faces;  ///< -1 behind three corners
    Vec3d centre;                                       ///< world units
    bool is_mirrored_if_negative = true;                ///< wedges come in both senses
};

/// Integrals of density times 1, position and value, and their products.
struct CellIntegrals {
    double volume = 0, mass = 0;
    Vec3d first;                              ///< of position
    std::array<double, 6> second{};           ///< xx xy xz yy yz zz
    std::array<double, kMostValues> value{};  ///< of each component
    std::array<Vec3d, kMostValues> cross{};   ///< of each component times position
    std::array<double, 6> square{};           ///< of products of components; of one: the first
    bool tangled = false;                     ///< parts of the cell are inverted, others not
};

/// The corners of cell n with its density; empty `corners`: the cell is of no known type, or a surface without thickness.
Shape shape_of(const Cells& cells, std::size_t n);
/// Sets the values of a field at the corners, relative to their mean, which is returned.
std::array<double, kMostValues> set_values(Shape& shape, const Cells& cells, std::size_t n,
                                           const CellValues& values);
/// Mean of corners, in place, density and values.
Corner mean_of(std::span<const Corner* const> corners);
/// Calls take({a, b, c, d}) for the tetrahedra of the cell.
template <class Take>
void for_each_tetrahedron(const Shape& shape, const Take& take) {
    using Corners = std::array<const Corner*, 4>;
    const auto& corner = shape.corner;
    if (shape.corners == 4) return take(Corners{&corner[0], &corner[1], &corner[2], &corner[3]});
    for (const auto& face : shape.faces) {
        const std::size_t sides = face[3] < 0 ? 3 : 4;
        Corners around{};
        for (std::size_t k = 0; k < sides; ++k)
            around[k] = &corner[static_cast<std::size_t>(face[k])];
        if (sides == 3) {
            take(Corners{&corner.back(), around[0], around[1], around[2]});
            continue;
        }
        const Corner middle = mean_of(around);
        for (std::size_t k = 0; k < 4; ++k)
            take(Corners{&corner.back(), around[k], around[(k + 1) % 4], &middle});
    }
}
/// Six times the volume of a tetrahedron, below 0 where it is mirrored.
inline double six_volumes(const std::array<const Corner*, 4>& corner) {
    const auto edge = [&](std::size_t k) { return corner[k]->place - corner[0]->place; };
    return dot(edge(1), cross(edge(2), edge(3)));
}
/// Line in a tetrahedron with a volume: barycentric coordinates are linear along it.
class TetrahedronLine {
  public:
    double first, last;  ///< t of the part inside, empty unless first < last

    /// origin       relative to the cell's centre
    /// first, last  t of the part of the line that counts
    TetrahedronLine(const std::array<const Corner*, 4>& corner, Vec3d origin, Vec3d direction,
                    double from, double to)
        : first(from), last(to), corner_(corner) {
        const double volume = six_volumes(corner);
        const Vec3d base = corner[0]->place;
        for (std::size_t k = 1; k < 4; ++k) {
            const Vec3d normal =
                1 / volume *
                cross(corner[k % 3 + 1]->place - base, corner[(k + 1) % 3 + 1]->place - base);
            at_[k] = dot(normal, origin - base), slope_[k] = dot(normal, direction);
            at_[0] -= at_[k], slope_[0] -= slope_[k];
        }
        for (std::size_t k = 0; k < 4; ++k) {
            const double crossing = -at_[k] / slope_[k];
            if (slope_[k] > 0)
                first = std::max(first, crossing);
            else if (slope_[k] < 0)
                last = std::min(last, crossing);
            else if (at_[k] < 0)
                last = first;
        }
    }
    CellPoint at(double t) const {
        CellPoint point;
        for (std::size_t k = 0; k < 4; ++k) {
            const double share = at_[k] + t * slope_[k];
            point.density += share * corner_[k]->density;
            for (std::size_t c = 0; c < kMostValues; ++c)
                point.value[c] += share * corner_[k]->value[c];
        }
        return point;
    }

  private:
    const std::array<const Corner*, 4>& corner_;
    double at_[4] = {1}, slope_[4] = {0};
};
/// Calls visit(place, point, volume) for points of a tetrahedron: those of a cubic lattice of the world, or its middle where no edge is longer
/// than the lattice's spacing.
/// centre  of the cell, world units
/// place   relative to it
template <class Visit>
void for_each_point(const std::array<const Corner*, 4>& corner, Vec3d centre, double spacing,
                    const Visit& visit) {
    Box box;
    double longest = 0;
    for (const Corner* one : corner) {
        box.include(one->place);
        for (const Corner* other : corner)
            longest = std::max(longest, length(one->place - other->place));
    }
    const double volume = std::abs(six_volumes(corner)) / 6;
    if (longest <= spacing) {
        const Corner middle = mean_of(corner);
        return visit(middle.place, middle, volume);
    }
    if (volume == 0) return;
    // Not in the middle: planes of meshes that are cubes have none of these points.
    constexpr double kPlace[3] = {0.4137, 0.5291, 0.4673};
    Vec3d shift;
    for (int axis = 0; axis < 3; ++axis)
        shift[axis] = spacing * kPlace[axis] - std::fmod(centre[axis], spacing);
    const auto first = [&](double at, int axis) {
        return shift[axis] + spacing * std::ceil((at - shift[axis]) / spacing);
    };
    for (double x = first(box.lower.x, 0); x < box.upper.x; x += spacing)
        for (double y = first(box.lower.y, 1); y < box.upper.y; y += spacing) {
            const TetrahedronLine line(corner, {x, y, 0}, {0, 0, 1}, box.lower.z, box.upper.z);
            for (double z = first(line.first, 2); z < line.last; z += spacing)
                visit(Vec3d{x, y, z}, line.at(z), spacing * spacing * spacing);
        }
}
/// The same of a whole cell.
template <class Visit>
void for_each_point(const Shape& shape, double spacing, const Visit& visit) {
    for_each_tetrahedron(shape, [&](const std::array<const Corner*, 4>& corner) {
        for_each_point(corner, shape.centre, spacing, visit);
    });
}
/// Integrals over the cell, about its centre; volume below 0 for a mirrored cell.
/// components  of the values at the corners; 0: none
CellIntegrals integrals_of(const Shape& shape, std::size_t components);

}  // namespace vog::unstructured
