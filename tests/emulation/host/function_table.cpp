// function_table.cpp: A library in the place of the driver's libnvoptix.so.1: the function table that OptiX's stubs
// ask for. It refuses what the driver would refuse, or leave undefined, and ends the process there.
#include <optix.h>
#include <optix_function_table.h>

#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "device/traversal.h"
#include "emulation.h"

using namespace vog::emulation;

namespace {

/// Objects of a context, which must all be gone before it.
struct Context {
    int objects = 0;
    bool validates = false;
    OptixLogCallback log = nullptr;
    void* log_data = nullptr;
};
struct Module {
    Context* context;
    OptixPipelineCompileOptions options;
};
struct Group {
    Context* context;
    OptixProgramGroupKind kind;
    Program single = nullptr;  ///< ray generation or miss
    Program intersection = nullptr, anyhit = nullptr, closesthit = nullptr;
};
struct Pipeline {
    Context* context;
    std::vector<Group*> groups;
    unsigned trace_depth = 0;
    unsigned graph_depth = 0;  ///< 0 until the stack is set
};

/// First words of a record, by optixSbtRecordPackHeader.
struct Header {
    std::uint64_t mark;
    Group* group;
};
constexpr std::uint64_t kHeaderMark = 0x5b7eadull;

void require(bool condition, const char* what) {
    if (!condition) refuse(std::string("OptiX: ") + what);
}
bool aligned(CUdeviceptr at, std::uint64_t to) { return at % to == 0; }
template <class T>
T* pointer(CUdeviceptr at) {
    return reinterpret_cast<T*>(at);
}

const char* name_of(OptixResult code) {
    return code == OPTIX_SUCCESS ? "OPTIX_SUCCESS" : "OPTIX_ERROR_INVALID_VALUE";
}

OptixResult create_context(CUcontext, const OptixDeviceContextOptions* options,
                           OptixDeviceContext* out) {
    auto* context = new Context;
    if (options) {
        require(options->logCallbackLevel >= 0 && options->logCallbackLevel <= 4, "log level");
        context->validates = options->validationMode == OPTIX_DEVICE_CONTEXT_VALIDATION_MODE_ALL;
        context->log = options->logCallbackFunction;
        context->log_data = options->logCallbackData;
        if (context->log && options->logCallbackLevel == 4)
            context->log(4, "EMULATION", context->validates ? "context with validation" : "context",
                         context->log_data);
    }
    count_context();
    *out = reinterpret_cast<OptixDeviceContext>(context);
    return OPTIX_SUCCESS;
}
OptixResult destroy_context(OptixDeviceContext handle) {
    auto* context = reinterpret_cast<Context*>(handle);
    require(context->objects == 0, "a context is destroyed before its objects");
    delete context;
    return OPTIX_SUCCESS;
}
OptixResult context_property(OptixDeviceContext, OptixDeviceProperty property, void* value,
                             std::size_t bytes) {
    if (property != OPTIX_DEVICE_PROPERTY_LIMIT_MAX_PRIMITIVES_PER_GAS || bytes != sizeof(unsigned))
        return OPTIX_ERROR_INVALID_VALUE;
    *static_cast<unsigned*>(value) = static_cast<unsigned>(most_primitives());
    return OPTIX_SUCCESS;
}

OptixResult create_module(OptixDeviceContext handle, const OptixModuleCompileOptions*,
                          const OptixPipelineCompileOptions* options, const char* text,
                          std::size_t bytes, char*, std::size_t*, OptixModule* out) {
    require(std::string(text, strnlen(text, bytes)).starts_with("// emulated device module"),
            "another device module than this library's");
    require(options->numPayloadValues == vog::device::kPayloadWords, "payload words");
    require(options->numAttributeValues == vog::device::kAttributeWords, "attribute words");
    require(std::strcmp(options->pipelineLaunchParamsVariableName, "launch") == 0,
            "the name of the launch parameters");
    require(options->traversableGraphFlags ==
                OPTIX_TRAVERSABLE_GRAPH_FLAG_ALLOW_SINGLE_LEVEL_INSTANCING,
            "a graph of one level of instances");
    require(options->usesPrimitiveTypeFlags == OPTIX_PRIMITIVE_TYPE_FLAGS_CUSTOM,
            "primitives that are not custom ones");
    auto* context = reinterpret_cast<Context*>(handle);
    ++context->objects;
    count_module();
    *out = reinterpret_cast<OptixModule>(new Module{context, *options});
    return OPTIX_SUCCESS;
}
OptixResult destroy_module(OptixModule handle) {
    auto* module = reinterpret_cast<Module*>(handle);
    --module->context->objects;
    delete module;
    return OPTIX_SUCCESS;
}

Program program(OptixModule module, const char* name, const char* prefix) {
    if (!name) {
        require(!module, "a module without an entry point");
        return nullptr;
    }
    require(module, "an entry point without a module");
    require(std::string(name).starts_with(prefix), "an entry point of another kind");
    const Program found = find_program(name);
    require(found, "an entry point that the module lacks");
    return found;
}
OptixResult create_groups(OptixDeviceContext handle, const OptixProgramGroupDesc* kinds,
                          unsigned count, const OptixProgramGroupOptions*, char*, std::size_t*,
                          OptixProgramGroup* out) {
    auto* context = reinterpret_cast<Context*>(handle);
    for (unsigned n = 0; n < count; ++n) {
        auto* group = new Group{context, kinds[n].kind};
        switch (group->kind) {
            case OPTIX_PROGRAM_GROUP_KIND_RAYGEN:
                group->single = program(kinds[n].raygen.module, kinds[n].raygen.entryFunctionName,
                                        "__raygen__");
                require(group->single, "a ray generation group without a program");
                break;
            case OPTIX_PROGRAM_GROUP_KIND_MISS:
                group->single =
                    program(kinds[n].miss.module, kinds[n].miss.entryFunctionName, "__miss__");
                break;
            case OPTIX_PROGRAM_GROUP_KIND_HITGROUP: {
                const OptixProgramGroupHitgroup& hit = kinds[n].hitgroup;
                group->closesthit =
                    program(hit.moduleCH, hit.entryFunctionNameCH, "__closesthit__");
                group->anyhit = program(hit.moduleAH, hit.entryFunctionNameAH, "__anyhit__");
                group->intersection =
                    program(hit.moduleIS, hit.entryFunctionNameIS, "__intersection__");
                require(group->intersection, "custom primitives without an intersection program");
                break;
            }
            default:
                require(false, "a kind of group that no pipeline here has");
        }
        ++context->objects;
        out[n] = reinterpret_cast<OptixProgramGroup>(group);
    }
    return OPTIX_SUCCESS;
}
OptixResult destroy_group(OptixProgramGroup handle) {
    auto* group = reinterpret_cast<Group*>(handle);
    --group->context->objects;
    delete group;
    return OPTIX_SUCCESS;
}
OptixResult group_stack(OptixProgramGroup, OptixStackSizes* sizes, OptixPipeline) {
    *sizes = {};
    sizes->cssRG = 128, sizes->cssIS = 64, sizes->cssAH = 32;
    return OPTIX_SUCCESS;
}

OptixResult create_pipeline(OptixDeviceContext handle, const OptixPipelineCompileOptions*,
                            const OptixPipelineLinkOptions* options,
                            const OptixProgramGroup* groups, unsigned count, char*, std::size_t*,
                            OptixPipeline* out) {
    auto* context = reinterpret_cast<Context*>(handle);
    require(options->maxTraceDepth == 1, "a depth of traces beyond primary rays");
    auto* pipeline = new Pipeline{context, {}, options->maxTraceDepth};
    for (unsigned n = 0; n < count; ++n)
        pipeline->groups.push_back(reinterpret_cast<Group*>(groups[n]));
    ++context->objects;
    *out = reinterpret_cast<OptixPipeline>(pipeline);
    return OPTIX_SUCCESS;
}
OptixResult destroy_pipeline(OptixPipeline handle) {
    auto* pipeline = reinterpret_cast<Pipeline*>(handle);
    --pipeline->context->objects;
    delete pipeline;
    return OPTIX_SUCCESS;
}
OptixResult set_stack(OptixPipeline handle, unsigned, unsigned, unsigned continuation,
                      unsigned graph_depth) {
    require(continuation >= 128 + 64, "a continuation stack smaller than the programs need");
    require(graph_depth == 2, "a graph of an instance and a hierarchy is two deep");
    reinterpret_cast<Pipeline*>(handle)->graph_depth = graph_depth;
    return OPTIX_SUCCESS;
}

/// A driver's tree takes more before it is compacted.
std::size_t uncompacted(std::size_t bytes) { return 2 * bytes + 256; }
constexpr std::size_t kScratchBytes = 1024;

std::size_t bytes_of(const OptixBuildInput& input) {
    return input.type == OPTIX_BUILD_INPUT_TYPE_INSTANCES
               ? instance_bytes()
               : hierarchy_bytes(input.customPrimitiveArray.numPrimitives);
}
OptixResult memory_usage(OptixDeviceContext, const OptixAccelBuildOptions* options,
                         const OptixBuildInput* input, unsigned count,
                         OptixAccelBufferSizes* sizes) {
    require(count == 1 && options->operation == OPTIX_BUILD_OPERATION_BUILD, "one new hierarchy");
    *sizes = {uncompacted(bytes_of(*input)), kScratchBytes, 0};
    return OPTIX_SUCCESS;
}
void build_primitives(const OptixBuildInputCustomPrimitiveArray& input, CUdeviceptr out) {
    static_assert(sizeof(PrimitiveBox) == sizeof(OptixAabb));
    require(input.numSbtRecords == 1 && input.flags, "one record for all primitives");
    require(input.strideInBytes == 0 || input.strideInBytes == sizeof(OptixAabb), "a stride");
    require(aligned(input.aabbBuffers[0], OPTIX_AABB_BUFFER_BYTE_ALIGNMENT),
            "boxes that are not aligned");
    require(input.numPrimitives <= most_primitives(), "too many primitives");
    write_hierarchy(pointer<void>(out),
                    {pointer<const PrimitiveBox>(input.aabbBuffers[0]), input.numPrimitives},
                    input.flags[0] & OPTIX_GEOMETRY_FLAG_REQUIRE_SINGLE_ANYHIT_CALL);
}
void build_instance(const OptixBuildInputInstanceArray& input, CUdeviceptr out) {
    require(input.numInstances == 1, "one instance");
    require(aligned(input.instances, OPTIX_INSTANCE_BYTE_ALIGNMENT), "an instance not aligned");
    const auto& instance = *pointer<const OptixInstance>(input.instances);
    for (int n = 0; n < 12; ++n)
        require(instance.transform[n] == (n % 5 == 0 ? 1.0f : 0.0f), "an instance that is moved");
    write_instance(pointer<void>(out), pointer<const void>(instance.traversableHandle),
                   instance.visibilityMask, instance.sbtOffset);
}
OptixResult build(OptixDeviceContext, CUstream, const OptixAccelBuildOptions* options,
                  const OptixBuildInput* input, unsigned count, CUdeviceptr scratch,
                  std::size_t scratch_bytes, CUdeviceptr out, std::size_t out_bytes,
                  OptixTraversableHandle* handle, const OptixAccelEmitDesc* emitted,
                  unsigned emitted_count) {
    require(count == 1, "one build input");
    require(aligned(scratch, OPTIX_ACCEL_BUFFER_BYTE_ALIGNMENT) && scratch_bytes >= kScratchBytes,
            "scratch memory");
    require(aligned(out, OPTIX_ACCEL_BUFFER_BYTE_ALIGNMENT) &&
                out_bytes >= uncompacted(bytes_of(*input)),
            "memory of a hierarchy");
    std::memset(pointer<void>(scratch), 0xee, scratch_bytes);
    if (input->type == OPTIX_BUILD_INPUT_TYPE_CUSTOM_PRIMITIVES)
        build_primitives(input->customPrimitiveArray, out);
    else
        build_instance(input->instanceArray, out);
    if (emitted_count > 0) {
        require(emitted_count == 1 && emitted->type == OPTIX_PROPERTY_TYPE_COMPACTED_SIZE &&
                    aligned(emitted->result, sizeof(std::uint64_t)),
                "the property of a hierarchy");
        require(options->buildFlags & OPTIX_BUILD_FLAG_ALLOW_COMPACTION,
                "the compacted size of a hierarchy that is not to be compacted");
        *pointer<std::uint64_t>(emitted->result) = bytes_of(*input);
    }
    *handle = out;
    return OPTIX_SUCCESS;
}
OptixResult compact(OptixDeviceContext, CUstream, OptixTraversableHandle from, CUdeviceptr out,
                    std::size_t, OptixTraversableHandle* handle) {
    require(aligned(out, OPTIX_ACCEL_BUFFER_BYTE_ALIGNMENT), "memory of a compacted hierarchy");
    move_hierarchy(pointer<void>(from), pointer<void>(out));
    *handle = out;
    return OPTIX_SUCCESS;
}

OptixResult pack_header(OptixProgramGroup group, void* record) {
    std::memset(record, 0xee, OPTIX_SBT_RECORD_HEADER_SIZE);
    const Header header{kHeaderMark, reinterpret_cast<Group*>(group)};
    std::memcpy(record, &header, sizeof(header));
    return OPTIX_SUCCESS;
}
const Group& group_at(CUdeviceptr record, OptixProgramGroupKind kind) {
    require(record && aligned(record, OPTIX_SBT_RECORD_ALIGNMENT), "a record that is not aligned");
    const auto& header = *pointer<const Header>(record);
    require(header.mark == kHeaderMark && header.group->kind == kind, "a record's header");
    return *header.group;
}
OptixResult start(OptixPipeline handle, CUstream, CUdeviceptr parameters, std::size_t bytes,
                  const OptixShaderBindingTable* table, unsigned width, unsigned height,
                  unsigned depth) {
    const auto& pipeline = *reinterpret_cast<const Pipeline*>(handle);
    require(pipeline.graph_depth > 0, "a pipeline whose stack is not set");
    require(bytes == sizeof(vog::device::Launch) && depth == 1, "launch parameters");
    require(aligned(table->missRecordStrideInBytes, OPTIX_SBT_RECORD_ALIGNMENT) &&
                aligned(table->hitgroupRecordStrideInBytes, OPTIX_SBT_RECORD_ALIGNMENT) &&
                table->missRecordCount == 1,
            "strides of records");
    const Group& raygen = group_at(table->raygenRecord, OPTIX_PROGRAM_GROUP_KIND_RAYGEN);
    const Group& miss = group_at(table->missRecordBase, OPTIX_PROGRAM_GROUP_KIND_MISS);
    const Group& hit = group_at(table->hitgroupRecordBase, OPTIX_PROGRAM_GROUP_KIND_HITGROUP);
    run_programs({raygen.single, miss.single, hit.intersection, hit.anyhit, hit.closesthit},
                 table->hitgroupRecordCount, *pointer<const vog::device::Launch>(parameters), width,
                 height);
    return OPTIX_SUCCESS;
}

}  // namespace

