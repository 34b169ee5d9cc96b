// picture.h: one image of T, kept up to date with the camera: by OpenGL at once, sub-frame by
// sub-frame while nothing changes; by the CPU as soon as it is ready.
#pragma once

#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "gl/shade_gl.h"
#include "gl/splat_gl.h"
#include "screen/screen.h"
#include "session/background_renderer.h"
#include "session/renderer_names.h"

namespace vog::viewer {

/// What is to be seen. Two equal ones have the same T.
struct PictureKey {
    Renderer renderer = Renderer::gl;
    std::shared_ptr<const Gaussians> model;      ///< of all but voxels
    std::shared_ptr<const Hierarchy> hierarchy;  ///< of the model; null: it is drawn whole
    double pixel_error = 0;                      ///< of gl's and splat's cuts through it
    std::shared_ptr<DepthRenderer> voxels;       ///< null but for Renderer::voxels
    Camera camera;
    PixelSize size;
    friend bool operator==(const PictureKey& a, const PictureKey& b);
};

/// Models on the device, made when first drawn.
class GlModels {
  public:
    const GlModel& get(const std::shared_ptr<const Gaussians>& model);
    void clear() { models_.clear(); }

  private:
    struct Entry {
        std::shared_ptr<const Gaussians> model;
        GlModel on_device;
    };
    std::map<const Gaussians*, Entry> models_;
};

class Picture {
  public:
    /// Draws the next sub-frame, or asks the CPU for it, until there are `subframes`.
    void update(const PictureKey& key, int subframes, const GlSplat& splat, GlModels& models);

    /// Nothing before the first one.
    GlDepth depth() const;
    /// T so far at extinction 1; `depth()` must not be nothing.
    DepthImage read() const;

    bool complete() const { return complete_; }
    int subframes() const { return subframes_; }
    /// Rises whenever what depth() shows has changed.
    int revision() const { return revision_; }
    /// Of one sub-frame, or of the CPU's latest picture.
    double ms() const { return ms_; }
    /// Of the CPU's latest picture; infinite before the first.
    double ms_per_ray() const { return ms_per_ray_; }
    PixelSize size() const { return key_.size; }
    /// Gaussians in the latest picture; 0: not known.
    std::size_t drawn() const { return drawn_; }
    /// Finished share of what the CPU is at; 0: nothing.
    double fraction() { return cpu_ ? cpu_->fraction() : 0; }
    /// Why there is no picture; told once.
    std::string take_error() { return std::exchange(error_, {}); }

  private:
    void update_gl(int subframes, const GlSplat& splat, GlModels& models);
    const GlModel& cut_model(GlModels& models);
    void update_cpu(int subframes);
    void ask(int rays);
    void require_target(PixelSize size);

    PictureKey key_;
    bool valid_ = false;  ///< what target_ holds is of key_
    bool complete_ = false;
    int subframes_ = 0, revision_ = 0;
    double summed_ = 0;  ///< pictures that were added up in target_
    std::size_t drawn_ = 0;
    std::shared_ptr<const Gaussians> cut_of_;  ///< the model that cut_ goes through
    std::optional<ViewCut> cut_;
    std::optional<GlModel> cut_model_;  ///< on the device, unless the cut is all of the model
    double ms_ = 0, ms_per_ray_ = std::numeric_limits<double>::infinity();
    std::string error_;
    std::optional<GlTarget> target_;
    std::optional<GlTimer> timer_;
    std::unique_ptr<BackgroundRenderer> cpu_;
    std::uint64_t cpu_key_ = 0;
    int rays_asked_ = 0;
};

}  // namespace vog::viewer
