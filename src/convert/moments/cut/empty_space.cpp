// empty_space.cpp: bounds of voxels with mass, bottom up, and the gaps between them.
#include "convert/moments/cut/empty_space.h"

#include <algorithm>
#include <bit>

namespace vog::moments {

Extent joined_extents(const Extents& octants, std::uint8_t mask) {
    Extent all = octants[static_cast<std::size_t>(std::countr_zero(mask))];
    for (std::size_t o = 0; o < 8; ++o) {
        if (!(mask >> o & 1)) continue;
        for (int axis = 0; axis < 3; ++axis) {
            all.lower[axis] = std::min(all.lower[axis], octants[o].lower[axis]);
            all.upper[axis] = std::max(all.upper[axis], octants[o].upper[axis]);
        }
        all.voxel = std::min(all.voxel, octants[o].voxel);
    }
    return all;
}

bool bridges(const Moments& whole, const Extent& a, const Extent& b) {
    constexpr std::array<std::size_t, 3> kDiagonal{0, 3, 5};
    for (int axis = 0; axis < 3; ++axis) {
        const double gap = std::max(a.lower[axis] - b.upper[axis], b.lower[axis] - a.upper[axis]);
        const double variance = whole.covariance[kDiagonal[static_cast<std::size_t>(axis)]];
        if (gap > 0 && gap * gap > variance) return true;
    }
    return false;
}

std::array<Extent, kBrickNodes> brick_extents(const Brick& brick) {
    std::array<Extent, kBrickNodes> extents;
    const auto cube = [&](int morton, int edge) {
        const Vec3d middle = brick_cell_center(brick, morton, edge);
        const double half = 0.5 * edge * brick.spacing;
        const Vec3d reach{half, half, half};
        return Extent{middle - reach, middle + reach, brick.voxel};
    };
    if (!brick.leaf) {
        for (std::size_t n = 0; n < kBrickNodes; ++n)
            extents[n] = n < 1   ? cube(0, 8)
                         : n < 9 ? cube(static_cast<int>(n - 1), 4)
                                 : cube(static_cast<int>(n - 9), 2);
        return extents;
    }
    std::array<std::uint8_t, kBrickNodes> occupied{};
    for (std::size_t n = kBrickNodes; n-- > 0;) {
        Extents octants;
        for (std::size_t o = 0; o < 8; ++o) {
            const std::size_t child = 8 * n + 1 + o;
            if (child < kBrickNodes) {
                octants[o] = extents[child];
                occupied[n] |= static_cast<std::uint8_t>((occupied[child] != 0) << o);
                continue;
            }
            const int morton = static_cast<int>(child - kBrickNodes);
            const Vec3i place = morton_place(morton);
            if (!(brick.sample(leaf_offset(place.x, place.y, place.z)) > 0)) continue;
            octants[o] = cube(morton, 1);
            occupied[n] |= static_cast<std::uint8_t>(1 << o);
        }
        if (occupied[n]) extents[n] = joined_extents(octants, occupied[n]);
    }
    return extents;
}

}  // namespace vog::moments
