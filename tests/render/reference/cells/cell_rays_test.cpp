// Chords through the cells of a mesh add up to the integral of its data, whatever the cube is cut into.
#include "render/reference/cells/cell_rays.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "vog/distributed.h"

namespace vog {
namespace {

struct Cut {
    int type;
    std::vector<std::vector<std::uint32_t>>
        corners;  ///< of the cells of a cube, of a hexahedron in VTK's order
};
const Cut kCuts[] = {
    {12, {{0, 1, 2, 3, 4, 5, 6, 7}}},
    {13, {{0, 1, 2, 4, 5, 6}, {0, 2, 3, 4, 6, 7}}},
    {10, {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}}},
    {14, {{0, 1, 2, 3, 6}, {0, 4, 5, 1, 6}, {0, 3, 7, 4, 6}}}};

double plane(Vec3d p) { return 2 + p.x - 0.5 * p.y + 0.25 * p.z; }

/// Cells of 3^3 cubes in the unit cube, with inner points that are moved unless pyramids need planes.
Cells cube(const Cut& cut) {
    constexpr std::uint32_t kEdge = 3, kPoints = kEdge + 1;
    Cells cells;
    cells.density.name = "density";
    cells.density.at_points = true;
    cells.density.component.resize(1);
    for (std::uint32_t n = 0; n < kPoints * kPoints * kPoints; ++n) {
        const std::uint32_t at[3] = {n % kPoints, n / kPoints % kPoints, n / kPoints / kPoints};
        Vec3d p;
        for (int axis = 0; axis < 3; ++axis) {
            p[axis] = at[axis] / double(kEdge);
            if (cut.type != 14 && at[axis] % kEdge) p[axis] += 0.08 * std::sin(7.0 * n + axis);
        }
        cells.points.push_back(p);
        cells.density.component[0].push_back(static_cast<float>(plane(p)));
    }
    for (std::uint32_t n = 0; n < kEdge * kEdge * kEdge; ++n) {
        const std::uint32_t x = n % kEdge, y = n / kEdge % kEdge, z = n / kEdge / kEdge;
        for (const auto& corners : cut.corners) {
            for (const std::uint32_t c : corners)
                cells.corner.push_back(x + (c % 4 == 1 || c % 4 == 2) +
                                       kPoints * (y + (c % 4 > 1) + kPoints * (z + c / 4)));
            cells.end.push_back(cells.corner.size());
            cells.type.push_back(static_cast<std::uint8_t>(cut.type));
        }
    }
    return cells;
}

std::vector<std::uint32_t> all_of(const Cells& cells) {
    std::vector<std::uint32_t> all(cells.size());
    std::iota(all.begin(), all.end(), 0u);
    return all;
}

/// Integral of `plane` along a ray through the unit cube: length times the value in the middle.
double expected(Vec3d from, Vec3d along) {
    double first = -1e300, last = 1e300;
    for (int axis = 0; axis < 3; ++axis) {
        const double a = -from[axis] / along[axis], b = (1 - from[axis]) / along[axis];
        first = std::max(first, std::min(a, b)), last = std::min(last, std::max(a, b));
    }
    return first < last ? (last - first) * plane(from + (first + last) / 2 * along) : 0;
}

TEST(cell_rays, linear_data_equal_the_closed_form_in_every_kind_of_cell) {
    for (const Cut& cut : kCuts) {
        SCOPED_TRACE(cut.type);
        const Cells cells = cube(cut);
        const std::vector<std::uint32_t> all = all_of(cells);
        const reference::CellRays rays(cells, all);
        for (const Camera& camera : error_views(bounds(cells))) {
            const DepthImage image = render_cells_reference(rays, camera, 33, 33);
            const CameraFrame frame = frame_of(camera, 33, 33);
            int met = 0;
            for (int y = 0; y < 33; ++y)
                for (int x = 0; x < 33; ++x) {
                    const double exact =
                        expected(frame.origin(x, y), normalized(frame.direction(x, y)));
                    EXPECT_NEAR(image.at(x, y), exact, 1e-6 * exact + 1e-7) << x << ' ' << y;
                    met += exact > 0;
                }
            EXPECT_GT(met, 100);
        }
    }
}

TEST(cell_rays, mirrored_cells_count_as_the_others_and_flat_ones_add_nothing) {
    Cells cells = cube(kCuts[2]);
    for (std::size_t n = 0; n < cells.size(); n += 2)
        std::swap(cells.corner[4 * n], cells.corner[4 * n + 1]);
    for (int k = 0; k < 4; ++k) cells.corner.push_back(k == 3 ? 2 : static_cast<unsigned>(k));
    cells.end.push_back(cells.corner.size()), cells.type.push_back(10);
    const std::vector<std::uint32_t> all = all_of(cells);
    const reference::CellRays rays(cells, all);
    std::vector<reference::CellPiece> pieces;
    const Vec3d from{-1, 0.31, 0.47}, along{2, 0.02, 0.03};
    rays.add(from, along, {}, pieces);
    double sum = 0;
    for (const auto& piece : pieces)
        sum += (piece.segment.last - piece.segment.first) / 2 *
               (piece.first.density + piece.last.density);
    EXPECT_NEAR(sum * length(along), expected(from, normalized(along)), 1e-6);
    pieces.clear();
    rays.add({-1, 2, 2}, {1, 0, 0}, {}, pieces);
    EXPECT_TRUE(pieces.empty());
}

}  // namespace
}  // namespace vog
