// field_comparison.h: fields of an evaluation: maps through the voxels, and those of each row's model.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "vog/evaluate.h"
#include "vog/field_maps.h"

namespace vog::evaluation {

/// Fields at the voxels of an evaluation; none by default.
class FieldComparison {
  public:
    FieldComparison() = default;
    /// throws vog::Error as options.read_fields does, and for a field of another number of volumes
    FieldComparison(std::span<const Volume> volumes, const EvaluateOptions& options);

    std::vector<std::string> names() const;
    /// Maps through the voxels, one a field.
    std::vector<FieldMaps> reference(const Camera& camera) const;
    /// Adds the fields to a copy of the model and compares its maps in every view of the row.
    /// reference  [views][fields]
    void compare(const Gaussians& model, const Evaluation& evaluation,
                 std::span<const std::vector<FieldMaps>> reference, EvaluationRow& row) const;

  private:
    std::vector<Volume> volumes_;                  ///< tiles divided where a field varies
    std::vector<std::vector<VoxelField>> fields_;  ///< [fields][volumes]
    int width_ = 0, height_ = 0;
};

}  // namespace vog::evaluation
