// optix.h: OptiX as programs on the device see it; the functions are those of device/traversal.cpp.
#pragma once

#include <cuda_runtime.h>

#include <bit>
#include <cstdint>

#include "device/traversal.h"

using OptixVisibilityMask = unsigned;
constexpr unsigned OPTIX_RAY_FLAG_DISABLE_ANYHIT = 1, OPTIX_RAY_FLAG_DISABLE_CLOSESTHIT = 8;

struct float3 {
    float x, y, z;
};
inline float3 make_float3(float x, float y, float z) { return {x, y, z}; }
inline unsigned __float_as_uint(float value) { return std::bit_cast<unsigned>(value); }
inline float __uint_as_float(unsigned bits) { return std::bit_cast<float>(bits); }

inline uint3 optixGetLaunchIndex() {
    const vog::emulation::RayState& state = vog::emulation::ray_state();
    return {state.column, state.row, 0};
}
inline unsigned optixGetPayload_0() { return vog::emulation::ray_state().payload[0]; }
inline unsigned optixGetPayload_1() { return vog::emulation::ray_state().payload[1]; }
inline unsigned optixGetPrimitiveIndex() { return vog::emulation::ray_state().primitive; }
inline float optixGetRayTmin() { return vog::emulation::ray_state().begin; }
inline float optixGetRayTmax() { return vog::emulation::ray_state().end; }
inline unsigned optixGetAttribute_0() { return vog::emulation::ray_state().attribute[0]; }
inline unsigned optixGetAttribute_1() { return vog::emulation::ray_state().attribute[1]; }
inline unsigned optixGetAttribute_2() { return vog::emulation::ray_state().attribute[2]; }
inline unsigned optixGetAttribute_3() { return vog::emulation::ray_state().attribute[3]; }
inline void optixIgnoreIntersection() { vog::emulation::ray_state().ignored = true; }

template <class... Attribute>
bool optixReportIntersection(float t, unsigned, Attribute... attributes) {
    return vog::emulation::report(t, {attributes...});
}

template <class... Payload>
void optixTrace(std::uint64_t handle, float3 origin, float3 direction, float begin, float end,
                float, OptixVisibilityMask mask, unsigned flags, unsigned record_offset,
                unsigned record_stride, unsigned miss_record, Payload&... payload) {
    const vog::emulation::Ray ray{{origin.x, origin.y, origin.z},
                                  {direction.x, direction.y, direction.z},
                                  begin,
                                  end,
                                  mask,
                                  flags,
                                  record_offset,
                                  record_stride,
                                  miss_record};
    unsigned words[] = {payload...};
    vog::emulation::trace(handle, ray, words);
    int n = 0;
    ((payload = words[n++]), ...);
}
