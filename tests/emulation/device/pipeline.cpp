// pipeline.cpp: What optix_device.cpp, optix_pipeline.cpp and optix_hierarchy.cpp do, without OptiX's headers.
#include <cstring>
#include <string>

#include "device/traversal.h"
#include "emulation.h"
#include "render/gpu/optix/optix_pipeline.h"

bool vog::emulation::has_function_table() { return false; }

namespace vog::gpu {

using namespace emulation;

struct OptixDevice {};

std::shared_ptr<OptixDevice> optix_device() {
    require_cuda();
    return std::make_shared<OptixDevice>();
}

std::size_t most_primitives(const OptixDevice&) { return emulation::most_primitives(); }

struct OptixRayPipeline::State {
    Programs programs;
    GpuArray<device::Launch> launch{1, "launch parameters"};
};

OptixRayPipeline::OptixRayPipeline(std::shared_ptr<OptixDevice>, const OptixEntryPoints& names)
    : state_(std::make_unique<State>()) {
    const auto program = [](const char* name) {
        const Program found = name ? find_program(name) : nullptr;
        if (name && !found) refuse(std::string("no program ") + name);
        return found;
    };
    state_->programs = {program(names.raygen), program(names.miss), program(names.intersection),
                        program(names.anyhit), program(names.closesthit)};
}

OptixRayPipeline::~OptixRayPipeline() = default;

void OptixRayPipeline::run(const device::Launch& launch) {
    check_cuda(cudaMemcpy(state_->launch.data(), &launch, sizeof(launch), cudaMemcpyHostToDevice),
               "sending launch parameters");
    run_programs(state_->programs, 1, *state_->launch.data(),
                 static_cast<unsigned>(launch.camera.width),
                 static_cast<unsigned>(launch.camera.height));
}

struct OptixHierarchy::State {
    GpuArray<std::byte> bottom, top;
};

OptixHierarchy::OptixHierarchy(std::shared_ptr<OptixDevice>, const std::vector<FloatBox>& boxes)
    : state_(std::make_unique<State>()) {
    static_assert(sizeof(FloatBox) == sizeof(PrimitiveBox));
    const GpuArray<FloatBox> on_gpu(boxes, "boxes of the hierarchy");
    state_->bottom = GpuArray<std::byte>(hierarchy_bytes(boxes.size()), "nodes of the hierarchy");
    write_hierarchy(state_->bottom.data(),
                    {reinterpret_cast<const PrimitiveBox*>(on_gpu.data()), boxes.size()}, true);
    state_->top = GpuArray<std::byte>(instance_bytes(), "instances");
    constexpr unsigned kVisible = 255;
    write_instance(state_->top.data(), state_->bottom.data(), kVisible, 0);
}

OptixHierarchy::~OptixHierarchy() = default;

std::uint64_t OptixHierarchy::handle() const {
    return reinterpret_cast<std::uint64_t>(state_->top.data());
}

}  // namespace vog::gpu
