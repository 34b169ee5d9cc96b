// optix_device.cpp: OptiX's library, context and device module.
#include <fmt/core.h>
#include <optix_function_table_definition.h>
#include <optix_stubs.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <mutex>

#include "render/gpu/optix/optix_host.h"
#include "vog/error.h"

namespace vog::gpu {

void check_optix(OptixResult code, const char* doing) {
    if (code == OPTIX_SUCCESS) return;
    throw Error(fmt::format("optix: {}: {} ({})", doing, optixGetErrorString(code),
                            optixGetErrorName(code)));
}

void OptixDestroy::operator()(OptixDeviceContext context) const {
    optixDeviceContextDestroy(context);
}
void OptixDestroy::operator()(OptixModule module) const { optixModuleDestroy(module); }
void OptixDestroy::operator()(OptixProgramGroup group) const { optixProgramGroupDestroy(group); }
void OptixDestroy::operator()(OptixPipeline pipeline) const { optixPipelineDestroy(pipeline); }

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

namespace {

void log(unsigned level, const char* tag, const char* message, void*) {
    std::fputs(fmt::format("optix: [{}] {}: {}\n", level, tag, message).c_str(), stderr);
}

OptixOwned<OptixDeviceContext> make_context() {
    const OptixResult loaded = optixInit();
    if (loaded == OPTIX_ERROR_LIBRARY_NOT_FOUND)
        throw Error("optix: the NVIDIA driver has no OptiX (libnvoptix.so.1 cannot be loaded)");
    if (loaded == OPTIX_ERROR_UNSUPPORTED_ABI_VERSION)
        throw Error(fmt::format("optix: the NVIDIA driver is too old, expected one for OptiX {}.{}",
                                OPTIX_VERSION / 10000, OPTIX_VERSION % 10000 / 100));
    check_optix(loaded, "loading");
    OptixDeviceContextOptions options{};
    const char* debug = std::getenv("VOG_OPTIX_DEBUG");
    if (debug && *debug) {
        constexpr int kAllMessages = 4;
        options.logCallbackFunction = log;
        options.logCallbackLevel = kAllMessages;
        options.validationMode = OPTIX_DEVICE_CONTEXT_VALIDATION_MODE_ALL;
    }
    OptixDeviceContext context = nullptr;
    check_optix(optixDeviceContextCreate(nullptr, &options, &context), "starting");
    return OptixOwned<OptixDeviceContext>(context);
}

OptixOwned<OptixModule> compile(OptixDeviceContext context) {
    OptixModuleCompileOptions options{};
    options.optLevel = OPTIX_COMPILE_OPTIMIZATION_DEFAULT;
    options.debugLevel = OPTIX_COMPILE_DEBUG_LEVEL_NONE;
    const OptixPipelineCompileOptions pipeline = pipeline_options();
    std::array<char, 4096> messages{};
    std::size_t bytes = messages.size();
    OptixModule module = nullptr;
    const OptixResult code =
        optixModuleCreate(context, &options, &pipeline, kOptixPrograms, kOptixProgramsBytes,
                          messages.data(), &bytes, &module);
    if (code != OPTIX_SUCCESS)
        throw Error(fmt::format("optix: compiling the device module: {}: {}",
                                optixGetErrorName(code), messages.data()));
    return OptixOwned<OptixModule>(module);
}

}  // namespace

std::shared_ptr<OptixDevice> optix_device() {
    static std::mutex making;
    static std::map<int, std::weak_ptr<OptixDevice>> all;
    const std::lock_guard lock(making);
    require_cuda();
    int current = 0;
    check_cuda(cudaGetDevice(&current), "asking for the device");
    std::weak_ptr<OptixDevice>& made = all[current];
    if (std::shared_ptr<OptixDevice> device = made.lock()) return device;
    auto device = std::make_shared<OptixDevice>();
    device->context = make_context();
    device->module = compile(device->context.get());
    made = device;
    return device;
}

std::size_t most_primitives(const OptixDevice& device) {
    unsigned most = 0;
    check_optix(optixDeviceContextGetProperty(device.context.get(),
                                              OPTIX_DEVICE_PROPERTY_LIMIT_MAX_PRIMITIVES_PER_GAS,
                                              &most, sizeof(most)),
                "asking for its limits");
    return most;
}

}  // namespace vog::gpu
