// world_shape.h: scales and rotation in world space of a Gaussian along the index axes, or of a
// covariance.
#pragma once

#include <array>

#include "vog/linear.h"

namespace vog::paper {

/// Standard deviations along the principal axes, and the rotation from those to world axes.
struct WorldShape {
    Vec3d scale;
    Quat rotation;
};

/// A world_from_index map as it acts on Gaussians whose principal axes are the index axes.
struct WorldFrame {
    enum class Kind {
        aligned,     ///< index axes are parallel to world axes, in any order: no rotation
        orthogonal,  ///< index axes stay perpendicular: one rotation for all Gaussians
        sheared,     ///< every shape needs an eigendecomposition
    };
    Affine world_from_index;  ///< of a conversion: relative to Gaussians::origin
    Kind kind = Kind::aligned;
    Vec3d column_length{1, 1, 1};               ///< world length of a voxel along each index axis
    std::array<int, 3> index_axis = {0, 1, 2};  ///< aligned: the index axis along each world axis
    Quat rotation;                              ///< orthogonal: index axes, normalised
};

/// Angles below 1e-6 rad count as 0: across a leaf they shift by less than 1e-5 voxels, the
/// resolution of a float32 quaternion.
WorldFrame world_frame(const Affine& world_from_index);

/// Shape in world space of a Gaussian with these standard deviations along the index axes, voxels.
WorldShape world_shape(const WorldFrame& frame, Vec3d deviation_voxels);

/// Shape of the Gaussian with this covariance. Eigenvalues are at least 1e-12 of the largest, so
/// that flat or rounded covariances have positive scales.
WorldShape shape_from_covariance(const Mat3& covariance);

}  // namespace vog::paper
