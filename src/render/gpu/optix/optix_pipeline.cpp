// optix_pipeline.cpp: OptiX program groups, pipelines and shader binding tables.
#include <fmt/core.h>
#include <optix_stack_size.h>
#include <optix_stubs.h>

#include <array>

#include "render/gpu/optix/optix_host.h"
#include "vog/error.h"

namespace vog::gpu {

namespace {

struct alignas(OPTIX_SBT_RECORD_ALIGNMENT) Record {
    std::array<char, OPTIX_SBT_RECORD_HEADER_SIZE> header;
};

}  // namespace

struct OptixRayPipeline::State {
    std::shared_ptr<OptixDevice> device;
    std::array<OptixOwned<OptixProgramGroup>, 3> groups;  ///< ray generation, miss, hit
    OptixOwned<OptixPipeline> pipeline;
    GpuArray<Record> records;
    OptixShaderBindingTable table{};
    GpuArray<device::Launch> launch;

    void make_groups(const OptixEntryPoints& entry_points);
    void link();
    void bind();
};

OptixRayPipeline::OptixRayPipeline(std::shared_ptr<OptixDevice> device,
                                   const OptixEntryPoints& entry_points)
    : state_(std::make_unique<State>()) {
    state_->device = std::move(device);
    state_->make_groups(entry_points);
    state_->link();
    state_->bind();
}

OptixRayPipeline::~OptixRayPipeline() = default;

void OptixRayPipeline::State::make_groups(const OptixEntryPoints& entry_points) {
    const OptixModule module = device->module.get();
    const auto module_of = [&](const char* name) { return name ? module : nullptr; };
    std::array<OptixProgramGroupDesc, 3> kinds{};
    kinds[0].kind = OPTIX_PROGRAM_GROUP_KIND_RAYGEN;
    kinds[0].raygen = {module, entry_points.raygen};
    kinds[1].kind = OPTIX_PROGRAM_GROUP_KIND_MISS;
    kinds[1].miss = {module_of(entry_points.miss), entry_points.miss};
    kinds[2].kind = OPTIX_PROGRAM_GROUP_KIND_HITGROUP;
    kinds[2].hitgroup = {module_of(entry_points.closesthit),   entry_points.closesthit,
                         module_of(entry_points.anyhit),       entry_points.anyhit,
                         module_of(entry_points.intersection), entry_points.intersection};
    std::array<OptixProgramGroup, 3> made{};
    const OptixProgramGroupOptions options{};
    std::array<char, 4096> messages{};
    std::size_t bytes = messages.size();
    const OptixResult code = optixProgramGroupCreate(device->context.get(), kinds.data(),
                                                     static_cast<unsigned>(kinds.size()), &options,
                                                     messages.data(), &bytes, made.data());
    for (std::size_t n = 0; n < made.size(); ++n) groups[n].reset(made[n]);
    if (code != OPTIX_SUCCESS)
        throw Error(fmt::format("optix: finding {}: {}: {}", entry_points.raygen,
                                optixGetErrorName(code), messages.data()));
}

void OptixRayPipeline::State::link() {
    const OptixPipelineCompileOptions compiled = pipeline_options();
    OptixPipelineLinkOptions options{};
    options.maxTraceDepth = 1;  // primary rays only
    std::array<OptixProgramGroup, 3> linked{};
    for (std::size_t n = 0; n < linked.size(); ++n) linked[n] = groups[n].get();
    std::array<char, 4096> messages{};
    std::size_t bytes = messages.size();
    OptixPipeline made = nullptr;
    const OptixResult code =
        optixPipelineCreate(device->context.get(), &compiled, &options, linked.data(),
                            static_cast<unsigned>(linked.size()), messages.data(), &bytes, &made);
    pipeline.reset(made);
    if (code != OPTIX_SUCCESS)
        throw Error(
            fmt::format("optix: linking: {}: {}", optixGetErrorName(code), messages.data()));

    OptixStackSizes sizes{};
    for (const OptixProgramGroup group : linked)
        check_optix(optixUtilAccumulateStackSizes(group, &sizes, made), "measuring the stack");
    unsigned from_traversal = 0, from_state = 0, continuation = 0;
    check_optix(optixUtilComputeStackSizes(&sizes, options.maxTraceDepth, 0, 0, &from_traversal,
                                           &from_state, &continuation),
                "measuring the stack");
    constexpr unsigned kGraphDepth = 2;  // IAS, GAS
    check_optix(
        optixPipelineSetStackSize(made, from_traversal, from_state, continuation, kGraphDepth),
        "setting the stack");
}

void OptixRayPipeline::State::bind() {
    // Records have headers only: all data are in the launch parameters.
    std::vector<Record> packed(groups.size());
    for (std::size_t n = 0; n < groups.size(); ++n)
        check_optix(optixSbtRecordPackHeader(groups[n].get(), &packed[n]), "packing records");
    records = GpuArray<Record>(packed, "shader records");
    launch = GpuArray<device::Launch>(1, "launch parameters");
    const auto address = [&](std::size_t n) {
        return reinterpret_cast<CUdeviceptr>(records.data() + n);
    };
    table.raygenRecord = address(0);
    table.missRecordBase = address(1);
    table.missRecordStrideInBytes = sizeof(Record);
    table.missRecordCount = 1;
    table.hitgroupRecordBase = address(2);
    table.hitgroupRecordStrideInBytes = sizeof(Record);
    table.hitgroupRecordCount = 1;
}

void OptixRayPipeline::run(const device::Launch& launch) {
    State& s = *state_;
    check_cuda(cudaMemcpy(s.launch.data(), &launch, sizeof(launch), cudaMemcpyHostToDevice),
               "sending launch parameters");
    check_optix(
        optixLaunch(s.pipeline.get(), nullptr, reinterpret_cast<CUdeviceptr>(s.launch.data()),
                    sizeof(launch), &s.table, static_cast<unsigned>(launch.camera.width),
                    static_cast<unsigned>(launch.camera.height), 1),
        "launching");
}

}  // namespace vog::gpu
