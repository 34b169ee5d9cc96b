// soft_division.h: voxels divided among the Gaussians of a finished model.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "convert/fields/joint/value_likelihood.h"
#include "convert/fields/joint_sums.h"
#include "convert/moments/em/em_step.h"
#include "vog/gaussians.h"

namespace vog::joint {

/// Sets parts, [kernels of the brick][width], for one brick.
/// gaussian  [kernels of the brick] index of each in the model
using PartsOfBrick = std::function<void(
    const DividedBrick& divided, std::span<const std::uint32_t> gaussian, std::span<double> parts)>;

/// Voxels of one volume, divided by the densities of the Gaussians at each voxel, as in a step of
/// expectation-maximisation; in the joint space of position and value also by the likelihood of its value.
class SoftDivision {
  public:
    /// period      periodic box, across whose faces Gaussians have voxels; none: open
    /// likelihood  of a field's values; none: positions alone count
    /// The volume must outlive the object.
    SoftDivision(const Gaussians& model, const Volume& volume, const std::optional<Box>& period,
                 std::optional<ValueLikelihood> likelihood = {});
    SoftDivision(const SoftDivision&) = delete;  // the solver refers to the bricks
    SoftDivision& operator=(const SoftDivision&) = delete;
    /// Adds the parts of every brick to sums, [Gaussians][width]; the same bytes for any number of threads.
    void add(std::size_t width, const PartsOfBrick& parts_of, std::span<double> sums) const;

  private:
    std::vector<FieldBrick> field_bricks_;
    std::vector<moments::Brick> bricks_;
    moments::PackedCells cells_;
    std::optional<ValueLikelihood> likelihood_;
    std::optional<moments::EmSolver> solver_;
};

}  // namespace vog::joint
