// slabs_gl.h: volume rendering by value in OpenGL: light added up in depth slabs, four a pass, and composited front to
// back (docs/volume_rendering.md); maxima of a field, eight slabs a pass. Nothing is sorted.
#pragma once

#include <memory>
#include <optional>

#include "gl/field_gl.h"
#include "vog/volume_picture.h"

namespace vog::viewer {

/// What a volume picture, or one of maxima, shows of a model's field.
struct GlVolume {
    const GlModel* model = nullptr;
    const GlField* field = nullptr;       ///< a scalar field of the model
    const ScalarField* values = nullptr;  ///< the same, for the range of the data
    /// Unchanged: another one has another address. Null: the maximum.
    std::shared_ptr<const ValueTransfer> transfer;
    const VolumeLook* look = nullptr;
    int slabs = 32;  ///< of light rounded up to a multiple of 4
};

class GlSlabs {
  public:
    GlSlabs();
    /// Adds a picture to `target` (RGBA32F, rows from the top): premultiplied colours; of a maximum sums of a field of
    /// column 1 (SumImage) where there is one.
    /// throws  vog::Error for an invalid transfer function
    void add(const GlVolume& volume, const Camera& camera, Jitter jitter, const GlTarget& target);

  private:
    void require_targets(int width, int height, std::size_t gaussians, bool maximum);
    void fit(const GlVolume& volume);
    void fit_light(const GlVolume& volume);
    /// Adds Gaussians to some slabs of a strip: layers_.
    void draw_layers(const GlVolume& volume, const CameraFrame& frame, Jitter jitter, int first,
                     int slab);
    void draw_maximum(const GlVolume& volume, const CameraFrame& frame, Jitter jitter, int first);
    void draw_ranges(const GlVolume& volume, const CameraFrame& frame, Jitter jitter);
    void draw_strip(const GlVolume& volume, const CameraFrame& frame, Jitter jitter, int first);
    void draw_screen() const;

    GlProgram light_program_, range_program_, slab_program_, layer_program_, copy_program_;
    GlProgram mean_program_, maximum_program_, copy_means_program_;
    GlVertexArray no_vertices_;
    GlTexture table_;
    std::optional<GlTarget> light_, layers_, ranges_, strip_, densest_;
    std::uint64_t lit_field_ = 0;  ///< field and transfer function of the light
    std::shared_ptr<const ValueTransfer> lit_transfer_;
};

}  // namespace vog::viewer
