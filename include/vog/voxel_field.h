// vog/voxel_field.h: values of a field at the voxels of a volume, the measure that weighs it.
#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "vog/memory.h"
#include "vog/volume.h"

namespace vog {

/// Values of one component at the voxels of a volume, leaf by leaf and tile by tile.
struct VoxelValues {
    /// [leaves of the volume] one value a voxel, by leaf_offset; 0 where the volume is not active.
    BigVector<std::array<float, kLeafVoxels>> leaf;
    std::vector<float> tile;  ///< [tiles of the volume]
};

/// A scalar or vector field, sampled at the voxels of a volume (the measure).
struct VoxelField {
    std::string name;                    ///< "temperature"
    std::string unit;                    ///< "K"; empty: not known
    std::vector<VoxelValues> component;  ///< 1: scalar, 3: vector, along the world's axes
    double lower = 0, upper = 0;         ///< range over the voxels; of a vector by magnitude

    bool is_vector() const { return component.size() == 3; }
};

/// Where a field of a conversion comes from.
struct FieldSource {
    std::filesystem::path file;  ///< .vdb or .nvdb
    std::string grid;            ///< grid in that file; vector grids make vector fields
    std::string name;            ///< of the field; empty: the grid's
    std::string unit;            ///< empty: from the grid's metadata, else not known
};

/// Reads a grid and samples it at the voxel centres of a volume: the nearest voxel where the lattices agree, else
/// trilinear between voxel centres; inactive voxels have the grid's background. Vectors are turned as the grid's
/// vector type states; staggered grids are averaged from their faces. Tiles of `volume` inside which the
/// field varies become leaves.
/// volume  the measure; its tiles may be divided
/// others  fields already sampled at this volume, divided with it
/// notes   receives a line where the field's grid covers only part of the volume's mass (its share)
/// throws  vog::Error as read_volume does for files and grids; for values that are NaN or infinite at voxels of
///         the volume (their count and the first place)
VoxelField read_field(const FieldSource& source, Volume& volume, std::span<VoxelField> others,
                      std::vector<std::string>* notes = nullptr);

/// The volume's own values as a field.
/// name  empty: the volume's
VoxelField own_field(const Volume& volume, const std::string& name = {});

}  // namespace vog
