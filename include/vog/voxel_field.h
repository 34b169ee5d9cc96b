// vog/voxel_field.h: values of a field at the voxels of a volume, the measure that weighs it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "vog/memory.h"
#include "vog/value_counts.h"
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
    ValueCounts counts{};                ///< values of a scalar field by mass; may be empty
    double background = 0;  ///< Volume::background, where the values are the volume's own

    bool is_vector() const { return component.size() == 3; }
};

/// Where a field of a conversion comes from.
struct FieldSource {
    std::filesystem::path file{};  ///< .vdb or .nvdb; empty: the measure's (field_of_level)
    std::string grid{};            ///< its grid; empty: the only scalar one, else "density"
    std::string name{};            ///< name of the field; empty: the grid's
    std::string unit{};            ///< empty: from the grid's metadata, else not known
};

struct LevelSource;
/// Source of a field at one level of a mesh, or at a single volume: the level's file if the field
/// has none; a * in the field's grid stands for the text that the * of `pattern` matched.
/// pattern  LevelOptions::grid, by which level_sources found the level
/// throws   vog::Error for a * in the field's grid without one in the pattern
FieldSource field_of_level(const FieldSource& field, const std::string& pattern,
                           const LevelSource& level);

/// Most voxels of tiles that read_field divides into leaves.
inline constexpr std::uint64_t kMaxDividedVoxels = std::uint64_t{1} << 28;

/// Part of a volume at which a grid is active. Sums of several parts are those of the whole.
struct FieldCoverage {
    std::string grid, volume;           ///< for messages: "fire.vdb: grid 'temperature'"
    double mass = 0, covered_mass = 0;  ///< sums of density, in all and where the grid is active
    double voxels = 0, covered_voxels = 0;  ///< the same, in voxels
    void add(const FieldCoverage& other);
};
/// Line that says where the background counts, from a thousandth of the mass on; else empty.
/// throws  vog::Error where the grid is active at no voxel
std::string coverage_note(const FieldCoverage& coverage);

/// Name of the field that read_field would return, from the file's list of grids.
/// throws  vog::Error for a file that cannot be opened and a grid that it lacks
std::string field_name(const FieldSource& source);

/// Reads a grid of numbers or vectors of any sign and samples it at the voxel centres of a volume:
/// the same voxel where the centres of both lattices agree to a thousandth of a voxel, whatever their axes, else trilinear between voxel
/// centres. An inactive voxel has the grid's background; in a level set the value stored there,
/// which has the sign. Masks are 0 and 1. Vectors are along the world's axes as stored, which is
/// OpenVDB's default; those in local space are mapped as their vector type states. Staggered
/// vectors are averaged from the faces of a voxel to its centre, of active ones where there are.
/// volume  the measure; its tiles inside which the field varies are divided, into smaller ones and
///         leaves
/// others  fields already sampled at this volume, divided with it
/// notes   receives coverage_note; null: not reported
/// coverage
///         receives the counts of a part of a volume, without note and error; null: a whole volume
/// throws  vog::Error as read_volume does for files and grids; for values that are NaN or infinite at
///         voxels of the volume (their count and the first index), for a grid that is active at none
///         of them, for tiles of more than kMaxDividedVoxels to divide
/// cost    the grid in memory; on two cores some 40 ns a voxel in the same lattice, 0.5 us in others
VoxelField read_field(const FieldSource& source, Volume& volume, std::span<VoxelField> others = {},
                      std::vector<std::string>* notes = nullptr, FieldCoverage* coverage = nullptr);

/// Dense values of a field in the caller's memory: a box of voxels, all active.
struct FieldBlock {
    const float* value = nullptr;  ///< value of the voxel at `first`, any sign
    Vec3i size;                    ///< voxels along x, y, z, >= 1
    std::array<std::ptrdiff_t, 4>
        stride{};  ///< floats to the next voxel along x, y, z, and to the next component
    Vec3i first;   ///< least index of the box, within +-2^30
};
/// A field in memory, on a lattice of its own.
struct FieldValues {
    std::string name;                  ///< "temperature"
    std::string unit;                  ///< "K"; empty: not known
    Affine world_from_index;           ///< from voxel indices to world units
    int components = 1;                ///< 1: scalar; 3: vector, along the world's axes
    std::vector<FieldBlock> blocks{};  ///< where they overlap, the last one counts
};
/// Samples a field in memory at the voxel centres of a volume, as read_field does; its background is 0.
/// throws  vog::Error as read_field does, and for blocks or components out of range
VoxelField sample_field(const FieldValues& field, Volume& volume, std::span<VoxelField> others = {},
                        std::vector<std::string>* notes = nullptr);
/// The same of another volume's densities.
VoxelField sample_field(const Volume& field, const std::string& name, Volume& volume,
                        std::span<VoxelField> others = {},
                        std::vector<std::string>* notes = nullptr);

/// Counts of a scalar field's values at the voxels of its volume.
ValueCounts value_counts(const Volume& volume, const VoxelValues& values);
/// The volume's own values as a field: its densities plus Volume::background.
/// name  empty: the volume's
VoxelField own_field(const Volume& volume, const std::string& name = {});
/// The same for add_fields, without a copy: its component is empty, which stands for the volume's own
/// values.
VoxelField measure_field(const Volume& volume, const std::string& name = {});

/// Writes a volume and fields at its voxels as grids of one file: OpenVDB (.vdb) or NanoVDB (.nvdb) by extension, vectors
/// as vec3s grids. Leaves are written one at a time to .vdb; a .nvdb file is made in memory.
/// fields  at the voxels of `volume`; names differ from each other and from the volume's
/// throws  vog::Error for an invalid or empty volume, equal or empty names, another extension, or if the file cannot
///         be written
void write_voxels(const std::filesystem::path& file, const Volume& volume,
                  std::span<const VoxelField> fields = {});
/// A volume and fields at its voxels.
struct VoxelGrids {
    const Volume* volume;
    std::span<const VoxelField> fields;
};
/// The same of several volumes, the levels of a mesh: names differ among all grids.
void write_voxels(const std::filesystem::path& file, std::span<const VoxelGrids> volumes);

}  // namespace vog
