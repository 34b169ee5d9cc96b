// points_files.h: readers and writers of each particle format, behind read_points and write_points.
#pragma once

#include "io/grid_choice.h"
#include "vog/points.h"

namespace vog::point_files {

/// Whether the extension is that of particles in text: .xyz, .txt, ..., also with .gz.
bool is_text(const std::filesystem::path& file);
/// note  receives the columns that are read by their places, without names; null: not reported
Points read_points_text(const std::filesystem::path& file, const PointReadOptions& options,
                        std::string* note = nullptr);
void write_points_text(const std::filesystem::path& file, const Points& points);

/// note  receives the choice among several grids; null: not reported
Points read_points_vdb(const std::filesystem::path& file, const PointReadOptions& options,
                       std::string* note = nullptr);
void write_points_vdb(const std::filesystem::path& file, const Points& points);

/// Whether the extension is .hdf5, .h5 or .hdf.
bool is_hdf5(const std::filesystem::path& file);
/// Particles of one type (PartType0, ...) of a snapshot of Gadget, Arepo, Gizmo or SWIFT.
/// throws  vog::Error as read_points does, and in a build without libhdf5
Points read_points_hdf5(const std::filesystem::path& file, const PointReadOptions& options);
/// Types of particles that have positions, and the number of their particles.
struct ParticleTypes {
    std::vector<std::string> name;
    std::vector<double> particles;
};
ParticleTypes types_of_hdf5(const std::filesystem::path& file);
/// Type that is meant where none is named: gas, else the largest.
LikelyGrid likely_type(const std::string& file, const ParticleTypes& types, bool refuse);
/// Files of the snapshot that a file belongs to, and the particles of one type in all of them; 0: not stated.
struct SnapshotPart {
    double files = 1, particles = 0;
};
SnapshotPart part_of_hdf5(const std::filesystem::path& file, const std::string& type);

}  // namespace vog::point_files
