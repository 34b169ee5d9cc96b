// division.h: voxels divided among the Gaussians of a finished model.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "convert/fields/joint_sums.h"
#include "convert/moments/em/em_step.h"
#include "vog/gaussians.h"

namespace vog::joint {

/// Sets parts, [kernels of the brick][width], for one brick.
/// gaussian  [kernels of the brick] index of each in the model
using PartsOfBrick = std::function<void(
    const DividedBrick& divided, std::span<const std::uint32_t> gaussian, std::span<double> parts)>;

/// Voxels of one volume, divided among Gaussians.
class Division {
  public:
    virtual ~Division() = default;
    /// Adds the parts of every brick to sums, [Gaussians][width]; the same bytes for any number of threads.
    virtual void add(std::size_t width, const PartsOfBrick& parts_of,
                     std::span<double> sums) const = 0;
};

/// By the densities of the Gaussians at each voxel, as in a step of expectation-maximisation.
std::unique_ptr<Division> soft_division(const Gaussians& model, const Volume& volume);
/// By the cells of a hard uniform cut: each voxel belongs to the Gaussian whose mean lies in its cell. Voxels of
/// cells that were dropped belong to none.
/// block  edge of a cell, voxels
std::unique_ptr<Division> cell_division(const Gaussians& model, const Volume& volume, int block);

}  // namespace vog::joint
