// slabs_gl.h: volume rendering by value in OpenGL: light added up in depth slabs, four a pass, and composited front to
// back (docs/volume_rendering.md); largest values of a field, eight slabs a pass. Nothing is sorted.
#pragma once

#include <optional>

#include "gl/field_gl.h"
#include "vog/picture.h"

namespace vog::viewer {

/// A model's field, and the picture by value that shows it.
struct GlVolume {
    const GlModel* model = nullptr;
    const GlField* field = nullptr;       ///< a scalar field of the model
    const ScalarField* values = nullptr;  ///< the same, for the range of the data
    const ResolvedPicture& picture;

    /// Null: the largest value is shown.
    const ValueTransfer* transfer() const {
        return picture.request.show == Show::volume ? &picture.chosen.transfer : nullptr;
    }
    /// Depth slabs; of light they are drawn in fours.
    int slabs() const {
        return picture.request.slabs.value_or(transfer() ? kVolumeSlabs : kMaximumSlabs);
    }
};

class GlSlabs {
  public:
    GlSlabs();
    /// Adds a picture to `target` (RGBA32F, rows from the top): premultiplied colours, or sums of a field of
    /// column 1 (SumImage) where there is one.
    /// throws  vog::Error for an invalid transfer function
    void add(const GlVolume& volume, const Camera& camera, Jitter jitter, const GlTarget& target);

  private:
    void require_targets(int width, int height, std::size_t gaussians, bool means);
    void fit(const GlVolume& volume);
    void fit_light(const GlVolume& volume);
    /// Adds Gaussians to some slabs of a strip: layers_.
    void draw_layers(const GlVolume& volume, const CameraFrame& frame, Jitter jitter, int first,
                     int slab);
    void draw_largest(const GlVolume& volume, const CameraFrame& frame, Jitter jitter, int first);
    void draw_ranges(const GlVolume& volume, const CameraFrame& frame, Jitter jitter);
    void draw_strip(const GlVolume& volume, const CameraFrame& frame, Jitter jitter, int first);
    void draw_screen() const;

    GlProgram light_program_, range_program_, slab_program_, layer_program_, copy_program_;
    GlProgram mean_program_, largest_program_, copy_means_program_;
    GlVertexArray no_vertices_;
    GlTexture table_;
    std::optional<GlTarget> light_, layers_, ranges_, strip_, densest_;
    std::uint64_t lit_field_ = 0;                ///< field and transfer function of the light
    std::optional<ValueTransfer> lit_transfer_;  ///< none: planes of values
};

}  // namespace vog::viewer
