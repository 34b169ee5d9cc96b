// volume.cpp: counts, mass, bounding boxes, sorting and validation of sparse volumes.
#include "vog/volume.h"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/parallel.h"
#include "vog/error.h"

namespace vog {

namespace {

std::uint64_t cube(std::int64_t edge) { return static_cast<std::uint64_t>(edge * edge * edge); }

constexpr auto by_origin = [](const auto& a, const auto& b) {
    return std::tie(a.origin.x, a.origin.y, a.origin.z) <
           std::tie(b.origin.x, b.origin.y, b.origin.z);
};

std::string text(Vec3i index) { return fmt::format("[{}, {}, {}]", index.x, index.y, index.z); }

}  // namespace

std::uint64_t active_voxels(const Volume& volume) {
    std::uint64_t count = 0;
    for (const Leaf& leaf : volume.leaves) {
        check_interrupt();
        count += static_cast<std::uint64_t>(leaf.active_count());
    }
    for (const Tile& tile : volume.tiles) count += cube(tile.edge);
    return count;
}

std::uint64_t bounding_voxels(const Volume& volume) {
    const Box box = index_box(volume);
    if (box.empty()) return 0;
    const Vec3d size = box.upper - box.lower;
    return static_cast<std::uint64_t>(std::llround(size.x * size.y * size.z));
}

double voxel_volume(const Volume& volume) {
    return std::abs(determinant(volume.world_from_index.linear));
}

double mass(const Volume& volume) {
    double sum = 0;
    for (const Leaf& leaf : volume.leaves) {
        check_interrupt();
        double leaf_sum = 0;
        for (int n = 0; n < kLeafVoxels; ++n)
            if (leaf.active(n)) leaf_sum += leaf.value[static_cast<std::size_t>(n)];
        sum += leaf_sum;
    }
    for (const Tile& tile : volume.tiles)
        sum += static_cast<double>(tile.value) * static_cast<double>(cube(tile.edge));
    return sum * voxel_volume(volume);
}

Box index_box(const Volume& volume) {
    Box box;
    const auto include = [&box](Vec3i origin, int edge) {
        const Vec3d first = vec_cast<double>(origin) - Vec3d{0.5, 0.5, 0.5};
        const double size = edge;
        box.include(first);
        box.include(first + Vec3d{size, size, size});
    };
    for (const Leaf& leaf : volume.leaves) {
        check_interrupt();
        include(leaf.origin, kLeafEdge);
    }
    for (const Tile& tile : volume.tiles) include(tile.origin, tile.edge);
    return box;
}

Box world_box(const Volume& volume) {
    return transformed(volume.world_from_index, index_box(volume));
}

void sort_nodes(Volume& volume) {
    // Leaves are 2 kB each: sorted ones are left untouched.
    bool sorted = true;
    for (std::size_t i = 1; sorted && i < volume.leaves.size(); ++i) {
        check_interrupt();
        sorted = by_origin(volume.leaves[i - 1], volume.leaves[i]);
    }
    if (!sorted) {
        std::vector<std::size_t> order(volume.leaves.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::ranges::sort(order, [&](std::size_t a, std::size_t b) {
            check_interrupt();
            return by_origin(volume.leaves[a], volume.leaves[b]);
        });
        // Each moves once, around the cycles of the order.
        for (std::size_t first = 0; first < order.size(); ++first) {
            if (order[first] == first) continue;
            const Leaf kept = volume.leaves[first];
            std::size_t to = first;
            for (std::size_t from; (from = std::exchange(order[to], to)) != first; to = from)
                volume.leaves[to] = volume.leaves[from];
            volume.leaves[to] = kept;
        }
    }
    std::sort(volume.tiles.begin(), volume.tiles.end(), by_origin);
}

void validate(const Volume& volume) {
    const auto fail = [&](const std::string& what) {
        throw Error(fmt::format("{}: {}", volume.source.empty() ? "volume" : volume.source, what));
    };
    const double det = determinant(volume.world_from_index.linear);
    const Vec3d shift = volume.world_from_index.translation;
    if (!std::isfinite(det) || det == 0 || !std::isfinite(shift.x + shift.y + shift.z))
        fail("the transform is singular or not finite, expected an invertible affine map");
    const auto check = [&](float value, Vec3i index) {
        if (!std::isfinite(value) || value < 0)
            fail(fmt::format("density {} at voxel {}, expected finite and >= 0", value,
                             text(index)));
    };
    for (std::size_t i = 0; i < volume.leaves.size(); ++i) {
        check_interrupt();
        const Leaf& leaf = volume.leaves[i];
        for (int axis = 0; axis < 3; ++axis)
            if (leaf.origin[axis] & (kLeafEdge - 1))
                fail(fmt::format("leaf origin {}, expected multiples of 8", text(leaf.origin)));
        if (i > 0 && !by_origin(volume.leaves[i - 1], leaf))
            fail(fmt::format("leaf {} is out of order or doubled", text(leaf.origin)));
        for (int n = 0; n < kLeafVoxels; ++n)
            check(leaf.value[static_cast<std::size_t>(n)],
                  leaf.origin + Vec3i{n >> 6, (n >> 3) & 7, n & 7});
    }
    for (const Tile& tile : volume.tiles) {
        if (tile.edge != 8 && tile.edge != 128 && tile.edge != 4096)
            fail(fmt::format("tile edge {}, expected 8, 128 or 4096", tile.edge));
        check(tile.value, tile.origin);
    }
}

}  // namespace vog
