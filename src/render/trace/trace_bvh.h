// trace_bvh.h: Embree's bounding volume hierarchy over a model, and traversal of one ray.
#pragma once

#include <memory>
#include <vector>

#include "render/device/field_hit.h"
#include "render/trace/trace_field.h"
#include "render/trace/trace_model.h"

namespace vog::trace {

/// Sums along a ray: tau, tau times the field's mean along the chord, and times that of its square.
struct FieldDepths {
    device::DepthSum column{}, first{}, second{};
};

/// Host counterpart of an OptiX acceleration structure. Refers to the model, which must outlive it.
class TraceBvh {
  public:
    explicit TraceBvh(const TraceModel& model);
    ~TraceBvh();
    TraceBvh(const TraceBvh&) = delete;
    TraceBvh& operator=(const TraceBvh&) = delete;

    /// Adds tau of every Gaussian on the ray to `sum`.
    /// shares   SmallGaussians::shares, or null; a Gaussian of share 0 is not hit
    /// returns  number of hits
    std::uint32_t accumulate(const device::Ray& ray, const float* shares,
                             device::DepthSum& sum) const;
    /// The same with a field.
    FieldDepths accumulate(const device::Ray& ray, const float* shares,
                           const TraceField& field) const;
    /// Fills `list` with the nearest hits after list.last, unsorted.
    void collect(const device::Ray& ray, const float* shares, device::HitList& list) const;

  private:
    struct Embree;
    std::unique_ptr<Embree> embree_;
    const TraceModel& model_;
};

}  // namespace vog::trace
