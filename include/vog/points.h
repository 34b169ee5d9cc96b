// vog/points.h: particles as plain arrays, and their files: text and OpenVDB's PointDataGrids.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "vog/linear.h"
#include "vog/memory.h"
#include "vog/voxel_values.h"

namespace vog {

/// Attribute of particles, one number each: a mass, a temperature.
struct PointAttribute {
    std::string name;        ///< name of the column or of the grid's attribute
    BigVector<float> value;  ///< [N] numbers of the file divided by `unit`; NaN: missing
    double unit = 1;  ///< power of ten where the file's numbers are beyond or below float's range
    std::string unit_name{};  ///< unit of the file's numbers: "K"; empty: not known
};

/// Particles in world space. Positions are doubles, so that a box of 50,000 kpc/h keeps its halos.
struct Points {
    BigVector<Vec3d> position;  ///< [N] world units
    BigVector<Vec3f> velocity;  ///< [N] in the unit of the file, NaN: missing; empty: unknown
    std::vector<PointAttribute> attributes;  ///< in the order of the file
    std::string source;  ///< file of origin, for messages and model headers; empty: none
    Box box;  ///< periodic box that the file states (BoxSize of a snapshot); empty: not stated
    std::string length_unit{},
        velocity_unit{};  ///< as the file states them: "kpc", "km/s"; empty: not known

    std::size_t size() const { return position.size(); }  ///< N
};

/// Smallest axis-aligned box around all positions, world units; empty for no particles.
Box bounds(const Points& points);
/// Appends `other`. Where powers of ten that divide an attribute differ, all its values take the larger one.
/// throws  vog::Error unless both have the same attributes, both velocities or neither, and all in the same units or without
void append(Points& points, const Points& other);
/// Checks the lengths of the arrays, that all numbers are finite or missing (NaN; positions are never missing), and N, 1 to
/// 2^31 - 1.
/// throws  vog::Error naming `points.source` and the first offence
void validate(const Points& points);

/// Values of the particles, [N], by name: "count" (1 for each), "speed" (length of the velocity; an
/// attribute "speed" or "velocity" where there is none), or the name of an attribute.
/// missing  values may be missing (NaN)
/// throws   vog::Error listing the names for an unknown one, and naming the first particle without a value
BigVector<float> point_values(const Points& points, const std::string& name, bool missing = false);
/// Unit of the values that point_values has of a name: "1" of "count", "1e+40 g" of an attribute in g that is divided by 1e40;
/// empty: not known.
std::string point_value_unit(const Points& points, const std::string& name);
/// throws  vog::Error naming the first particle for which a value is missing (NaN)
void require_values(const Points& points, const std::string& name, const BigVector<float>& values);
/// Attribute with the radii at which the kernels of smoothed-particle hydrodynamics end, and the factor from its numbers
/// to that radius: SmoothingLength (Gadget), smoothing_length or hsml, factor 1; SmoothingLengths (SWIFT), 1.825742, of its
/// cubic spline. Empty: the particles have none.
struct SmoothingRadius {
    std::string name{};
    double factor = 1;
};
SmoothingRadius smoothing_radius(const Points& points);
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
    /// in a file without names the first three numbers of a line, and of six the others as velocity (.pts, .asc: never).
    std::vector<std::string> columns{};
    /// Name of the PointDataGrid in a .vdb, or of the type of particles in a snapshot; empty: the only one, else gas
    /// (PartType0), else the largest.
    std::string grid{};
    ValueRules values{};          ///< skip_nonfinite: leave out particles with a number not finite
    bool refuse_several = false;  ///< as VdbOptions::refuse_several
};

/// Whether a .vdb has PointDataGrids and no other grids.
/// grid    name: only grids of this name are considered; empty: all
/// throws  vog::Error for a missing, foreign or truncated file
bool vdb_holds_points(const std::filesystem::path& file, const std::string& grid = {});

/// Types of the particles of a snapshot (.hdf5) that have positions: "PartType0", ...; empty for other files.
/// throws  vog::Error for a missing, foreign or truncated file
std::vector<std::string> point_types(const std::filesystem::path& file);

/// Whether a file has an extension of particles in text or of a snapshot, such as .xyz or .hdf5. A .vdb may hold either.
bool is_points_file(const std::filesystem::path& file);

/// Reads particles from text (.xyz, .extxyz, .pts, .asc, .txt, .dat, .csv, .ecsv, .tsv; each also with .gz), a PointDataGrid (.vdb) or
/// a snapshot (.hdf5).
///   text  fields between blanks, commas, semicolons or tabs, whichever the lines have. '#', '%' and '//' begin comments; lines
///         end in LF, CR LF or CR. A line above the particles, or a comment, names the columns. The number of particles may stand
///         in a line of its own; in an .xyz a title follows, as in chemistry, with the columns of extended XYZ (Properties=).
///         Columns of numbers other than position and velocity become attributes; columns of text are left out. An empty field of
///         an attribute or velocity is missing (NaN).
///   .vdb  Attributes of every codec: P as position; a vector called velocity or v as velocity;
///         other numbers as attributes; other vectors by their length. Particles in the order of
///         leaves.
/// notes   is increased by the number of particles left out; null: not counted
/// throws  vog::Error for a missing or foreign file, no particles, unknown columns, names of columns that do not fit the lines,
///         a stated number of particles that is not theirs (a count, NumPart_ThisFile), every line with another count of numbers than the first: file and
///         line, got, expected; and for infinite numbers and positions of NaN, unless options.values accepts them
/// cost    1 M lines of six numbers in about 0.2 s on two cores
Points read_points(const std::filesystem::path& file, const PointReadOptions& options = {},
                   ValueNotes* notes = nullptr);

/// Reads several files as one set, in their order: parts of a snapshot may lack the type of particles that others have.
/// notes   receives a line on the choice among several types, on every file's particles that were left out, on columns read by their places, on parts without
///         the type, on snapshots of more files than these, and on attributes in units of their own; null: none
/// throws  vog::Error as read_points and append do, and for a file that is named twice
Points read_points(std::span<const std::filesystem::path> files, const PointReadOptions& options,
                   std::vector<std::string>* notes);

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
