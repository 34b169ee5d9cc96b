// voxel_picture.h: A picture of voxels by OptiX: volumes with a field in GPU memory, and what its rays add up.
#pragma once

#include "render/device/half_space.h"
#include "render/device/light/shading.h"
#include "render/device/voxels/value_table.h"

namespace vog::device {

/// A volume and a field at its voxels, in GPU memory.
struct VoxelVolume {
    const void* density;  ///< nanovdb::NanoGrid<float>, not empty
    /// Components of the field: grids with the nodes of `density`. None: the field is the density itself.
    const void* component[3];
    double background;  ///< of the density itself as a field: its value is the density plus this
    Double3 row[3];     ///< of the linear part of index_from_world
    Double3 corner;     ///< a point in the world ...
    Double3 corner_in_grid;  ///< ... and in index space, plus 1/2

    VOG_HD Double3 to_grid(Double3 v) const {
        return {dot(row[0], v), dot(row[1], v), dot(row[2], v)};
    }
    /// A gradient per voxel as one per world unit.
    VOG_HD Double3 to_world(Double3 g) const { return g.x * row[0] + g.y * row[1] + g.z * row[2]; }
};

enum class VoxelKind : int32_t { sums, light, maximum };

/// Volumes that one picture composites by depth at once.
constexpr int32_t kMostLitVolumes = 32;

/// Data of all rays, in GPU memory.
struct VoxelPicture {
    VoxelKind kind;
    int32_t count;              ///< volumes
    const VoxelVolume* volume;  ///< [count]
    Camera camera;              ///< world units
    int32_t samples;            ///< rays a pixel, a side
    int32_t along_rays;       ///< 1: of a vector field the component along each ray, 0: component 0
    const HalfSpace* planes;  ///< [plane_count] of the clip, world units
    int32_t plane_count;
    ValueTable transfer;
    BlinnPhong look;
    /// [height * width][4] sums over the rays of a pixel: column, first, second, reference of FirstRelative; of light
    /// colours and alpha; of a maximum its sum and the number of rays that meet voxels
    double* out;
};

}  // namespace vog::device
