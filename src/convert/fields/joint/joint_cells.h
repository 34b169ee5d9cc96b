// joint_cells.h: Gaussians of the joint space of position and one field's value, split and merged.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "convert/fields/field_entries.h"
#include "convert/moments/gaussian_moments.h"
#include "vog/gaussians.h"

namespace vog::joint {

/// Least standard deviation of a value's distribution, share of the field's over all voxels. Without it Gaussians
/// of nearly constant value would take no other voxel.
inline constexpr double kLeastDeviation = 0.1;

/// Distribution of a field's values in one Gaussian, in the unit and about the reference of its Layout.
struct ValueDistribution {
    WorldPlane plane;     ///< about the Gaussian's mean
    double variance = 0;  ///< of the residual
};

/// A Gaussian of position and value.
struct JointCell {
    moments::Moments moments;  ///< world units, mean relative to the model's origin
    ValueDistribution value;
};

/// Direction in which cells are split in two; both halves keep the plane.
enum class SplitAlong {
    gradient,      ///< of the field, as far as the cell reaches: the halves' values differ most
    longest_axis,  ///< of the cell
};

/// The Gaussians of a model with one of its scalar fields.
class JointCells {
  public:
    /// part  of the field in its Layout
    JointCells(const Gaussians& model, const ScalarField& field, const Layout::Part& part);
    std::size_t size() const { return cells_.size(); }
    const JointCell& operator[](std::size_t i) const { return cells_[i]; }
    void set(std::size_t i, const JointCell& cell) { cells_[i] = cell; }
    /// Splits the worst and merges as many pairs elsewhere (convert/moments/refine/split_merge.h). A merge costs the
    /// bound on the Kullback-Leibler divergence in the joint space, over the square root of the mass.
    /// error  [N] of each
    /// share  to split, [0, 1/3]
    void split_and_merge(std::span<const float> error, double share, SplitAlong along);
    /// The model without fields, and the distributions of values in its Gaussians.
    Gaussians to_gaussians(const Gaussians& of) const;
    std::vector<ValueDistribution> distributions() const;

  private:
    std::vector<JointCell> cells_;
    double length_ = 1;          ///< mean extent of a cell, world units
    double least_variance_ = 0;  ///< of residuals, for the costs of merges
};

}  // namespace vog::joint
