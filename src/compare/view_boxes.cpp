// view_boxes.cpp: boxes of the mass of data, for views where most of the whole box is empty.
#include "compare/view_boxes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "core/parallel.h"

namespace vog {

using namespace comparison;

namespace comparison {

Box box_of_mass(
    const Box& whole, const Collective& collective,
    const std::function<void(const std::function<void(const Box&, double)>&)>& for_each) {
    if (whole.empty()) return whole;
    constexpr std::size_t kBins = 64;
    constexpr double kOutside = 1e-3;  // of the mass, half of it at either end of an axis
    Box box = whole;
    // Each pass narrows an axis 64-fold at most: ten reach a voxel in any box of indices.
    for (int pass = 0; pass < 10; ++pass) {
        // Masses below the box, in its bins and above, for each axis.
        constexpr std::size_t kRow = kBins + 2;
        std::vector<double> bins(3 * kRow);
        const Vec3d size = box.upper - box.lower;
        for_each([&](const Box& part, double mass) {
            for (int axis = 0; axis < 3; ++axis) {
                const auto bin_of = [&](double at) {
                    const double bin = (at - box.lower[axis]) / size[axis] * kBins;
                    return static_cast<std::size_t>(std::clamp(bin + 1, 0.0, kBins + 1.0));
                };
                if (!(size[axis] > 0)) continue;
                double* row = bins.data() + static_cast<std::size_t>(axis) * kRow;
                const std::size_t first = bin_of(part.lower[axis]), last = bin_of(part.upper[axis]);
                for (std::size_t bin = first; bin <= last; ++bin)
                    row[bin] += mass / static_cast<double>(last - first + 1);
            }
        });
        collective.sum(bins);
        Box next = box;
        bool narrower = false;
        for (int axis = 0; axis < 3; ++axis) {
            const double* row = bins.data() + static_cast<std::size_t>(axis) * kRow;
            const double total = std::accumulate(row, row + kRow, 0.0);
            if (!(total > 0)) continue;
            std::size_t first = 0, last = kRow - 1;
            double below = row[first], above = row[last];
            while (below <= 0.5 * kOutside * total && first < last) below += row[++first];
            while (above <= 0.5 * kOutside * total && last > first) above += row[--last];
            const auto edge_of = [&](std::size_t bin) {
                const auto inside = static_cast<double>(std::clamp<std::size_t>(bin, 1, kBins + 1));
                return box.lower[axis] + (inside - 1) / kBins * size[axis];
            };
            next.lower[axis] = edge_of(first), next.upper[axis] = edge_of(last + 1);
            narrower |= next.upper[axis] - next.lower[axis] < 0.5 * size[axis];
        }
        box = next;
        if (!narrower) break;
    }
    return box.radius() < 0.5 * whole.radius() ? box : whole;
}

}  // namespace comparison

namespace {

/// Leaf or tile with mass.
struct MassNode {
    std::size_t part;  ///< index of its volume
    Vec3i origin;
    Box box;      ///< world space
    double mass;  ///< density times world volume
};

void for_each_node(std::span<const Volume> volumes,
                   const std::function<void(const MassNode&)>& take) {
    for (std::size_t part = 0; part < volumes.size(); ++part) {
        const Volume& volume = volumes[part];
        const auto box_of = [&](Vec3i origin, int edge) {
            Box box;
            for (int n = 0; n < 8; ++n) {
                const Vec3i corner =
                    origin + Vec3i{n & 4 ? edge : 0, n & 2 ? edge : 0, n & 1 ? edge : 0};
                box.include(
                    volume.world_from_index(vec_cast<double>(corner) - Vec3d{0.5, 0.5, 0.5}));
            }
            return box;
        };
        const double unit = voxel_volume(volume);
        for (const Leaf& leaf : volume.leaves) {
            check_interrupt();
            double sum = 0;
            for (const float value : leaf.value) sum += value;
            if (sum > 0) take({part, leaf.origin, box_of(leaf.origin, kLeafEdge), unit * sum});
        }
        for (const Tile& tile : volume.tiles)
            if (tile.value > 0)
                take({part, tile.origin, box_of(tile.origin, tile.edge),
                      unit * tile.value * std::pow(tile.edge, 3)});
    }
}

}  // namespace

Box error_view_box(std::span<const Volume> volumes, const Box& whole,
                   const Collective* collective) {
    return box_of_mass(whole, collective_or_single(collective), [&](const auto& take) {
        for_each_node(volumes, [&](const MassNode& node) { take(node.box, node.mass); });
    });
}

namespace {

/// Box of the mass of the volumes with the smallest voxels; their edge, world units.
std::pair<Box, double> finest_level(std::span<const Volume> volumes, const Collective& collective) {
    constexpr double kRounding = 1e-3;  // of the edge
    const auto edge_of = [](const Volume& volume) { return std::cbrt(voxel_volume(volume)); };
    std::array<double, 6> bounds;
    bounds.fill(-std::numeric_limits<double>::infinity());
    double negative = bounds[0];
    for (const Volume& volume : volumes) negative = std::max(negative, -edge_of(volume));
    collective.max(std::span(&negative, 1));
    const auto is_finest = [&](const Volume& volume) {
        return edge_of(volume) <= -negative * (1 + kRounding);
    };
    for (const Volume& volume : volumes) {
        if (!is_finest(volume)) continue;
        const Box box = world_box(volume);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            bounds[axis] = std::max(bounds[axis], -box.lower[static_cast<int>(axis)]);
            bounds[3 + axis] = std::max(bounds[3 + axis], box.upper[static_cast<int>(axis)]);
        }
    }
    collective.max(bounds);
    const Box whole{{-bounds[0], -bounds[1], -bounds[2]}, {bounds[3], bounds[4], bounds[5]}};
    const Box box = box_of_mass(whole, collective, [&](const auto& take) {
        for_each_node(volumes, [&](const MassNode& node) {
            if (is_finest(volumes[node.part])) take(node.box, node.mass);
        });
    });
    return {box, -negative};
}

}  // namespace

