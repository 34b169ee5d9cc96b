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

/// A corner of a tetrahedron.
struct Corner {
    Vec3d place;  ///< world units, relative to the cell's centre
    double density = 0;
    std::array<double, kMostValues> value{};  ///< of one field, relative to the cell's mean
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
/// Calls visit(corner, volume) for points of a tetrahedron: those of a cubic lattice of the world, or its middle where no edge is longer than
/// the lattice's spacing.
/// centre  of the cell, world units
template <class Visit>
void for_each_point(const std::array<const Corner*, 4>& corner, Vec3d centre, double spacing,
                    const Visit& visit) {
    const Vec3d base = corner[0]->place;
    Box box;
    double longest = 0;
    for (const Corner* one : corner) {
        box.include(one->place);
        for (const Corner* other : corner)
            longest = std::max(longest, length(one->place - other->place));
    }
    const Vec3d edge[3] = {corner[1]->place - base, corner[2]->place - base,
                           corner[3]->place - base};
    const double six_volumes = std::abs(dot(edge[0], cross(edge[1], edge[2])));
    if (longest <= spacing) return visit(mean_of(corner), six_volumes / 6);
    if (six_volumes == 0) return;
    // Not in the middle: planes of meshes that are cubes have none of these points.
    constexpr double kPlace[3] = {0.4137, 0.5291, 0.4673};
    Vec3d shift;
    for (int axis = 0; axis < 3; ++axis)
        shift[axis] = spacing * kPlace[axis] - std::fmod(centre[axis], spacing);
    const auto first = [&](double at, int axis) { return std::ceil((at - shift[axis]) / spacing); };
    for (double x = first(box.lower.x, 0); spacing * x + shift.x < box.upper.x; ++x)
        for (double y = first(box.lower.y, 1); spacing * y + shift.y < box.upper.y; ++y) {
            // Barycentric coordinates are linear along z.
            const Vec3d start = Vec3d{spacing * x + shift.x, spacing * y + shift.y, 0} - base;
            double at[4] = {1}, slope[4] = {0}, low = box.lower.z, high = box.upper.z;
            for (std::size_t k = 0; k < 3; ++k) {
                const Vec3d normal = cross(edge[(k + 1) % 3], edge[(k + 2) % 3]);
                const double scale = 1 / dot(edge[k], normal);
                at[k + 1] = scale * dot(normal, start), slope[k + 1] = scale * normal.z;
                at[0] -= at[k + 1], slope[0] -= slope[k + 1];
            }
            for (int k = 0; k < 4; ++k) {
                const double crossing = -at[k] / slope[k];
                if (slope[k] > 0) low = std::max(low, crossing);
                if (slope[k] < 0) high = std::min(high, crossing);
                if (slope[k] == 0 && at[k] < 0) high = low;
            }
            for (double n = first(low, 2); spacing * n + shift.z < high; ++n) {
                const double z = spacing * n + shift.z;
                Corner point{{start.x + base.x, start.y + base.y, z}};
                for (std::size_t k = 0; k < 4; ++k) {
                    const double share = at[k] + z * slope[k];
                    point.density += share * corner[k]->density;
                    for (std::size_t c = 0; c < kMostValues; ++c)
                        point.value[c] += share * corner[k]->value[c];
                }
                visit(point, spacing * spacing * spacing);
            }
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
