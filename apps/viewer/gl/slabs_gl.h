// slabs_gl.h: volume rendering by value in OpenGL: moments of a field added up in depth slabs, four a pass (with light two),
// classified and composited front to back (docs/volume_rendering.md); largest values of a field, eight slabs a pass. Nothing is sorted.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "gl/field_gl.h"
#include "quantity/quantity.h"
#include "render/light/illumination.h"
#include "vog/picture.h"

namespace vog::viewer {

/// A model's field, and the picture by value that shows it.
struct GlVolume {
    const GlModel* model = nullptr;
    const GlField* field = nullptr;        ///< a scalar field of the model
    const ScalarField* values = nullptr;   ///< the same, for the range of the data
    const Gaussians* gaussians = nullptr;  ///< the model
    const ResolvedPicture& picture;

    /// Null: the largest value is shown.
    const ValueTransfer* transfer() const {
        return picture.request.show == Show::volume ? &picture.chosen.transfer : nullptr;
    }
    int slabs() const { return depth_slabs(picture.request); }
};

/// Sums of all slabs of a picture with a transfer function, which another one, or another light, classifies anew.
class KeptSlabs {
  public:
    /// Pictures whose Gaussians were drawn; the others came from kept sums.
    int drawn() const { return drawn_; }

  private:
    friend class GlSlabs;
    /// Whether the sums of a picture are here, but for strips of another size.
    bool has(const GlVolume& volume) const;
    /// Makes memory for a picture.
    /// returns  false: it would take more than 768 MB, or there is not as much
    bool require(int targets, int width, int rows);

    std::vector<GlTarget> targets_;                                ///< [strips][passes]
    std::optional<std::pair<std::uint64_t, ResolvedPicture>> of_;  ///< field and picture
    int drawn_ = 0;
};

class GlSlabs {
  public:
    GlSlabs();
    /// Adds a picture to `target` (RGBA32F, rows from the top): premultiplied colours, or sums of a field of
    /// column 1 (SumImage) where there is one.
    /// kept    sums of the picture before, in place of drawing the same again; receives those drawn; null: none are kept
    /// throws  vog::Error for an invalid transfer function
    void add(const GlVolume& volume, const Camera& camera, Jitter jitter, const GlTarget& target,
             KeptSlabs* kept = nullptr);

  private:
    void require_targets(const GlVolume& volume, int width, int height);
    void set_light(const GlVolume& volume);
    /// Adds Gaussians to some slabs of a strip.
    void draw_layers(const GlVolume& volume, const GlProgram& program, int in_pass,
                     const CameraFrame& frame, Jitter jitter, int first, int slab,
                     const GlTarget& layers) const;
    void draw_largest(const GlVolume& volume, const CameraFrame& frame, Jitter jitter, int first);
    /// Depths of all Gaussians, and of those above each tile of tiles.glsl.
    void draw_ranges(const GlVolume& volume, const CameraFrame& frame, Jitter jitter);
    /// Draws the pixels of slabs into the bound target, blended; images: what the program has beside them.
    void gather(const GlProgram& program, const GlVolume& volume, int first, int slab,
                const GlTarget& layers, std::vector<std::pair<const char*, GLuint>> images) const;
    /// kept  the strip's sums, a target a pass; null: they are not kept
    /// draws  whether to draw them
    void draw_strip(const GlVolume& volume, const CameraFrame& frame, Jitter jitter, int first,
                    const GlTarget* kept, bool draws);
    void set_finish(const GlProgram& program, const GlVolume& volume, const CameraFrame& frame,
                    Jitter jitter) const;
    /// Light that reaches the data.
    void set_reached(const GlVolume& volume, const CameraFrame& frame);
    void draw_screen() const;

    GlProgram range_programs_[2], copy_program_, mean_program_, largest_program_,
        copy_means_program_;
    GlProgram slab_programs_[2], finish_programs_[2];  ///< without and with light
    GlVertexArray no_vertices_;
    GlTexture pieces_, table_, reached_texture_;
    std::optional<GlTarget> layers_, before_, ranges_[2], strip_, densest_;
    std::uint64_t lit_field_ = 0;  ///< field and transfer function of the light
    std::optional<ValueTransfer> lit_transfer_;
    by_value::LightOfMoments light_;
    int lights_ = 0;  ///< counts them
    lights::KeptIllumination reached_;
};

}  // namespace vog::viewer
