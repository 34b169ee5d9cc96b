// cell_moments.h: integrals over a cell of any shape: mass, mean, covariance, and joint moments with values that are linear
// between its corners.
#pragma once

#include <array>
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
/// Calls visit(middle, volume) for parts of a tetrahedron, halved across their longest edges until none is longer than `edge`.
/// volume  of either sign, as the tetrahedron's
template <class Visit>
void for_each_part(const std::array<Corner, 4>& corner, double edge, const Visit& visit) {
    std::size_t a = 0, b = 1;
    double longest = 0;
    for (std::size_t j = 0; j < 4; ++j)
        for (std::size_t k = j + 1; k < 4; ++k)
            if (const double one = length(corner[k].place - corner[j].place); one > longest)
                longest = one, a = j, b = k;
    if (longest <= edge) {
        const Vec3d base = corner[0].place;
        return visit(
            mean_of(std::array{&corner[0], &corner[1], &corner[2], &corner[3]}),
            dot(corner[1].place - base, cross(corner[2].place - base, corner[3].place - base)) / 6);
    }
    for (const std::size_t end : {a, b}) {
        std::array<Corner, 4> half = corner;
        half[end] = mean_of(std::array{&corner[a], &corner[b]});
        for_each_part(half, edge, visit);
    }
}
/// The same of a whole cell; volumes are above 0 but in the inverted parts of a tangled one.
template <class Visit>
void for_each_part(const Shape& shape, double edge, const Visit& visit) {
    double volume = 0;
    for_each_tetrahedron(shape, [&](const std::array<const Corner*, 4>& c) {
        volume += dot(c[1]->place - c[0]->place,
                      cross(c[2]->place - c[0]->place, c[3]->place - c[0]->place));
    });
    for_each_tetrahedron(shape, [&](const std::array<const Corner*, 4>& c) {
        for_each_part(
            std::array{*c[0], *c[1], *c[2], *c[3]}, edge,
            [&](const Corner& middle, double part) { visit(middle, volume < 0 ? -part : part); });
    });
}
/// Integrals over the cell, about its centre; volume below 0 for a mirrored cell.
/// components  of the values at the corners; 0: none
CellIntegrals integrals_of(const Shape& shape, std::size_t components);

}  // namespace vog::unstructured
