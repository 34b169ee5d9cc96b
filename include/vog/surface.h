// vog/surface.h: surfaces of one value in volumes as triangles, and files of them.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "vog/volume.h"

namespace vog {

/// Triangles that share points.
struct Surface {
    std::vector<Vec3d> point;                            ///< [P] world units
    std::vector<std::array<std::uint32_t, 3>> triangle;  ///< [N] counter-clockwise from outside
};

/// Surface around the voxels above a value, as OpenVDB's volumeToMesh finds it: closed, with values linear from one voxel centre
/// to the next and 0 in inactive voxels.
/// value   of the file, above Volume::background
/// throws  vog::Error for a value that is not above the background or that no voxel exceeds, and more than 2^32 points
[[nodiscard]] Surface isosurface(const Volume& volume, double value);

/// Writes triangles as .stl (binary), .ply (binary) or .obj, in world units; .stl and .ply have 32-bit floats.
/// throws  vog::Error for another extension, or where the file cannot be written
void write_surface(const std::filesystem::path& file, const Surface& surface);

}  // namespace vog