extern "C" __attribute__((visibility("default"))) OptixResult optixQueryFunctionTable(
    int abi, unsigned options, OptixQueryFunctionTableOptions*, const void**, void* out,
    std::size_t bytes) {
    if (abi != OPTIX_ABI_VERSION) return OPTIX_ERROR_UNSUPPORTED_ABI_VERSION;
    if (options != 0 || bytes != sizeof(OptixFunctionTable))
        return OPTIX_ERROR_FUNCTION_TABLE_SIZE_MISMATCH;
    OptixFunctionTable table{};
    table.optixGetErrorName = name_of;
    table.optixGetErrorString = name_of;
    table.optixDeviceContextCreate = create_context;
    table.optixDeviceContextDestroy = destroy_context;
    table.optixDeviceContextGetProperty = context_property;
    table.optixModuleCreate = create_module;
    table.optixModuleDestroy = destroy_module;
    table.optixProgramGroupCreate = create_groups;
    table.optixProgramGroupDestroy = destroy_group;
    table.optixProgramGroupGetStackSize = group_stack;
    table.optixPipelineCreate = create_pipeline;
    table.optixPipelineDestroy = destroy_pipeline;
    table.optixPipelineSetStackSize = set_stack;
    table.optixAccelComputeMemoryUsage = memory_usage;
    table.optixAccelBuild = build;
    table.optixAccelCompact = compact;
    table.optixSbtRecordPackHeader = pack_header;
    table.optixLaunch = start;
    std::memcpy(out, &table, sizeof(table));
    return OPTIX_SUCCESS;
}
