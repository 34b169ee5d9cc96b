// trace_bvh.h: Embree's hierarchy over the boxes of a model, and one ray through it.
#pragma once

#include <memory>

#include "render/trace/trace_model.h"

namespace vog::trace {

/// Traverses as OptiX would; keeps a pointer to the model.
class TraceBvh {
  public:
    explicit TraceBvh(const TraceModel& model);
    ~TraceBvh();
    TraceBvh(const TraceBvh&) = delete;
    TraceBvh& operator=(const TraceBvh&) = delete;

    /// Adds every Gaussian's tau to `sum`.
    /// returns  hits
    std::uint32_t accumulate(const device::Ray& ray, device::DepthSum& sum) const;
    /// Fills `list` with the nearest hits of its slab, unsorted.
    void collect(const device::Ray& ray, device::HitList& list) const;

  private:
    struct Embree;
    std::unique_ptr<Embree> embree_;
    const TraceModel& model_;
};

}  // namespace vog::trace
