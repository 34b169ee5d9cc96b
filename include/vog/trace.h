// vog/trace.h: Ray tracing of Gaussians on the CPU, by the paper's programs.
// Ray generation, intersection and any-hit code (src/render/device) are those of the OptiX
// programs, compiled for the host, over Embree's bounding volume hierarchy. docs/ray_tracing.md
// maps them to the paper's figure.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "vog/camera.h"
#include "vog/gaussians.h"
#include "vog/image.h"
#include "vog/progress.h"

namespace vog {

/// Any-hit program: the treatment of each intersection of a ray with a Gaussian.
enum class AnyHit {
    accumulate,  ///< adds its optical depth at once: T is a sum, independent of order
    collect,     ///< the paper's: gathers hits, sorts them by entry, integrates front to back
};

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

/// Options of one picture.
struct TraceOptions {
    AnyHit anyhit = AnyHit::accumulate;  ///< treatment of hits
    int hits_per_slab = 64;  ///< capacity of the hit buffer of a collecting ray, [1, 256]
    /// Transmittance exp(-extinction T) below which a collecting ray ends, [0, 1); 0: never. The
    /// paper's `if T > 0.999 or T < 0.001, break`, read as transmittance, is 0.001.
    double stop_transmittance = 0;
    double extinction = 1;  ///< factor on density in the transmittance, > 0
    Progress progress{};    ///< called with the finished fraction of the picture
};

/// Counts over the rays of one picture.
struct TraceReport {
    std::uint64_t hits = 0;   ///< Gaussians added, summed over all rays
    std::uint64_t slabs = 0;  ///< hit buffers integrated by collecting rays, summed over all rays
    int most_slabs = 0;       ///< largest number of slabs of one ray
};

/// Traces one ray through every pixel centre and adds each Gaussian whose support (and box, with
/// aabb_sigma) the ray meets. Exact; no hit is dropped.
/// returns  T per pixel at extinction 1; the same bytes for any number of threads
/// throws   vog::Error for an unusable camera or size, options out of range, stop_transmittance
///          without collect
/// cost     O(pixels (log N + hits a ray)); collect: once more for every further slab
[[nodiscard]] DepthImage render_trace(const TraceScene& scene, const Camera& camera, int width,
                                      int height, const TraceOptions& options = {},
                                      TraceReport* report = nullptr);

}  // namespace vog
