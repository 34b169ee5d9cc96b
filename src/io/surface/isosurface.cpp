// isosurface.cpp: surfaces by OpenVDB's volumeToMesh.
#include <fmt/core.h>
#include <openvdb/tools/Morphology.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <cmath>
#include <limits>

#include "io/scan/scan_file.h"
#include "vog/error.h"
#include "vog/openvdb.h"
#include "vog/surface.h"
#include "vog/voxel_field.h"

namespace vog {

Surface isosurface(const Volume& volume, double value) {
    if (!(value > volume.background) || !std::isfinite(value))
        throw Error(fmt::format("isosurface: value {}, expected a number above {}", value,
                                volume.background));
    double in_tiles = 0;  // which are divided
    for (const Tile& tile : volume.tiles) in_tiles += std::pow(double(tile.edge), 3);
    if (in_tiles > double(kMaxDividedVoxels))
        throw Error(fmt::format("isosurface: {:.2g} voxels in tiles, expected at most {:.2g}",
                                in_tiles, double(kMaxDividedVoxels)));
    const openvdb::FloatGrid::Ptr grid = grid_from_volume(volume);
    // Edges are looked for at active voxels: their neighbours outside have the value 0.
    openvdb::tools::dilateActiveValues(grid->tree(), 1);
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec3I> triangles;
    std::vector<openvdb::Vec4I> quads;
    // In the lattice: places far from the origin keep their digits.
    grid->setTransform(openvdb::math::Transform::createLinearTransform());
    openvdb::tools::volumeToMesh(*grid, points, triangles, quads, value - volume.background);
    if (points.empty()) throw Error(fmt::format("isosurface: no voxel is above {}", value));
    if (points.size() > std::numeric_limits<std::uint32_t>::max())
        throw Error(fmt::format("isosurface: {} points, expected at most 2^32", points.size()));
    Surface surface;
    surface.is_ras = volume.standing == scan::kPatient;
    surface.point.reserve(points.size());
    for (const openvdb::Vec3s& p : points)
        surface.point.push_back(
            volume.world_from_index({double{p[0]}, double{p[1]}, double{p[2]}}));
    // OpenVDB's inside has the smaller values; a lattice that mirrors turns triangles once more.
    const bool turned = determinant(volume.world_from_index.linear) < 0;
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        surface.triangle.push_back(turned ? std::array{a, b, c} : std::array{a, c, b});
    };
    for (const openvdb::Vec3I& t : triangles) add(t[0], t[1], t[2]);
    for (const openvdb::Vec4I& q : quads) {
        add(q[0], q[1], q[2]);
        add(q[0], q[2], q[3]);
    }
    return surface;
}

}  // namespace vog
