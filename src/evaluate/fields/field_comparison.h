// field_comparison.h: fields of an evaluation: maps through the voxels, and those of each row's model.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "vog/evaluate.h"
#include "vog/field_maps.h"
#include "vog/scene.h"

namespace vog::evaluation {

/// Fields at the voxels of an evaluation, and their maps in each of its views; none by default.
class FieldComparison {
  public:
    FieldComparison() = default;
    /// box     of the data
    /// throws  vog::Error as options.read_fields does, and for a field of another number of volumes
    FieldComparison(std::span<const Volume> volumes, const Box& box,
                    std::span<const EvaluationView> views, const EvaluateOptions& options);

    /// cells   scene with the fields of these names; models have them, too
    /// throws  vog::Error for a field that the cells lack
    FieldComparison(const Scene& cells, std::span<const EvaluationView> views,
                    const EvaluateOptions& options);

    bool empty() const { return names_.empty(); }
    const std::vector<std::string>& names() const { return names_; }
    std::span<const Volume> volumes() const { return volumes_->volumes; }
    /// Converts a volume, or the mesh whose parts the volumes are, by cuts that follow the fields. The model has them.
    Gaussians convert(std::size_t volume, const MomentOptions& moments) const;
    Gaussians convert(const Composite& mesh, const MomentOptions& moments) const;
    /// Compares the maps of the model's fields in every view of the row. A model that is not of `convert` gets them first.
    /// made_here  the model is one of `convert`
    void compare(const Gaussians& model, EvaluationRow& row, bool made_here) const;

  private:
    /// Maps of a field of a scene, [views].
    std::vector<FieldMaps> maps_of(Scene scene, const std::string& field) const;

    std::vector<std::string> names_;  ///< [fields]
    std::shared_ptr<const VolumeSet>
        volumes_;  ///< tiles divided where a field varies; null: of cells
    std::vector<std::vector<VoxelField>> fields_;  ///< [fields][volumes]
    std::vector<Camera> views_;
    std::vector<std::vector<FieldMaps>> reference_;  ///< [fields][views]
    int width_ = 0, height_ = 0;
};

}  // namespace vog::evaluation
