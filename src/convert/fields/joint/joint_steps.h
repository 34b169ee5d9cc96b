// joint_steps.h: expectation-maximisation in the joint space of position and a field's value.
// A voxel is divided among Gaussians by their densities times the likelihood of its value, normal about each one's plane;
// each Gaussian gets the moments of its part. Gaussians then follow surfaces of equal value, at some cost in T.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "convert/fields/field_entries.h"
#include "convert/fields/joint/joint_cells.h"
#include "vog/gaussians.h"
#include "vog/progress.h"
#include "vog/voxel_field.h"

namespace vog::joint {

/// A field whose values take part in the division of voxels.
struct JointSteps {
    std::size_t field = 0;  ///< place among the fields
    int steps = 1;          ///< >= 1
    /// [Gaussians] distributions of values that the first step divides voxels by. Empty: those of the voxels near
    /// each Gaussian.
    std::span<const ValueDistribution> start{};
    std::optional<Box> periodic{};  ///< MomentOptions::periodic
};

/// Moves the Gaussians and sets all fields, by the division of the last step.
/// model  mean, scale, rotation and density change; Gaussians without a part have density 0
void add_by_joint_steps(Gaussians& model, std::span<const Volume> levels,
                        std::span<const std::vector<VoxelField>> fields, const Layout& layout,
                        const JointSteps& joint, const Progress& progress, FieldEntries& entries);

/// Removes Gaussians of density 0.
/// returns  how many
std::size_t remove_empty(Gaussians& model);

}  // namespace vog::joint
