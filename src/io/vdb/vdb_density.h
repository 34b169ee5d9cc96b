// vdb_density.h: conversion of OpenVDB values, leaves and tiles to density.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "io/vdb/vdb_grid.h"
#include "vog/volume_io.h"

namespace vog::vdb {

inline Vec3i from_coord(const openvdb::Coord& c) { return {c.x(), c.y(), c.z()}; }
inline openvdb::Coord to_coord(Vec3i v) { return {v.x, v.y, v.z}; }

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

/// Counts of invalid active values; a tile is one value.
struct Census {
    std::uint64_t negative = 0, not_finite = 0;
    /// Smallest `place` of a value that is not finite.
    std::uint64_t first_not_finite = std::numeric_limits<std::uint64_t>::max();

    /// Counts an invalid value and returns 0 for it; returns other values unchanged.
    /// place  position of the value among all
    float admit(float value, std::uint64_t place) {
        if (!std::isfinite(value)) {
            ++not_finite;
            first_not_finite = std::min(first_not_finite, place);
            return 0;
        }
        if (value < 0) {
            ++negative;
            return 0;
        }
        return value;
    }
    static Census sum(Census a, const Census& b) {
        a.negative += b.negative;
        a.not_finite += b.not_finite;
        a.first_not_finite = std::min(a.first_not_finite, b.first_not_finite);
        return a;
    }
};

/// Converts an OpenVDB leaf to a volume's leaf.
/// i  index of the leaf in the volume
template <class LeafT>
void convert_leaf(const LeafT& from, std::size_t i, Leaf& to, Census& census) {
    to.origin = from_coord(from.origin());
    for (openvdb::Index word = 0; word < to.mask.size(); ++word)
        to.mask[word] = from.valueMask().template getWord<openvdb::Index64>(word);
    for (auto voxel = from.cbeginValueOn(); voxel; ++voxel)
        to.value[voxel.pos()] = census.admit(density(*voxel), i * kLeafVoxels + voxel.pos());
}

/// Converts active tiles to volume.tiles, sorted by origin.
Census tiles_from_grid(const openvdb::GridBase& grid, Volume& volume);

/// Records the number of negative values in `notes`.
/// throws vog::Error for values that are not finite
void check_census(const Census& leaves, const Census& tiles, std::span<const Leaf> volume_leaves,
                  std::span<const Tile> volume_tiles, const std::string& where, VdbNotes& notes);
/// throws vog::Error for a transform that is singular or null (not affine)
void check_transform(const std::optional<Affine>& world_from_index, const std::string& where);
/// Sets values above 0 to 1 and makes all others inactive.
void keep_positive(Volume& volume);

}  // namespace vog::vdb
