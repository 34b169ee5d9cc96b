// value_likelihood.h: likelihood of the values at voxels under the planes and residuals of Gaussians.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "convert/fields/joint_sums.h"
#include "vog/memory.h"

namespace vog::joint {

/// Distribution of one component's values in a Gaussian: normal about a plane.
struct ValueNormal {
    Plane plane;              ///< about the Gaussian's mean, in a volume's voxels
    float per_deviation = 1;  ///< 1 / standard deviation
};

/// Values of one field at a volume's voxels, and their distributions in the Gaussians of a model.
class ValueLikelihood {
  public:
    /// components  of the field: 1 or 3, taken as independent
    /// normals     [Gaussians][components]
    ValueLikelihood(std::vector<Component> components, BigVector<ValueNormal> normals)
        : components_(std::move(components)), normals_(std::move(normals)) {}
    /// Multiplies each kernel's values at a brick's samples by the likelihood of the sample's value, and sets
    /// scratch.sum to their sums.
    /// gaussian  [kernels] index of each in the model
    void weigh(const FieldBrick& brick, std::span<const std::uint32_t> gaussian,
               moments::BrickScratch& scratch) const;

  private:
    std::vector<Component> components_;
    BigVector<ValueNormal> normals_;
};

}  // namespace vog::joint
