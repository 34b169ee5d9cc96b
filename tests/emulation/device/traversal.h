// traversal.h: Rays through hierarchies of boxes, and the programs that they call.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>

#include "render/device/launch.h"

namespace vog::emulation {

using Program = void (*)();

/// Programs of one launch; null where a pipeline has none.
struct Programs {
    Program raygen, miss, intersection, anyhit, closesthit;
};
/// The program of optix_programs.cu with this name, or null.
Program find_program(const char* name);

/// Box of a primitive: OptixAabb.
struct PrimitiveBox {
    float lower[3], upper[3];
};

/// A hierarchy lies in GPU memory, so that memory freed or moved too early shows.
/// single_anyhit  OPTIX_GEOMETRY_FLAG_REQUIRE_SINGLE_ANYHIT_CALL
/// returns        bytes that write_hierarchy takes
std::size_t hierarchy_bytes(std::size_t boxes);
void write_hierarchy(void* memory, std::span<const PrimitiveBox> boxes, bool single_anyhit);
/// Copies it and overwrites the first one.
void move_hierarchy(void* from, void* to);
/// A hierarchy of one instance.
std::size_t instance_bytes();
void write_instance(void* memory, const void* hierarchy, unsigned mask, unsigned record_offset);

/// Launches one ray generation program a pixel, in a scrambled order, several at once.
/// hit_records  number of hit records of the shader binding table
void run_programs(const Programs& programs, unsigned hit_records, const device::Launch& parameters,
                  unsigned width, unsigned height);

// What programs call.
struct Ray {
    float origin[3], direction[3];
    float begin, end;
    unsigned mask, flags;
    unsigned record_offset, record_stride, miss_record;
};
struct RayState {
    unsigned column, row;
    unsigned payload[device::kPayloadWords];
    float begin, end;
    unsigned primitive;
    unsigned attribute[device::kAttributeWords];
    bool ignored;
};
RayState& ray_state();
void trace(std::uint64_t handle, const Ray& ray, std::span<unsigned> payload);
bool report(float t, std::initializer_list<unsigned> attributes);

}  // namespace vog::emulation
