// value_comparison.h: pictures by value of an evaluation: the voxels' own, and those of each row's model.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "compare/values/value_functions.h"
#include "vog/evaluate.h"
#include "vog/image.h"
#include "vog/scene.h"
#include "vog/value_transfer.h"

namespace vog::evaluation {

/// Pictures of the voxels by value, under several transfer functions from the views of kValueViews.
class ValueComparison {
  public:
    /// data    volumes that add up, or the parts of a mesh; outlive this
    /// box     of the data
    /// throws  vog::Error for data without values above 0, and as read_value_transfer does
    ValueComparison(const VolumeSet& data, const Box& box, const EvaluateOptions& options);

    /// cells   scene with the density as its last field; the models have it, too
    ValueComparison(const Scene& cells, const EvaluateOptions& options);

    /// Names of the transfer functions.
    std::vector<std::string> names() const;
    /// Differences of a model's pictures from the voxels'. A model without the volumes' own values gets them, as
    /// `vog convert` adds them.
    /// returns  [functions][views]
    std::vector<std::vector<ValueResult>> compare(const Gaussians& model) const;

  private:
    /// Draws the reference.
    /// lower, upper  of all values
    void begin(const Scene& scene, const std::string& field, double lower, double upper,
               const comparison::ValueRange& range, const EvaluateOptions& options);
    /// Draws a field of a scene under every function from every view, over black.
    /// take  receives each picture, those of one function after those of the other
    void draw(Scene scene, const std::string& field,
              const std::function<void(std::size_t function, std::size_t view, Image)>& take) const;
    std::vector<std::vector<ValueResult>> compare(Scene scene, const std::string& field) const;

    const VolumeSet* data_ = nullptr;  ///< null: cells
    std::vector<VoxelField> values_;   ///< [volumes] their own
    Box box_;
    std::vector<ValueTransfer> functions_;
    std::vector<Camera> views_;
    std::vector<std::vector<Image>> reference_;  ///< [functions][views]
    int width_, height_;
};

}  // namespace vog::evaluation
