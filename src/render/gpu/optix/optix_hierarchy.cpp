// optix_hierarchy.cpp: Acceleration structures: a compacted geometry acceleration structure (GAS) of
// custom primitives under an instance acceleration structure (IAS) of one instance.
#include <optix_stubs.h>

#include "render/gpu/optix/optix_host.h"
#include "vog/error.h"

namespace vog::gpu {

namespace {

static_assert(sizeof(FloatBox) == sizeof(OptixAabb));

struct Built {
    GpuArray<std::byte> nodes;
    OptixTraversableHandle handle = 0;
};

/// The built structure in a buffer of its compacted size; as it is where memory for both at once is short.
void compact(OptixDeviceContext context, std::size_t bytes, Built& built) {
    if (bytes >= built.nodes.size()) return;
    GpuArray<std::byte> smaller;
    try {
        smaller = GpuArray<std::byte>(bytes, "nodes of the compacted hierarchy");
    } catch (const Error&) {
        return;
    }
    check_optix(
        optixAccelCompact(context, nullptr, built.handle,
                          reinterpret_cast<CUdeviceptr>(smaller.data()), bytes, &built.handle),
        "compacting the hierarchy");
    check_cuda(cudaDeviceSynchronize(), "compacting the hierarchy");
    built.nodes = std::move(smaller);
}

/// Builds one acceleration structure.
/// compacted  copy it to a buffer of its compacted size
Built build(OptixDeviceContext context, const OptixBuildInput& input, bool compacted) {
    OptixAccelBuildOptions options{};
    options.buildFlags = OPTIX_BUILD_FLAG_PREFER_FAST_TRACE;
    if (compacted) options.buildFlags |= OPTIX_BUILD_FLAG_ALLOW_COMPACTION;
    options.operation = OPTIX_BUILD_OPERATION_BUILD;
    OptixAccelBufferSizes sizes{};
    check_optix(optixAccelComputeMemoryUsage(context, &options, &input, 1, &sizes),
                "sizing the hierarchy");
    Built built;
    built.nodes = GpuArray<std::byte>(sizes.outputSizeInBytes, "nodes of the hierarchy");
    GpuArray<std::byte> scratch(sizes.tempSizeInBytes, "scratch of the hierarchy");
    const GpuArray<std::size_t> compacted_bytes(1, "the size of the hierarchy");
    OptixAccelEmitDesc emitted{};
    emitted.type = OPTIX_PROPERTY_TYPE_COMPACTED_SIZE;
    emitted.result = reinterpret_cast<CUdeviceptr>(compacted_bytes.data());
    check_optix(
        optixAccelBuild(context, nullptr, &options, &input, 1,
                        reinterpret_cast<CUdeviceptr>(scratch.data()), sizes.tempSizeInBytes,
                        reinterpret_cast<CUdeviceptr>(built.nodes.data()), sizes.outputSizeInBytes,
                        &built.handle, compacted ? &emitted : nullptr, compacted ? 1 : 0),
        "building the hierarchy");
    check_cuda(cudaDeviceSynchronize(), "building the hierarchy");
    scratch = GpuArray<std::byte>();
    if (compacted) {
        std::size_t bytes = 0;
        compacted_bytes.copy_to(&bytes, 1, "sizing the hierarchy");
        compact(context, bytes, built);
    }
    return built;
}

Built build_bottom(OptixDeviceContext context, const std::vector<FloatBox>& boxes) {
    const GpuArray<FloatBox> on_gpu(boxes, "boxes of the hierarchy");
    const CUdeviceptr box_address = reinterpret_cast<CUdeviceptr>(on_gpu.data());
    // One any-hit call a hit: a second call would add the hit twice.
    const unsigned flags = OPTIX_GEOMETRY_FLAG_REQUIRE_SINGLE_ANYHIT_CALL;
    OptixBuildInput primitives{};
    primitives.type = OPTIX_BUILD_INPUT_TYPE_CUSTOM_PRIMITIVES;
    primitives.customPrimitiveArray.aabbBuffers = &box_address;
    primitives.customPrimitiveArray.numPrimitives = static_cast<unsigned>(boxes.size());
    primitives.customPrimitiveArray.flags = &flags;
    primitives.customPrimitiveArray.numSbtRecords = 1;
    return build(context, primitives, true);
}

Built build_top(OptixDeviceContext context, OptixTraversableHandle bottom) {
    OptixInstance instance{};
    for (const int diagonal : {0, 5, 10}) instance.transform[diagonal] = 1;
    instance.visibilityMask = 255;
    instance.traversableHandle = bottom;
    const GpuArray<OptixInstance> instances(std::vector<OptixInstance>{instance}, "instances");
    OptixBuildInput instanced{};
    instanced.type = OPTIX_BUILD_INPUT_TYPE_INSTANCES;
    instanced.instanceArray.instances = reinterpret_cast<CUdeviceptr>(instances.data());
    instanced.instanceArray.numInstances = 1;
    return build(context, instanced, false);
}

}  // namespace

struct OptixHierarchy::State {
    std::shared_ptr<OptixDevice> device;
    Built bottom, top;
};

OptixHierarchy::OptixHierarchy(std::shared_ptr<OptixDevice> device,
                               const std::vector<FloatBox>& boxes)
    : state_(std::make_unique<State>()) {
    const OptixDeviceContext context = device->context.get();
    state_->device = std::move(device);
    state_->bottom = build_bottom(context, boxes);
    state_->top = build_top(context, state_->bottom.handle);
}

OptixHierarchy::~OptixHierarchy() = default;

std::uint64_t OptixHierarchy::handle() const { return state_->top.handle; }

}  // namespace vog::gpu
