// root_cells.cpp: Construction of the hierarchy by median splits along the longest axis.
#include "render/reference/root_cells.h"

#include <algorithm>
#include <tuple>

namespace vog::reference {

namespace {

Vec3d vec(const nanovdb::Coord& index) {
    return {double(index[0]), double(index[1]), double(index[2])};
}

}  // namespace

RootCells::RootCells(const NanoRoot& root, Vec3d corner) {
    const auto& data = *root.data();
    for (std::uint32_t i = 0; i < data.mTableSize; ++i) {
        const auto& entry = *data.tile(i);
        if (entry.isChild()) {
            const NanoUpper& upper = *data.getChild(&entry);
            cells_.push_back({vec(upper.bbox().min()) - corner,
                              vec(upper.bbox().max()) - corner + Vec3d{1, 1, 1},
                              vec(upper.origin()) - corner, &upper});
        } else if (entry.isActive()) {
            constexpr double kEdge = NanoUpper::DIM;
            const Vec3d lower = vec(entry.origin()) - corner;
            cells_.push_back(
                {lower, lower + Vec3d{kEdge, kEdge, kEdge}, lower, nullptr, entry.value});
        }
    }
    if (!cells_.empty()) build(0, static_cast<std::uint32_t>(cells_.size()));
}

void RootCells::build(std::uint32_t first, std::uint32_t end) {
    constexpr std::uint32_t kLeaf = 4;  // cells
    Box box;
    for (std::uint32_t i = first; i < end; ++i)
        box.include(cells_[i].lower), box.include(cells_[i].upper);
    const std::size_t here = nodes_.size();
    nodes_.push_back({box.lower, box.upper, 0, first, end - first});
    if (end - first > kLeaf) {
        nodes_[here].count = 0;
        const Vec3d size = box.upper - box.lower;
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const std::uint32_t middle = first + (end - first) / 2;
        // Cells are disjoint: their centres differ, and so the order is unique but for ties along
        // the axis, which the others break.
        const auto key = [&](const RootCell& cell) {
            const Vec3d sum = cell.lower + cell.upper;
            return std::tuple(sum[axis], sum.x, sum.y, sum.z);
        };
        std::nth_element(cells_.begin() + first, cells_.begin() + middle, cells_.begin() + end,
                         [&](const RootCell& a, const RootCell& b) { return key(a) < key(b); });
        build(first, middle);
        build(middle, end);
    }
    nodes_[here].skip = static_cast<std::uint32_t>(nodes_.size());
}

}  // namespace vog::reference
