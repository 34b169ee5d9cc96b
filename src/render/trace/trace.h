// trace.h: Ray tracing of Gaussians on the CPU, by the paper's programs.
// Ray generation, intersection and any-hit code (src/render/device) are those of the OptiX
// programs, compiled for the host, over Embree's bounding volume hierarchy. docs/ray_tracing.md
// maps them to the paper's figure.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "render/by_value/volume_image.h"
#include "vog/camera.h"
#include "vog/clip.h"
#include "vog/field_maps.h"
#include "vog/gaussians.h"
#include "vog/image.h"
#include "vog/renderer.h"
#include "vog/value_transfer.h"
#include "vog/volume_picture.h"

namespace vog {

/// Options of a scene, fixed for all its pictures.
struct TraceSceneOptions {
    /// Half edges of the paper's bounding boxes, in its radii (scale sqrt(2)): a ray counts a
    /// Gaussian only if it meets the Gaussian's box, clipped to the model's box. >= 0; 0: boxes
    /// around the supports, so that every Gaussian on the ray counts.
    double aabb_sigma = 0;
    /// Cuts each kernel where it has fallen to this share of its peak, k = sqrt(-2 ln kappa), in
    /// place of the model's own cutoff. [1.3e-14, 1), or 0: the model's.
    double kappa = 0;
};

/// A model prepared for rays, with its bounding volume hierarchy. Immutable; copies share the data.
class TraceScene {
  public:
    struct Data;
    explicit TraceScene(std::shared_ptr<const Data> data) : data_(std::move(data)) {}
    const Data& data() const { return *data_; }
    std::size_t size() const;  ///< Gaussians

  private:
    std::shared_ptr<const Data> data_;
};

/// Packs a model and builds its bounding volume hierarchy, for any number of views.
/// throws vog::Error for a model validate() refuses, options out of range, 2^32 Gaussians or more
/// cost   O(N log N) time, about 200 bytes a Gaussian, parallel
[[nodiscard]] TraceScene trace_scene(const Gaussians& gaussians,
                                     const TraceSceneOptions& options = {});

/// Traces one ray through every pixel centre and adds each Gaussian whose support (and box, with
/// aabb_sigma) the ray meets. Exact; no hit is dropped.
/// clip     space that counts: chords are cut exactly, and boxes count where the part of the ray that stays meets them. A
///          Gaussian smaller than a pixel counts by the share of the chord through its mean that stays
/// returns  T per pixel at extinction 1; the same bytes for any number of threads
/// throws   vog::Error for an unusable camera, size or clip, options out of range, stop_transmittance
///          without collect
/// cost     O(pixels (log N + hits a ray)); collect: once more for every further slab
[[nodiscard]] DepthImage render_trace(const TraceScene& scene, const Camera& camera, int width,
                                      int height, const TraceOptions& options = {},
                                      TraceReport* report = nullptr, const Clipping& clip = {});

/// As render_field_splat, by one ray a pixel.
/// throws  vog::Error as trace_scene and render_trace do, for a field that the model lacks, and for AnyHit::collect
[[nodiscard]] FieldMaps render_field_trace(const Gaussians& gaussians, const FieldChoice& choice,
                                           const Camera& camera, int width, int height,
                                           const TraceOptions& options = {},
                                           const TraceSceneOptions& scene = {},
                                           const Clipping& clip = {});
/// As render_volume_splat in exact order of depth, by one ray a pixel in steps of an eighth of the thinnest Gaussian: the truth
/// of the slabs.
/// throws  vog::Error as render_trace does, and for a field that the model lacks
[[nodiscard]] VolumeImage render_volume_trace(const Gaussians& gaussians, const std::string& field,
                                              const ValueTransfer& transfer, const Camera& camera,
                                              int width, int height,
                                              const TraceOptions& options = {},
                                              const TraceSceneOptions& scene = {},
                                              const VolumeLook& look = {});
/// As render_maximum_splat in steps of an eighth of the thinnest Gaussian on the ray: the truth of the slabs.
/// throws  vog::Error as render_volume_trace does
[[nodiscard]] ValueMap render_maximum_trace(const Gaussians& gaussians, const std::string& field,
                                            const Camera& camera, int width, int height,
                                            const TraceOptions& options = {},
                                            const TraceSceneOptions& scene = {},
                                            const Clipping& clip = {});

}  // namespace vog