std::vector<Camera> error_views(std::span<const Volume> volumes, const Box& whole,
                                const Collective* collective) {
    const Box seen = error_view_box(volumes, whole, collective);
    std::vector<Camera> cameras = error_views(seen);
    const auto [box, voxel] = finest_level(volumes, collective_or_single(collective));
    if (voxel >= 2 * seen.radius() / kErrorViewSize_px || box.radius() > 0.5 * seen.radius())
        return cameras;
    const std::vector<Camera> close = error_views(box);
    constexpr std::size_t kFirst = 4, kLast = 6;  // along x, y, z
    for (std::size_t view = kFirst; view <= kLast; ++view) {
        // From outside of the whole: the rays of a parallel view begin at its plane.
        const Vec3d back = cameras[view].eye - cameras[view].look_at;
        const double times = 1 + length(box.center() - seen.center()) / length(back);
        cameras[view] = close[view];
        cameras[view].eye = close[view].look_at + times * back;
    }
    return cameras;
}

BlockViews comparison::views_of_heaviest_blocks(std::span<const Volume> volumes) {
    constexpr int kBlockLog2 = 7;
    struct Block {
        Box box;
        double mass = 0;
        int views = 0;
    };
    std::map<std::array<std::int64_t, 4>, Block> blocks;
    double total = 0;
    for_each_node(volumes, [&](const MassNode& node) {
        const Vec3i at = node.origin;
        Block& block = blocks[{static_cast<std::int64_t>(node.part), at.x >> kBlockLog2,
                               at.y >> kBlockLog2, at.z >> kBlockLog2}];
        block.box.include(node.box);
        block.mass += node.mass, total += node.mass;
    });
    BlockViews views;
    views.blocks = blocks.size();
    const std::size_t count = error_views(Box{}).size();
    std::vector<Block> heaviest;
    for (const auto& [key, block] : blocks) heaviest.push_back(block);
    std::ranges::stable_sort(heaviest, std::greater{}, &Block::mass);
    if (heaviest.size() > count) heaviest.resize(count);
    for (std::size_t n = 0; n < count; ++n) {
        Block& next = *std::ranges::max_element(
            heaviest, {}, [](const Block& block) { return block.mass / (block.views + 1); });
        if (next.views++ == 0) views.mass_share += next.mass / total, ++views.viewed;
        views.cameras.push_back(error_views(next.box)[n]);
        views.radius = std::max(views.radius, next.box.radius());
    }
    return views;
}

}  // namespace vog
