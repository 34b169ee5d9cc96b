// world_shape.h: how a Gaussian with axes along the index axes, or a covariance, lies in world
// space.
#pragma once

#include <array>

#include "vog/linear.h"

namespace vog::paper {

/// Standard deviations along the own axes, and the rotation from own axes to world axes.
struct WorldShape {
    Vec3d scale;
    Quat rotation;
};

/// What a world_from_index map does to Gaussians whose own axes are the index axes.
struct WorldFrame {
    enum class Kind {
        aligned,     ///< index axes fall on world axes (mirrored, swapped or not): no rotation
        orthogonal,  ///< index axes stay perpendicular: one rotation for all Gaussians
        sheared,     ///< each shape has eigenvectors of its own
    };
    Affine world_from_index;
    Kind kind = Kind::aligned;
    Vec3d column_length{1, 1, 1};               ///< world length of a step along each index axis
    std::array<int, 3> index_axis = {0, 1, 2};  ///< aligned: the index axis on each world axis
    Quat rotation;                              ///< orthogonal: index axes, normalised
};

/// Angles below 1e-6 rad count as none: across a leaf they move nothing by more than 1e-5 voxel,
/// which is what a float32 quaternion resolves.
WorldFrame world_frame(const Affine& world_from_index);

/// Shape in world space of an index-axis Gaussian with these standard deviations, in voxels.
WorldShape world_shape(const WorldFrame& frame, Vec3d deviation_voxels);

/// Shape of the Gaussian with this covariance; variances below 1e-12 of the largest are raised to
/// that, so that a flat or rounded covariance still has positive scales.
WorldShape shape_from_covariance(const Mat3& covariance);

}  // namespace vog::paper
