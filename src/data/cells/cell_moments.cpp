// cell_moments.cpp: cells as tetrahedra about their centre and those of their faces, and integrals of polynomials over these.
//
// Over a tetrahedron of volume V with barycentric coordinates l, and functions a, b, c linear between the corners:
//   int l_i l_j = V / 20 (1 + d_ij),  int l_i l_j l_k = V / 120 (1 + d_ij + d_jk + d_ik + 2 d_ijk)
//   int a b     = V / 20 (A B + sum a b)
//   int a b c   = V / 120 (A B C + C sum a b + B sum a c + A sum b c + 2 sum a b c),  A = sum a
#include "data/cells/cell_moments.h"

#include <algorithm>
#include <cmath>

namespace vog::unstructured {

namespace {

using Face = std::array<std::int8_t, 4>;
// Corners run counterclockwise seen from outside; VTK's wedges are meant in either sense.
constexpr std::array<Face, 4> kTetrahedron{
    {{0, 2, 1, -1}, {0, 1, 3, -1}, {1, 2, 3, -1}, {0, 3, 2, -1}}};
constexpr std::array<Face, 6> kHexahedron{
    {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};
constexpr std::array<Face, 5> kWedge{
    {{0, 1, 2, -1}, {3, 5, 4, -1}, {0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}}};
constexpr std::array<Face, 5> kPyramid{
    {{0, 3, 2, 1}, {0, 1, 4, -1}, {1, 2, 4, -1}, {2, 3, 4, -1}, {3, 0, 4, -1}}};

/// Faces of a type of cells, with a surface's those of its layer, and its corners in the order of the faces.
struct Kind {
    std::span<const Face> faces;
    std::array<std::int8_t, 8> order{0, 1, 2, 3, 4, 5, 6, 7};
    bool is_surface = false;
};
Kind kind_of(int type) {
    switch (type) {
        case 5:
            return {kWedge, {0, 1, 2}, true};
        case 8:
            return {kHexahedron, {0, 1, 3, 2}, true};
        case 9:
            return {kHexahedron, {0, 1, 2, 3}, true};
        case 10:
            return {kTetrahedron};
        case 11:
            return {kHexahedron, {0, 1, 3, 2, 4, 5, 7, 6}};
        case 12:
            return {kHexahedron};
        case 13:
            return {kWedge};
        case 14:
            return {kPyramid};
        default:
            return {};
    }
}

/// Sums over the four corners of a tetrahedron.
void add_tetrahedron(CellIntegrals& to, const std::array<const Corner*, 4>& c, double volume,
                     std::size_t components) {
    double density = 0;
    Vec3d place, weighted;
    for (const Corner* one : c) {
        density += one->density;
        place = place + one->place;
        weighted = weighted + one->density * one->place;
    }
    to.volume += volume;
    to.mass += volume / 4 * density;
    to.first = to.first + volume / 20 * (density * place + weighted);
    const double third = volume / 120;
    const auto second = [&](int a, int b) {
        double sum =
            density * place[a] * place[b] + weighted[a] * place[b] + place[a] * weighted[b];
        for (const Corner* one : c)
            sum += (density + 2 * one->density) * one->place[a] * one->place[b];
        return third * sum;
    };
    to.second[0] += second(0, 0), to.second[1] += second(0, 1), to.second[2] += second(0, 2);
    to.second[3] += second(1, 1), to.second[4] += second(1, 2), to.second[5] += second(2, 2);

    std::array<double, kMostValues> value{}, weighted_value{};
    for (std::size_t k = 0; k < components; ++k) {
        for (const Corner* one : c) {
            value[k] += one->value[k];
            weighted_value[k] += one->density * one->value[k];
        }
        to.value[k] += volume / 20 * (density * value[k] + weighted_value[k]);
        Vec3d sum = (density * value[k] + weighted_value[k]) * place + value[k] * weighted;
        for (const Corner* one : c)
            sum = sum + (density + 2 * one->density) * one->value[k] * one->place;
        to.cross[k] = to.cross[k] + third * sum;
    }
    for (std::size_t a = 0, n = 0; a < components; ++a)
        for (std::size_t b = a; b < components; ++b, ++n) {
            double sum = density * value[a] * value[b] + weighted_value[a] * value[b] +
                         value[a] * weighted_value[b];
            for (const Corner* one : c)
                sum += (density + 2 * one->density) * one->value[a] * one->value[b];
            to.square[n] += third * sum;
        }
}

/// Sets the last corner to the mean of the others.
void set_centre(Shape& shape) {
    std::array<const Corner*, 8> all{};
    for (std::size_t k = 0; k < shape.corners; ++k) all[k] = &shape.corner[k];
    shape.corner.back() = mean_of({all.data(), shape.corners});
}

/// Moves the corners of a surface to both sides of it.
void thicken(Shape& shape, double thickness) {
    const auto at = [&](std::size_t k) { return shape.corner[k].place; };
    const Vec3d across = shape.corners == 3 ? cross(at(1) - at(0), at(2) - at(0))
                                            : cross(at(2) - at(0), at(3) - at(1));
    const Vec3d step = length(across) > 0 ? thickness / 2 / length(across) * across : Vec3d{};
    for (std::size_t k = 0; k < shape.corners; ++k) {
        Corner& low = shape.corner[k];
        Corner& high = shape.corner[shape.corners + k] = low;
        low.place = low.place - step, high.place = high.place + step;
    }
    shape.corners *= 2;
}

}  // namespace

Corner mean_of(std::span<const Corner* const> corners) {
    Corner mean;
    const double share = 1.0 / static_cast<double>(corners.size());
    for (const Corner* one : corners) {
        mean.place = mean.place + share * one->place;
        mean.density += share * one->density;
        for (std::size_t k = 0; k < kMostValues; ++k) mean.value[k] += share * one->value[k];
    }
    return mean;
}

Shape shape_of(const Cells& cells, std::size_t n) {
    Shape shape;
    const Kind kind = kind_of(cells.type[n]);
    if (kind.faces.empty() || (kind.is_surface && !(cells.thickness > 0))) return shape;
    const std::uint64_t first = n ? cells.end[n - 1] : 0;
    shape.corners = cells.end[n] - first;
    shape.faces = kind.faces;
    shape.is_mirrored_if_negative = kind.faces.data() != kWedge.data();
    const BigVector<float>& density = cells.density.component.front();
    for (std::size_t k = 0; k < shape.corners; ++k) {
        const std::uint32_t point = cells.corner[first + static_cast<std::size_t>(kind.order[k])];
        shape.centre = shape.centre + 1 / static_cast<double>(shape.corners) * cells.points[point];
        shape.corner[k].place = cells.points[point];
        shape.corner[k].density = density[cells.density.at_points ? point : n];
    }
    for (std::size_t k = 0; k < shape.corners; ++k)
        shape.corner[k].place = shape.corner[k].place - shape.centre;
    if (kind.is_surface) thicken(shape, cells.thickness);
    set_centre(shape);
    return shape;
}

std::array<double, kMostValues> set_values(Shape& shape, const Cells& cells, std::size_t n,
                                           const CellValues& values) {
    std::array<double, kMostValues> mean{};
    const Kind kind = kind_of(cells.type[n]);
    const std::uint64_t first = n ? cells.end[n - 1] : 0;
    const std::size_t corners = cells.end[n] - first;
    for (std::size_t c = 0; c < values.component.size(); ++c) {
        const auto at = [&](std::size_t k) {
            const auto place = first + static_cast<std::size_t>(kind.order[k % corners]);
            return double{values.component[c][values.at_points ? cells.corner[place] : n]};
        };
        for (std::size_t k = 0; k < corners; ++k) mean[c] += at(k) / static_cast<double>(corners);
        for (std::size_t k = 0; k < shape.corners; ++k) shape.corner[k].value[c] = at(k) - mean[c];
    }
    set_centre(shape);
    return mean;
}

CellIntegrals integrals_of(const Shape& shape, std::size_t components) {
    CellIntegrals sums;
    bool above = false, below = false;
    for_each_tetrahedron(shape, [&](const std::array<const Corner*, 4>& c) {
        const double volume = six_volumes(c) / 6;
        above |= volume > 0, below |= volume < 0;
        add_tetrahedron(sums, c, volume, components);
    });
    sums.tangled = above && below;
    return sums;
}

}  // namespace vog::unstructured
