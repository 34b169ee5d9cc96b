// chord_tracer.h: OptiX's rays through the Gaussians of a picture of chords. No OptiX headers here.
#pragma once

#include <memory>
#include <vector>

#include "render/device/launch.h"
#include "render/trace/trace_model.h"

namespace vog::gpu {

/// Hierarchy of a model's boxes and the two pipelines over it.
class ChordTracer {
  public:
    /// boxes   one at least
    /// throws  vog::Error without OptiX, for too many boxes or too little memory
    explicit ChordTracer(const std::vector<trace::FloatBox>& boxes);
    ~ChordTracer();

    /// Launches one ray a pixel: of slabs, where launch.chords has values of them, else of sums.
    void run(device::Launch launch);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace vog::gpu
