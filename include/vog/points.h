// vog/points.h: particles as plain arrays, and the files they come in: text and PointDataGrids.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "vog/linear.h"
#include "vog/memory.h"

namespace vog {

/// One number a particle: a mass, a temperature.
struct PointAttribute {
    std::string name;
    BigVector<float> value;  ///< [N]
};

/// Particles in world space. Positions are doubles: a box of 50,000 kpc/h keeps its halos.
struct Points {
    BigVector<Vec3d> position;  ///< [N]
    BigVector<Vec3f> velocity;  ///< [N], or empty: not known
    std::vector<PointAttribute> attributes;
    std::string source;  ///< file they came from, for messages and model headers

    std::size_t size() const { return position.size(); }
};

/// The least box around all positions.
Box bounds(const Points& points);
/// Appends `other`. throws vog::Error unless both have the same attributes, and velocities or not
void append(Points& points, const Points& other);
/// Checks lengths and finiteness, and that there is a particle.
/// throws vog::Error naming `points.source` and the first offence
void validate(const Points& points);

/// One number a particle by name: "count" (1), "speed" (of the velocity, or the attribute of that
/// name or "velocity"), or an attribute.
/// throws vog::Error listing the names if there is none such
BigVector<float> point_values(const Points& points, const std::string& name);
/// What point_values takes for these particles: "count", "speed", ...
std::vector<std::string> point_value_names(const Points& points);

/// Edge of a cubic voxel that holds about one particle: as many to an occupied voxel as a uniform
/// scatter of one a voxel has. 1 where all particles lie in one place.
double point_voxel_size(const Points& points);

struct PointReadOptions {
    /// Of text: the columns that are x, y, z and, if there are six, the velocity's components; each
    /// by its name or by its number from 1. Empty: those called x, y, z, vx, vy, vz (or pos_x,
    /// vel_x and the like); without names the first three numbers of a line, and the next three
    /// where there are that many.
    std::vector<std::string> columns{};
    std::string grid{};  ///< of .vdb: name; empty: the only PointDataGrid
};

/// Whether a .vdb has PointDataGrids and nothing else, among the grids of this name if one is
/// given. throws vog::Error for a missing, foreign or truncated file
bool vdb_holds_points(const std::filesystem::path& file, const std::string& grid = {});

/// Reads .xyz, .txt and .dat (fields between blanks), .csv (commas, or semicolons), .tsv (tabs) and
/// the PointDataGrids of .vdb. In text, '#' and '%' begin comments, lines without a number before
/// the first particle are headers, and the last comment before it may name the columns too; .xyz
/// may begin with the number of particles and a title, as chemists have it. Columns that are
/// neither position nor velocity become attributes; those that hold text are left out.
/// Of .vdb a PointDataGrid, whatever the codecs of its attributes: P, a vector called velocity or
/// v, other numbers as attributes, other vectors by their length; leaf by leaf. throws vog::Error
/// for a missing or foreign file, no particles, unknown columns, and every line
///        that does not have as many numbers as the first: file and line, got, expected
/// cost   1 M lines of six numbers in about 0.2 s on two cores
Points read_points(const std::filesystem::path& file, const PointReadOptions& options = {});

/// Writes text by extension (.xyz: "# x y z ..." and blanks between; .csv; .tsv) that reads back
/// bit for bit, or a PointDataGrid "points" (.vdb) of point_voxel_size with P, velocity and the
/// attributes; its positions are single precision within a voxel. Written beside the file and
/// renamed.
/// throws vog::Error as validate does, and if the file cannot be written
void write_points(const std::filesystem::path& file, const Points& points);

}  // namespace vog
