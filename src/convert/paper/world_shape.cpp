// world_shape.cpp: scales and rotations of Gaussians under an affine map.
#include "convert/paper/world_shape.h"

#include <algorithm>
#include <cmath>

namespace vog::paper {

namespace {

constexpr double kAngleTolerance = 1e-6;

/// Sets index_axis. Returns whether every index axis is parallel to a world axis.
bool find_axes(WorldFrame& frame) {
    std::array<bool, 3> taken{};
    for (int column = 0; column < 3; ++column) {
        const Vec3d direction =
            (1 / frame.column_length[column]) * frame.world_from_index.linear.column(column);
        int along = 0;
        for (int axis = 1; axis < 3; ++axis)
            if (std::abs(direction[axis]) > std::abs(direction[along])) along = axis;
        for (int axis = 0; axis < 3; ++axis)
            if (axis != along && std::abs(direction[axis]) > kAngleTolerance) return false;
        frame.index_axis[static_cast<std::size_t>(along)] = column;
        taken[static_cast<std::size_t>(along)] = true;
    }
    return taken[0] && taken[1] && taken[2];
}

}  // namespace

WorldFrame world_frame(const Affine& world_from_index) {
    WorldFrame frame;
    frame.world_from_index = world_from_index;
    Mat3 unit;
    for (int column = 0; column < 3; ++column) {
        const Vec3d step = world_from_index.linear.column(column);
        frame.column_length[column] = length(step);
        for (int row = 0; row < 3; ++row) unit(row, column) = step[row] / length(step);
    }
    if (find_axes(frame)) return frame;

    // Reversing an axis does not change a Gaussian, but turns a reflection into a rotation.
    const bool perpendicular = std::abs(dot(unit.column(0), unit.column(1))) <= kAngleTolerance &&
                               std::abs(dot(unit.column(1), unit.column(2))) <= kAngleTolerance &&
                               std::abs(dot(unit.column(2), unit.column(0))) <= kAngleTolerance;
    frame.kind = perpendicular ? WorldFrame::Kind::orthogonal : WorldFrame::Kind::sheared;
    if (determinant(unit) < 0)
        for (int row = 0; row < 3; ++row) unit(row, 2) = -unit(row, 2);
    if (perpendicular) frame.rotation = quat_from_matrix(unit);
    return frame;
}

WorldShape world_shape(const WorldFrame& frame, Vec3d deviation_voxels) {
    Vec3d scale;
    for (int axis = 0; axis < 3; ++axis)
        scale[axis] = deviation_voxels[axis] * frame.column_length[axis];
    switch (frame.kind) {
        case WorldFrame::Kind::aligned:
            return {{scale[frame.index_axis[0]], scale[frame.index_axis[1]],
                     scale[frame.index_axis[2]]},
                    {}};
        case WorldFrame::Kind::orthogonal:
            return {scale, frame.rotation};
        case WorldFrame::Kind::sheared:
            break;
    }
    // Covariance L diag(s^2) L^T.
    Mat3 spread = frame.world_from_index.linear;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) spread(row, column) *= deviation_voxels[column];
    return shape_from_covariance(spread * transpose(spread));
}

WorldShape shape_from_covariance(const Mat3& covariance) {
    const Eigen3 eigen = symmetric_eigen(covariance);
    const double floor = 1e-12 * eigen.values[0];
    WorldShape shape;
    for (int axis = 0; axis < 3; ++axis)
        shape.scale[axis] = std::sqrt(std::max(eigen.values[axis], floor));
    shape.rotation = quat_from_matrix(eigen.axes);
    return shape;
}

}  // namespace vog::paper
