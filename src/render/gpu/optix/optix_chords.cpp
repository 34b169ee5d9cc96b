// optix_chords.cpp: ChordTracer.
#include <fmt/core.h>

#include "render/gpu/chords/chord_tracer.h"
#include "render/gpu/optix/optix_pipeline.h"
#include "vog/error.h"

namespace vog::gpu {

struct ChordTracer::State {
    std::shared_ptr<OptixDevice> device = optix_device();
    OptixRayPipeline sums{device, kSumsEntryPoints};
    OptixRayPipeline slabs{device, kSlabsEntryPoints};
    std::unique_ptr<OptixHierarchy> hierarchy;
};

ChordTracer::ChordTracer(const std::vector<FloatBox>& boxes) : state_(std::make_unique<State>()) {
    require_primitives(*state_->device, boxes.size());
    state_->hierarchy = std::make_unique<OptixHierarchy>(state_->device, boxes);
}

ChordTracer::~ChordTracer() = default;

void ChordTracer::run(device::Launch launch) {
    launch.traversable = state_->hierarchy->handle();
    (launch.chords.slabs.values ? state_->slabs : state_->sums).run(launch);
}

}  // namespace vog::gpu
