// reference_linear.cpp: Integrates the trilinear field along a ray, block by block.
#include "render/reference/reference_linear.h"

#include "render/reference/linear_block.h"
#include "render/reference/reference.h"

namespace vog::reference {

namespace {

/// Two-point Gauss rule in each cell, exact: within a cell the field along a ray is a cubic.
struct GaussPoints {
    double integrate(const GridRay& ray, Segment segment, const Block& block) const {
        constexpr double kOffset = 0.57735026918962576;  // 1/sqrt(3)
        double sum = 0;
        for_each_cell<3>(ray, block.lower(), 1, segment, [&](std::uint32_t offset, Segment part) {
            Block::Cell cell = block.cell(offset);
            const double middle = 0.5 * (part.first + part.last);
            const double half = 0.5 * (part.last - part.first);
            for (const double at : {middle - kOffset * half, middle + kOffset * half}) {
                cell.move_to(ray.origin + at * ray.direction - block.lower());
                sum += half * cell.value();
            }
        });
        return sum;
    }
    double constant(float value, Segment segment) const {
        return value * (segment.last - segment.first);
    }
};

template <class Rule>
struct LinearSum {
    const VoxelGrid::Data& grid;
    const GridRay& ray;
    Rule rule;
    double sum = 0;

    void leaf(const NanoLeaf&, Vec3d lower, Segment segment) { block(lower, segment); }

    void tile(Vec3d lower, int edge, float value, Segment segment) {
        // Constant except in the last layer of cells, which also uses the blocks above the tile.
        const double inside = edge - 1;
        const Segment middle = clip(ray, lower, lower + Vec3d{inside, inside, inside}, segment);
        if (middle.empty()) return blocks(lower, edge, segment);
        sum += rule.constant(value, middle);
        blocks(lower, edge, {segment.first, middle.first});
        blocks(lower, edge, {middle.last, segment.last});
    }

    void blocks(Vec3d lower, int edge, Segment segment) {
        for_each_block(ray, lower, edge, segment, [&](Vec3d at, Segment part) { block(at, part); });
    }

    void block(Vec3d lower, Segment segment) {
        sum += rule.integrate(ray, segment, Block(grid.tree.root(), lower + grid.corner, lower));
    }
};

}  // namespace

double linear_sum(const VoxelGrid::Data& grid, const GridRay& ray, Segment within) {
    const auto integrate = [&](auto rule) {
        LinearSum<decltype(rule)> linear{grid, ray, rule};
        march(grid.root_cells, ray, linear, within);
        return linear.sum;
    };
    const double step = grid.options.step_voxels;
    if (step == 0) return integrate(GaussPoints{});

    // A whole number of steps over the part of the ray within the box of the grid and the segment.
    const auto& box = grid.tree.root().bbox();
    const Vec3d size{double(box.dim()[0]), double(box.dim()[1]), double(box.dim()[2])};
    const Segment whole = clip(ray, {0, 0, 0}, size, within);
    if (whole.empty()) return 0;
    const double interval = whole.last - whole.first;
    const double steps = std::ceil(interval * length(ray.direction) / step);
    return integrate(Midpoints{whole.first, interval / steps});
}

}  // namespace vog::reference
