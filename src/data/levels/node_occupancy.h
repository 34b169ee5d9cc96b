// node_occupancy.h: overlap tests between the leaves and tiles of volumes of different lattices.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <unordered_set>
#include <vector>

#include "vog/volume.h"

namespace vog {

/// Leaves and tiles of a volume, for overlap tests with nodes of other volumes.
class NodeOccupancy {
  public:
    struct Node {
        Vec3i origin;
        std::int32_t edge;
    };
    explicit NodeOccupancy(const Volume& volume)
        : index_from_world_(inverse(volume.world_from_index)), tiles_(volume.tiles) {
        for (const Leaf& leaf : volume.leaves) leaves_.insert(key(leaf_coordinates(leaf.origin)));
    }
    /// nodes  leaves and tiles alone: origin and edge
    NodeOccupancy(const Affine& world_from_index, std::span<const Node> nodes)
        : index_from_world_(inverse(world_from_index)) {
        for (const auto& [origin, edge] : nodes) {
            if (edge == kLeafEdge)
                leaves_.insert(key(leaf_coordinates(origin)));
            else
                tiles_.push_back({origin, edge, 0});
        }
    }
    /// Whether a node of another volume may overlap a node of this one; touching does not count.
    /// The test is conservative: it may be true for a node that does not overlap.
    bool meets(const Affine& world_from_index, Vec3i origin, std::int32_t edge) const {
        // A rotated node is replaced by its bounding box in this volume's index space.
        constexpr double kHalf = 0.5, kTouching = 1e-7;  // voxels; the latter allows for rounding
        const Affine here_from_there{index_from_world_.linear * world_from_index.linear,
                                     index_from_world_(world_from_index.translation)};
        const double size = edge;
        const Vec3d lower = vec_cast<double>(origin) - Vec3d{kHalf, kHalf, kHalf};
        const Box box = transformed(here_from_there, {lower, lower + Vec3d{size, size, size}});
        const Vec3d shrink{kTouching, kTouching, kTouching};
        return meets({box.lower + shrink, box.upper - shrink});
    }

  private:
    /// Leaf coordinates, 21 bits per axis. OpenVDB's have 29, so distant leaves may share a key;
    /// the test then only selects a node too many, which is harmless.
    static std::uint64_t key(Vec3i leaf) {
        constexpr std::uint64_t kMask = (1 << 21) - 1;
        return (static_cast<std::uint64_t>(leaf.x) & kMask) << 42 |
               (static_cast<std::uint64_t>(leaf.y) & kMask) << 21 |
               (static_cast<std::uint64_t>(leaf.z) & kMask);
    }
    static Vec3i leaf_coordinates(Vec3i origin) {
        return {origin.x >> 3, origin.y >> 3, origin.z >> 3};
    }
    static std::int32_t leaf_at(double index) {
        return static_cast<std::int32_t>(std::floor((index + 0.5) / kLeafEdge));
    }

    bool meets(const Box& box) const {
        for (const Tile& tile : tiles_) {
            bool apart = false;
            for (int axis = 0; axis < 3; ++axis)
                apart |= box.upper[axis] < tile.origin[axis] - 0.5 ||
                         box.lower[axis] > tile.origin[axis] - 0.5 + tile.edge;
            if (!apart) return true;
        }
        const Vec3i first{leaf_at(box.lower.x), leaf_at(box.lower.y), leaf_at(box.lower.z)};
        const Vec3i last{leaf_at(box.upper.x), leaf_at(box.upper.y), leaf_at(box.upper.z)};
        // A node over more leaves than this is selected without a search: selecting it is harmless.
        constexpr double kMaxLookups = 4096;
        if (double(last.x - first.x + 1) * (last.y - first.y + 1) * (last.z - first.z + 1) >
            kMaxLookups)
            return true;
        for (std::int32_t x = first.x; x <= last.x; ++x)
            for (std::int32_t y = first.y; y <= last.y; ++y)
                for (std::int32_t z = first.z; z <= last.z; ++z)
                    if (leaves_.contains(key({x, y, z}))) return true;
        return false;
    }

    Affine index_from_world_;
    std::unordered_set<std::uint64_t> leaves_;
    std::vector<Tile> tiles_;
};

}  // namespace vog
