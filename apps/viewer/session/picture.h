// picture.h: progressive sums for the current camera: OpenGL accumulates antialiased sub-frames,
// other renderers deliver from a background thread.
#pragma once

#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "gl/field_gl.h"
#include "gl/gpu_upload.h"
#include "gl/shade_gl.h"
#include "gl/slabs_gl.h"
#include "gl/splat_gl.h"
#include "screen/screen.h"
#include "session/background_renderer.h"
#include "session/renderer_names.h"

namespace vog::viewer {

/// A model in the device's memory, and the fields of it that were drawn.
class GlModelFields {
  public:
    explicit GlModelFields(const Gaussians& gaussians) : model_(gaussians) {}
    const GlModel& model() const { return model_; }
    /// The field, uploaded when first asked for.
    /// gaussians  of the model
    const GlField& field(const Gaussians& gaussians, const FieldChoice& choice);

  private:
    GlModel model_;
    std::map<std::pair<std::string, FieldPart>, GlField> fields_;
};

/// Models in the device's memory, uploaded when first drawn.
class GlModels {
  public:
    GlModelFields& get(const std::shared_ptr<const Gaussians>& model);
    void clear() { models_.clear(); }

  private:
    struct Entry {
        std::shared_ptr<const Gaussians> model;
        GlModelFields on_device;
    };
    std::map<const Gaussians*, Entry> models_;
};

/// OpenGL's programs for all that is drawn.
struct GlRenderers {
    GlSplat splat;
    GlFieldSums fields;
    std::optional<GlSlabs> slabs;  ///< compiled when first needed
    GlModels models;
    GpuUpload gpu;  ///< of pictures by CUDA and OptiX
};

/// One half of the split: sums of one renderer, accumulated over sub-frames.
class ProgressivePicture {
  public:
    /// Renders the next sub-frame, or requests it from the background renderer, until there are
    /// `subframes`. A changed key starts again.
    void update(const PictureKey& key, int subframes, GlRenderers& gl);

    /// The accumulated sums on the device; empty before the first sub-frame.
    GlDepth depth() const;
    /// Mean of the sub-frames; needs a first sub-frame.
    SumImage read() const;
    /// What the sums are of, once there are some.
    const ResolvedPicture& picture() const { return key_.picture; }
    /// Whether the sums belong to the latest key: those of a picture before are shown until others are there.
    bool has_sums() const { return valid_ && summed_ > 0 && sums_of_key_; }

    bool complete() const { return complete_; }
    int subframes() const { return subframes_; }
    /// Number that increases whenever depth() changes.
    int revision() const { return revision_; }
    /// Time of one OpenGL sub-frame, or of the background renderer's latest picture, ms.
    double ms() const { return ms_; }
    /// Time per ray of the background renderer's latest picture, ms; infinite before the first.
    double ms_per_ray() const { return ms_per_ray_; }
    PixelSize size() const { return key_.size(); }
    /// Gaussians drawn in the latest picture; 0: unknown.
    std::size_t drawn() const { return drawn_; }
    /// Finished fraction of the background renderer's work; 0: idle.
    double fraction() { return cpu_ ? cpu_->fraction() : 0; }
    /// Way of a GPU renderer's latest picture to the window: "shared" through a buffer that both use, or "copied" through host
    /// memory; empty: another renderer's.
    const char* way() const { return way_; }
    /// Error of the renderer, returned once; empty: none.
    std::string take_error() { return std::exchange(error_, {}); }

  private:
    void update_gl(int subframes, GlRenderers& gl);
    void add_sums(const Gaussians& gaussians, GlModelFields& on_device, GlRenderers& gl);
    GlModelFields& cut_model(GlModels& models, const Gaussians*& gaussians);
    void update_cpu(int subframes, GpuUpload& gpu);
    void request(int rays, GpuUpload& gpu);
    void show(RenderedPicture& picture, GpuUpload& gpu);
    /// Requests twice as many rays along each side of a pixel, or completes the picture.
    void refine(int rays, int subframes, GpuUpload& gpu);
    void require_target(PixelSize size);

    PictureKey key_;
    bool valid_ = false;        ///< target_ is of key_, or will be
    bool sums_of_key_ = false;  ///< the sums in target_ are what key_ is drawn of
    bool complete_ = false;
    int subframes_ = 0, revision_ = 0;
    double summed_ = 0;  ///< sub-frames summed in target_
    std::size_t drawn_ = 0;
    std::shared_ptr<const Gaussians> cut_of_;  ///< model of cut_
    std::optional<ViewCut> cut_;
    const Gaussians* chosen_ = nullptr;       ///< the cut's Gaussians
    std::optional<GlModelFields> cut_model_;  ///< the same on the device; none: the whole model
    double ms_ = 0, ms_per_ray_ = std::numeric_limits<double>::infinity();
    std::string error_;
    const char* way_ = "";
    std::optional<GlTarget> target_;
    KeptSlabs kept_;  ///< of a picture with a transfer function
    std::optional<GlTimer> timer_;
    std::unique_ptr<BackgroundRenderer> cpu_;
    std::uint64_t cpu_key_ = 0;
    int rays_requested_ = 0;  ///< along each side of a pixel
    int complete_for_ = 0;    ///< sub-frames of the request that complete_ fulfils
};

}  // namespace vog::viewer
