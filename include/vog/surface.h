// vog/surface.h: surfaces as triangles: of one value in volumes, and of files.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "vog/volume.h"

namespace vog {

/// Triangles that share points.
struct Surface {
    std::vector<Vec3d> point;                            ///< [P] world units
    std::vector<std::array<std::uint32_t, 3>> triangle;  ///< [N] counter-clockwise from outside
    std::vector<std::array<float, 3>>
        color{};  ///< [P] red, green, blue as displayed, [0, 1]; or none
    bool is_ras =
        false;  ///< whether the world is that of a scan: x to the right, y to the front, z up
};

/// Surface around the voxels above a value, as OpenVDB's volumeToMesh finds it: closed, with values linear from one voxel centre
/// to the next and 0 in inactive voxels.
/// value   of the file, above Volume::background
/// throws  vog::Error for a value that is not above the background or that no voxel exceeds, and more than 2^32 points
[[nodiscard]] Surface isosurface(const Volume& volume, double value);

/// Writes triangles as .stl (binary), .ply (binary) or .obj, in world units; .stl and .ply have 32-bit floats. Surfaces of
/// scans state SPACE=RAS as 3D Slicer does, which takes others to be LPS.
/// throws  vog::Error for another extension, or where the file cannot be written
void write_surface(const std::filesystem::path& file, const Surface& surface);

/// Whether a file is one of read_surface: .stl, .obj, or a .ply whose header has faces.
bool is_surface_file(const std::filesystem::path& file);
/// Triangles of a .stl, .obj or .ply, with the colours of its points. Points at one place are one; polygons become triangles.
/// Axes of a comment SPACE=LPS are turned to RAS, as those of scans, which SPACE=RAS states.
/// notes   receives one on that, and one on triangles left out, whose points are not finite or lie on a line
/// throws  vog::Error for a file that cannot be read, or without triangles
[[nodiscard]] Surface read_surface(const std::filesystem::path& file,
                                   std::vector<std::string>* notes = nullptr);

}  // namespace vog
