// vdb_density.h: conversion of OpenVDB values, leaves and tiles to density.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "io/vdb/vdb_grid.h"
#include "vog/volume_io.h"

namespace vog::vdb {

inline Vec3i from_coord(const openvdb::Coord& c) { return {c.x(), c.y(), c.z()}; }
inline openvdb::Coord to_coord(Vec3i v) { return {v.x, v.y, v.z}; }

/// Voxel of an offset in a leaf, relative to the leaf's origin.
inline Vec3i offset_index(int offset) { return {offset >> 6, (offset >> 3) & 7, offset & 7}; }

/// Density of a value: the number itself, or the length of a vector.
template <class Value>
float density(const Value& value) {
    if constexpr (openvdb::VecTraits<Value>::IsVec) {
        const openvdb::Vec3d v(value);
        return density(std::sqrt(v.x() * v.x() + v.y() * v.y() + v.z() * v.z()));
    } else if constexpr (std::is_same_v<Value, double>) {
        // Conversion beyond float's range is undefined behaviour: such values become infinite.
        constexpr double kLargest = std::numeric_limits<float>::max();
        if (std::abs(value) > kLargest) return std::numeric_limits<float>::infinity();
        return static_cast<float>(value);
    } else {
        return static_cast<float>(value);
    }
}

/// Counts of invalid values; a tile is one value.
struct Census {
    /// Active values of one kind, with the first of them.
    struct Count {
        std::uint64_t values = 0;
        std::uint64_t first = std::numeric_limits<std::uint64_t>::max();  ///< position among all
        Vec3i index{};                                                    ///< voxel of `first`

        void add(std::uint64_t place, Vec3i at) {
            ++values;
            if (place >= first) return;
            first = place;
            index = at;
        }
        void add(const Count& other) {
            values += other.values;
            if (other.first >= first) return;
            first = other.first;
            index = other.index;
        }
    };
    Count negative, not_finite;
    std::uint64_t inactive_not_finite = 0;

    /// Counts an invalid value and returns 0 for it; returns other values unchanged.
    /// place  position of the value among all
    /// index  its voxel
    float admit(float value, std::uint64_t place, Vec3i index) {
        if (!std::isfinite(value)) {
            not_finite.add(place, index);
            return 0;
        }
        if (value < 0) {
            negative.add(place, index);
            return 0;
        }
        return value;
    }
    static Census sum(Census a, const Census& b) {
        a.negative.add(b.negative);
        a.not_finite.add(b.not_finite);
        a.inactive_not_finite += b.inactive_not_finite;
        return a;
    }
};

/// Converts an OpenVDB leaf to a volume's leaf. Values that are not finite become inactive.
/// i  index of the leaf in the volume
template <class LeafT>
void convert_leaf(const LeafT& from, std::size_t i, Leaf& to, Census& census) {
    to.origin = from_coord(from.origin());
    for (auto voxel = from.cbeginValueOn(); voxel; ++voxel) {
        const auto offset = static_cast<int>(voxel.pos());
        const float value = density(*voxel);
        const float admitted =
            census.admit(value, i * kLeafVoxels + voxel.pos(), to.origin + offset_index(offset));
        if (std::isfinite(value)) to.set(offset, admitted);
    }
    for (auto voxel = from.cbeginValueOff(); voxel; ++voxel)
        census.inactive_not_finite += !std::isfinite(density(*voxel));
}

/// Calls visit(origin, edge, value) for every active tile; edge in voxels. From node to node:
/// OpenVDB's iterators of values count the root's entries again at each of them.
template <class Tree, class Visit>
void for_each_tile(const Tree& tree, const Visit& visit) {
    const auto visit_node = [&](const auto& node, std::int32_t edge) {
        for (auto tile = node.cbeginValueOn(); tile; ++tile)
            visit(from_coord(tile.getCoord()), edge, *tile);
    };
    visit_node(tree.root(), 4096);
    for (auto upper = tree.root().cbeginChildOn(); upper; ++upper) {
        visit_node(*upper, 128);
        for (auto lower = upper->cbeginChildOn(); lower; ++lower) visit_node(*lower, 8);
    }
}

/// Sorts tiles by origin, sets invalid values to 0 and counts them; drops tiles not finite.
Census admit_tiles(std::vector<Tile>& tiles);
/// Converts active tiles to volume.tiles, as admit_tiles leaves them.
Census tiles_from_grid(const openvdb::GridBase& grid, Volume& volume);

/// Sum in which values of tiles lie behind those of leaves.
Census leaves_then_tiles(const Census& leaves, Census tiles);
/// Records changed values in `notes`.
/// rules  values to accept
/// throws vog::Error for values that are not finite, or negative, unless `rules` accept them
void check_census(const Census& census, const ValueRules& rules, const std::string& where,
                  ValueNotes& notes);
/// Drops leaves without active voxels.
void drop_empty_leaves(Volume& volume);
/// throws vog::Error for a transform that is singular or null (not affine)
void check_transform(const std::optional<Affine>& world_from_index, const std::string& where);
/// Sets values above 0 to 1 and makes all others inactive.
void keep_positive(Volume& volume);
/// Sets all active values to 1, of which no negative one is then a change.
void set_ones(Volume& volume, ValueNotes& notes);
/// Values that a reader accepts: of a mask negative ones, of VdbOptions::ones all.
ValueRules value_rules(const VdbOptions& options);

}  // namespace vog::vdb
