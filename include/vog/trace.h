// vog/trace.h: Gaussians by ray tracing, on the CPU. The twin of the paper's OptiX programs: the
// same ray generation, intersection and any-hit code (src/render/device), compiled for the host,
// under Embree's hierarchy instead of OptiX's. docs/ray_tracing.md maps it to the paper's figure.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "vog/camera.h"
#include "vog/gaussians.h"
#include "vog/image.h"
#include "vog/progress.h"

namespace vog {

/// What the any-hit program does with a hit.
enum class AnyHit {
    accumulate,  ///< adds its optical depth at once: T is a sum and needs no order
    collect,     ///< the paper's: gathers hits, sorts them by entry, integrates front to back
};

struct TraceSceneOptions {
    /// The paper's bounding boxes: a ray finds a Gaussian only if it meets the box of this many
    /// times the paper's radii (scale sqrt(2)) around its mean, within the model's box. 0: boxes
    /// are those of the supports, and every Gaussian a ray meets is found.
    double aabb_sigma = 0;
    /// Cuts each kernel where it has fallen to this share of its peak, k = sqrt(-2 ln kappa), in
    /// place of the model's own cutoff. (0, 1), or 0: the model's.
    double kappa = 0;
};

/// A model made ready for rays. Copies share it; it is never changed.
class TraceScene {
  public:
    struct Data;
    explicit TraceScene(std::shared_ptr<const Data> data) : data_(std::move(data)) {}
    const Data& data() const { return *data_; }
    std::size_t size() const;  ///< Gaussians

  private:
    std::shared_ptr<const Data> data_;
};

/// Bounds and hierarchy of a model, for any number of views.
/// throws vog::Error for a model validate() refuses, options out of range, 2^32 Gaussians or more
/// cost   O(N log N) time, about 200 bytes a Gaussian, parallel
[[nodiscard]] TraceScene trace_scene(const Gaussians& gaussians,
                                     const TraceSceneOptions& options = {});

struct TraceOptions {
    AnyHit anyhit = AnyHit::accumulate;
    int hits_per_slab = 64;  ///< of collect: hits a ray holds at once, [1, 256]
    /// Of collect: a ray ends once exp(-extinction T) is below this, [0, 1). 0: never. The paper's
    /// `if T > 0.999 or T < 0.001, break`, read as transmittance, is 0.001.
    double stop_transmittance = 0;
    double extinction = 1;  ///< the factor on density that stop_transmittance is judged with
    Progress progress{};
};

/// What the rays of a picture met.
struct TraceReport {
    std::uint64_t hits = 0;   ///< Gaussians added, over all rays
    std::uint64_t slabs = 0;  ///< of collect: buffers filled and integrated, over all rays
    int most_slabs = 0;       ///< of one ray
};

/// Image order and exact: for every pixel centre, each Gaussian whose support its ray meets (and
/// whose box, under aabb_sigma). No hit is ever dropped.
/// returns  T per pixel at extinction 1; the same bytes for any number of threads
/// throws   vog::Error for an unusable camera or size, options out of range, stop_transmittance
///          without collect
/// cost     O(pixels (log N + hits)); collect more by the slabs
[[nodiscard]] DepthImage render_trace(const TraceScene& scene, const Camera& camera, int width,
                                      int height, const TraceOptions& options = {},
                                      TraceReport* report = nullptr);

}  // namespace vog
