// field_gl.h: sums of a model's fields along rays in OpenGL: column, column times mean, column times mean square
// (docs/fields.md); and T of what a clip leaves.
#pragma once

#include <optional>

#include "gl/splat_gl.h"
#include "quantity/quantity.h"

namespace vog::viewer {

/// A field of a model in the device's memory, beside the model itself.
class GlField {
  public:
    GlField(const GlModel& model, const Gaussians& gaussians, const FieldChoice& choice);

    /// Of a vector field the component along each ray, or the whole vector's square: all three components.
    bool of_vector() const { return of_vector_; }
    bool magnitude() const { return magnitude_; }
    GLuint vertex_array() const { return array_; }
    /// Different for every field that was ever uploaded.
    std::uint64_t id() const { return id_; }

  private:
    std::uint64_t id_ = 0;
    bool of_vector_ = false, magnitude_ = false;
    GlVertexArray array_;
    GlBuffer buffer_;
};

class GlFieldSums {
  public:
    /// Adds the sums of a field to `target` (RGBA32F, rows from the top).
    /// field  of the model; null: the value 0, so that T remains
    void add(const GlModel& model, const GlField* field, const Camera& camera, Jitter jitter,
             const Clipping& clip, const GlTarget& target);

  private:
    std::optional<GlProgram> scalar_, vector_;  ///< compiled when first asked for
};

}  // namespace vog::viewer
