// optix_hierarchy.cpp: Acceleration structures: a compacted geometry acceleration structure (GAS) of
// custom primitives under an instance acceleration structure (IAS) of one instance.
#include <optix_stubs.h>

#include "render/gpu/optix/optix_pipeline.h"

namespace vog::gpu {

static_assert(sizeof(FloatBox) == sizeof(OptixAabb));

OptixHierarchy::OptixHierarchy(const OptixContext& context, const std::vector<FloatBox>& boxes) {
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
    bottom_ = build(context, primitives, true, bottom_nodes_);

    OptixInstance instance{};
    for (const int diagonal : {0, 5, 10}) instance.transform[diagonal] = 1;
    instance.visibilityMask = 255;
    instance.traversableHandle = bottom_;
    const GpuArray<OptixInstance> instances(std::vector<OptixInstance>{instance}, "instances");
    OptixBuildInput instanced{};
    instanced.type = OPTIX_BUILD_INPUT_TYPE_INSTANCES;
    instanced.instanceArray.instances = reinterpret_cast<CUdeviceptr>(instances.data());
    instanced.instanceArray.numInstances = 1;
    top_ = build(context, instanced, false, top_nodes_);
}

OptixTraversableHandle OptixHierarchy::build(const OptixContext& context,
                                             const OptixBuildInput& input, bool compact,
                                             GpuArray<std::byte>& out) {
    OptixAccelBuildOptions options{};
    options.buildFlags = OPTIX_BUILD_FLAG_PREFER_FAST_TRACE;
    if (compact) options.buildFlags |= OPTIX_BUILD_FLAG_ALLOW_COMPACTION;
    options.operation = OPTIX_BUILD_OPERATION_BUILD;
    OptixAccelBufferSizes sizes{};
    check_optix(optixAccelComputeMemoryUsage(context.get(), &options, &input, 1, &sizes),
                "sizing the hierarchy");
    GpuArray<std::byte> nodes(sizes.outputSizeInBytes, "nodes of the hierarchy");
    const GpuArray<std::byte> scratch(sizes.tempSizeInBytes, "scratch of the hierarchy");
    const GpuArray<std::size_t> compacted_bytes(1, "the size of the hierarchy");
    OptixAccelEmitDesc emitted{};
    emitted.type = OPTIX_PROPERTY_TYPE_COMPACTED_SIZE;
    emitted.result = reinterpret_cast<CUdeviceptr>(compacted_bytes.data());
    OptixTraversableHandle handle = 0;
    check_optix(
        optixAccelBuild(context.get(), nullptr, &options, &input, 1,
                        reinterpret_cast<CUdeviceptr>(scratch.data()), sizes.tempSizeInBytes,
                        reinterpret_cast<CUdeviceptr>(nodes.data()), sizes.outputSizeInBytes,
                        &handle, compact ? &emitted : nullptr, compact ? 1 : 0),
        "building the hierarchy");
    check_cuda(cudaDeviceSynchronize(), "building the hierarchy");
    if (compact) {
        std::size_t bytes = 0;
        compacted_bytes.copy_to(&bytes, 1, "sizing the hierarchy");
        if (bytes < sizes.outputSizeInBytes) {
            GpuArray<std::byte> smaller(bytes, "nodes of the compacted hierarchy");
            check_optix(
                optixAccelCompact(context.get(), nullptr, handle,
                                  reinterpret_cast<CUdeviceptr>(smaller.data()), bytes, &handle),
                "compacting the hierarchy");
            check_cuda(cudaDeviceSynchronize(), "compacting the hierarchy");
            nodes = std::move(smaller);
        }
    }
    out = std::move(nodes);
    return handle;
}

}  // namespace vog::gpu
