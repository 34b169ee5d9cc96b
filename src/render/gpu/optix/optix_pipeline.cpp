// optix_pipeline.cpp: OptiX context, module, program groups and shader binding table.
#include "render/gpu/optix/optix_pipeline.h"

#include <fmt/core.h>
#include <optix_function_table_definition.h>
#include <optix_stack_size.h>
#include <optix_stubs.h>

#include "vog/error.h"

namespace vog::gpu {

void check_optix(OptixResult code, const char* doing) {
    if (code == OPTIX_SUCCESS) return;
    throw Error(fmt::format("optix: {}: {} ({})", doing, optixGetErrorString(code),
                            optixGetErrorName(code)));
}

OptixContext::OptixContext() {
    require_cuda();
    const OptixResult loaded = optixInit();
    if (loaded == OPTIX_ERROR_LIBRARY_NOT_FOUND)
        throw Error("optix: the NVIDIA driver has no OptiX (libnvoptix.so.1 cannot be loaded)");
    if (loaded == OPTIX_ERROR_UNSUPPORTED_ABI_VERSION)
        throw Error(fmt::format("optix: the NVIDIA driver is too old, expected one for OptiX {}.{}",
                                OPTIX_VERSION / 10000, OPTIX_VERSION % 10000 / 100));
    check_optix(loaded, "loading");
    check_optix(optixDeviceContextCreate(nullptr, nullptr, &context_), "starting");
}

void OptixDestroy::operator()(OptixModule module) const { optixModuleDestroy(module); }
void OptixDestroy::operator()(OptixProgramGroup group) const { optixProgramGroupDestroy(group); }
void OptixDestroy::operator()(OptixPipeline pipeline) const { optixPipelineDestroy(pipeline); }

OptixContext::~OptixContext() {
    if (context_) optixDeviceContextDestroy(context_);
}

namespace {

OptixPipelineCompileOptions pipeline_options() {
    OptixPipelineCompileOptions options{};
    options.traversableGraphFlags = OPTIX_TRAVERSABLE_GRAPH_FLAG_ALLOW_SINGLE_LEVEL_INSTANCING;
    options.numPayloadValues = device::kPayloadWords;
    options.numAttributeValues = device::kAttributeWords;
    options.exceptionFlags = OPTIX_EXCEPTION_FLAG_NONE;
    options.pipelineLaunchParamsVariableName = "launch";
    options.usesPrimitiveTypeFlags = OPTIX_PRIMITIVE_TYPE_FLAGS_CUSTOM;
    return options;
}

OptixModule compile(const OptixContext& context) {
    OptixModuleCompileOptions options{};
    options.optLevel = OPTIX_COMPILE_OPTIMIZATION_DEFAULT;
    options.debugLevel = OPTIX_COMPILE_DEBUG_LEVEL_NONE;
    const OptixPipelineCompileOptions pipeline = pipeline_options();
    std::array<char, 4096> log{};
    std::size_t log_bytes = log.size();
    OptixModule module = nullptr;
    const OptixResult code =
        optixModuleCreate(context.get(), &options, &pipeline, kOptixPrograms, kOptixProgramsBytes,
                          log.data(), &log_bytes, &module);
    if (code != OPTIX_SUCCESS)
        throw Error(fmt::format("optix: compiling the device module: {}: {}",
                                optixGetErrorName(code), log.data()));
    return module;
}

}  // namespace

OptixRayPipeline::OptixRayPipeline(const OptixContext& context,
                                   const OptixEntryPoints& entry_points) {
    module_.reset(compile(context));
    make_groups(context, entry_points);
    link(context);
    bind();
}

void OptixRayPipeline::make_groups(const OptixContext& context,
                                   const OptixEntryPoints& entry_points) {
    std::array<OptixProgramGroupDesc, 3> kinds{};
    kinds[0].kind = OPTIX_PROGRAM_GROUP_KIND_RAYGEN;
    kinds[0].raygen = {module_.get(), entry_points.raygen};
    kinds[1].kind = OPTIX_PROGRAM_GROUP_KIND_MISS;
    kinds[1].miss = {module_.get(), entry_points.miss};
    kinds[2].kind = OPTIX_PROGRAM_GROUP_KIND_HITGROUP;
    const auto module_of = [&](const char* name) { return name ? module_.get() : nullptr; };
    kinds[2].hitgroup = {module_of(entry_points.closesthit),   entry_points.closesthit,
                         module_of(entry_points.anyhit),       entry_points.anyhit,
                         module_of(entry_points.intersection), entry_points.intersection};
    std::array<OptixProgramGroup, 3> groups{};
    const OptixProgramGroupOptions options{};
    std::array<char, 4096> log{};
    std::size_t log_bytes = log.size();
    const OptixResult code =
        optixProgramGroupCreate(context.get(), kinds.data(), static_cast<unsigned>(kinds.size()),
                                &options, log.data(), &log_bytes, groups.data());
    for (std::size_t n = 0; n < groups.size(); ++n) groups_[n].reset(groups[n]);
    if (code != OPTIX_SUCCESS)
        throw Error(fmt::format("optix: finding {}: {}: {}", entry_points.raygen,
                                optixGetErrorName(code), log.data()));
}

void OptixRayPipeline::link(const OptixContext& context) {
    const OptixPipelineCompileOptions compiled = pipeline_options();
    OptixPipelineLinkOptions options{};
    options.maxTraceDepth = 1;  // primary rays only
    std::array<OptixProgramGroup, 3> groups{};
    for (std::size_t n = 0; n < groups.size(); ++n) groups[n] = groups_[n].get();
    std::array<char, 4096> log{};
    std::size_t log_bytes = log.size();
    OptixPipeline pipeline = nullptr;
    const OptixResult code = optixPipelineCreate(context.get(), &compiled, &options, groups.data(),
                                                 static_cast<unsigned>(groups.size()), log.data(),
                                                 &log_bytes, &pipeline);
    pipeline_.reset(pipeline);
    if (code != OPTIX_SUCCESS)
        throw Error(fmt::format("optix: linking: {}: {}", optixGetErrorName(code), log.data()));

    OptixStackSizes sizes{};
    for (const OptixProgramGroup group : groups)
        check_optix(optixUtilAccumulateStackSizes(group, &sizes, pipeline), "measuring the stack");
    unsigned from_traversal = 0, from_state = 0, continuation = 0;
    check_optix(optixUtilComputeStackSizes(&sizes, options.maxTraceDepth, 0, 0, &from_traversal,
                                           &from_state, &continuation),
                "measuring the stack");
    constexpr unsigned kGraphDepth = 2;  // IAS, GAS
    check_optix(
        optixPipelineSetStackSize(pipeline, from_traversal, from_state, continuation, kGraphDepth),
        "setting the stack");
}

void OptixRayPipeline::bind() {
    // Records have headers only: all data are in the launch parameters.
    std::vector<Record> records(groups_.size());
    for (std::size_t n = 0; n < groups_.size(); ++n)
        check_optix(optixSbtRecordPackHeader(groups_[n].get(), &records[n]), "packing records");
    records_ = GpuArray<Record>(records, "shader records");
    launch_ = GpuArray<device::Launch>(1, "launch parameters");
    const auto address = [&](std::size_t n) {
        return reinterpret_cast<CUdeviceptr>(records_.data() + n);
    };
    table_.raygenRecord = address(0);
    table_.missRecordBase = address(1);
    table_.missRecordStrideInBytes = sizeof(Record);
    table_.missRecordCount = 1;
    table_.hitgroupRecordBase = address(2);
    table_.hitgroupRecordStrideInBytes = sizeof(Record);
    table_.hitgroupRecordCount = 1;
}

void OptixRayPipeline::run(const device::Launch& launch) {
    check_cuda(cudaMemcpy(launch_.data(), &launch, sizeof(launch), cudaMemcpyHostToDevice),
               "sending launch parameters");
    check_optix(optixLaunch(pipeline_.get(), nullptr, reinterpret_cast<CUdeviceptr>(launch_.data()),
                            sizeof(launch), &table_, static_cast<unsigned>(launch.camera.width),
                            static_cast<unsigned>(launch.camera.height), 1),
                "launching");
}

}  // namespace vog::gpu
