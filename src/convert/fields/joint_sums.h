// joint_sums.h: sums over each Gaussian's part of the voxels, of positions, values, and residuals about a plane:
// the joint moments of position and value (docs/fields.md).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "convert/moments/cells/bricks.h"
#include "convert/moments/em/brick_responsibilities.h"
#include "vog/voxel_field.h"

namespace vog::joint {

/// One component of a field at the voxels of a volume.
struct Component {
    const Volume* volume = nullptr;
    const VoxelValues* values = nullptr;  ///< without values: the volume's own
    /// Sums are of (value - reference) / unit, whose squares and cubes floats resolve.
    float reference = 0, unit = 1;
};

/// A brick, and where its values are.
struct FieldBrick {
    moments::Brick brick;
    std::uint32_t node = 0;  ///< index of its leaf or tile in the volume
};
/// Bricks of a volume with mass, in Morton order.
std::vector<FieldBrick> field_bricks(const Volume& volume);

/// Values of a component at a brick's samples, by leaf_offset.
struct BrickValues {
    alignas(64) moments::BrickFloats of;
    void load(const Component& component, const FieldBrick& brick);
};

/// A brick's samples, divided among Gaussians: scratch.runs, values and weights (scratch.sum), and samples that
/// lie outside all supports.
struct DividedBrick {
    const FieldBrick* brick = nullptr;
    moments::BrickScratch* scratch = nullptr;
    std::span<const moments::UncoveredSample> uncovered;

    /// Mass of a sample.
    double mass(int sample) const;
    /// Sample relative to the mean of kernel n, voxels.
    Vec3d from_mean(int sample, std::size_t n) const;
};

/// Sums of positions, and of one component's values with them, about the Gaussian's mean.
inline constexpr std::size_t kPositionSums = 10;  ///< mass, first x y z, second xx xy xz yy yz zz
inline constexpr std::size_t kValueSums = 4;      ///< value, value times x y z

/// Sets parts, [kernels][kPositionSums + kValueSums * components], voxels and sums about the means.
void add_joint_sums(const DividedBrick& divided, std::span<const Component> components,
                    std::span<double> parts);

/// A component inside a Gaussian, relative to its mean, in a volume's voxels.
struct Plane {
    float value = 0;
    Vec3f gradient;
};
/// Sums of residuals about planes: of a scalar field the square and the cube, of a vector field the products xx xy
/// xz yy yz zz.
inline constexpr std::size_t kScalarSums = 2, kVectorSums = 6;

/// Sets parts, [kernels][width], from `first` on, to the sums of one field's residuals.
/// components  1 or 3
/// planes      [kernels][components]
void add_residual_sums(const DividedBrick& divided, std::span<const Component> components,
                       std::span<const Plane> planes, std::size_t width, std::size_t first,
                       std::span<double> parts);

}  // namespace vog::joint
