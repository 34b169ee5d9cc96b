// vog/points.h: particles as plain arrays, and their files: text and OpenVDB's PointDataGrids.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "vog/linear.h"
#include "vog/memory.h"
#include "vog/voxel_values.h"

namespace vog {

/// Attribute of particles, one number each: a mass, a temperature.
struct PointAttribute {
    std::string name;        ///< name of the column or of the grid's attribute
    BigVector<float> value;  ///< [N] finite, in the unit of the file
};

/// Particles in world space. Positions are doubles, so that a box of 50,000 kpc/h keeps its halos.
struct Points {
    BigVector<Vec3d> position;               ///< [N] world units
    BigVector<Vec3f> velocity;               ///< [N] in the unit of the file; empty: unknown
    std::vector<PointAttribute> attributes;  ///< in the order of the file
    std::string source;  ///< file of origin, for messages and model headers; empty: none

    std::size_t size() const { return position.size(); }  ///< N
};

/// Smallest axis-aligned box around all positions, world units; empty for no particles.
Box bounds(const Points& points);
/// Appends `other`.
/// throws  vog::Error unless both have the same attributes, and both velocities or neither
void append(Points& points, const Points& other);
/// Checks the lengths of the arrays, that all numbers are finite, and N, 1 to 2^31 - 1.
/// throws  vog::Error naming `points.source` and the first offence
void validate(const Points& points);

/// Values of the particles, [N], by name: "count" (1 for each), "speed" (length of the velocity; an
/// attribute "speed" or "velocity" where there is none), or the name of an attribute.
/// throws  vog::Error listing the names for an unknown one
BigVector<float> point_values(const Points& points, const std::string& name);
/// Names that point_values takes for these particles: "count", "speed", ...
std::vector<std::string> point_value_names(const Points& points);

/// Edge of a cubic voxel that holds about one particle, world units: an occupied voxel has 1.58
/// particles, as in a uniform random scatter of one per voxel. 1 where all positions are equal.
/// throws  vog::Error as validate does
double point_voxel_size(const Points& points);

/// Options of read_points.
struct PointReadOptions {
    /// Columns of a text file for x, y, z or for x, y, z, vx, vy, vz, each by its name or its
    /// number from 1. Empty: the columns called x, y, z, vx, vy, vz (or pos_x, vel_x and the like);
    /// in a file without names the first three numbers of a line, and the next three as velocity.
    std::vector<std::string> columns{};
    std::string grid{};   ///< name of the grid in a .vdb; empty: its only PointDataGrid
    ValueRules values{};  ///< skip_nonfinite: leave out particles with a number not finite
};

/// Whether a .vdb has PointDataGrids and no other grids.
/// grid    name: only grids of this name are considered; empty: all
/// throws  vog::Error for a missing, foreign or truncated file
bool vdb_holds_points(const std::filesystem::path& file, const std::string& grid = {});

/// Reads particles from text, by extension: .xyz, .txt and .dat (fields between blanks), .csv
/// (commas or semicolons), .tsv (tabs), or from a PointDataGrid (.vdb).
///   text  '#' and '%' begin comments. Lines without a number before the first particle are
///         headers; the last comment before it may name the columns too. An .xyz may begin with the
///         number of particles and a title, as in chemistry. Columns of numbers other than position
///         and velocity become attributes; columns of text are left out.
///   .vdb  Attributes of every codec: P as position; a vector called velocity or v as velocity;
///         other numbers as attributes; other vectors by their length. Particles in the order of
///         leaves.
/// notes   is increased by the number of particles left out; null: not counted
/// throws  vog::Error for a missing or foreign file, no particles, unknown columns, every line
///         with another count of numbers than the first: file and line, got, expected; and for
///         numbers not finite, unless options.values accepts them
/// cost    1 M lines of six numbers in about 0.2 s on two cores
Points read_points(const std::filesystem::path& file, const PointReadOptions& options = {},
                   ValueNotes* notes = nullptr);

/// Sets the negative values of an attribute to 0.
/// name     of an attribute; others, such as "count", have no negative values
/// returns  number of changed values
std::uint64_t clip_negative(Points& points, const std::string& name);

/// Writes particles, by extension: text that reads back bit for bit (.xyz with a line "# x y z ..."
/// and blanks between; .csv; .tsv), or a PointDataGrid "points" (.vdb) of voxels of
/// point_voxel_size with P, velocity and the attributes, its positions in single precision within a
/// voxel. Written beside the file and renamed when whole.
/// throws  vog::Error as validate does, for another extension, and if the file cannot be written
void write_points(const std::filesystem::path& file, const Points& points);

}  // namespace vog
