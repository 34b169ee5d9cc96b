// vector.h: 3D vectors for code that is compiled for the host and for the device.
// Headers of this folder use only this one and <math.h> (voxels/voxel_walk.h also NanoVDB): no standard
// library, and plain structs that are copied to a GPU byte for byte.
#pragma once

#include <math.h>
#include <stdint.h>

#if defined(__CUDACC__)
#define VOG_HD __host__ __device__ inline
#elif defined(VOG_EMULATED_KERNEL)
// Clang: a copy for this source, whose executed lines are counted (tests/emulation).
#define VOG_HD __attribute__((internal_linkage)) inline
#elif defined(VOG_FLOAT_PAIRS)
// GCC: no copy that the linker could take for the host's, whose rays are doubles.
#define VOG_HD __attribute__((always_inline)) inline
#else
#define VOG_HD inline
#endif
/// Before a loop whose arrays are to stay in registers.
#if defined(__CUDA_ARCH__)
#define VOG_UNROLL _Pragma("unroll")
#else
#define VOG_UNROLL
#endif

namespace vog::device {

struct Float3 {
    float x, y, z;
};
struct Double3 {
    double x, y, z;
};

VOG_HD Float3 operator+(Float3 a, Float3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
VOG_HD Float3 operator-(Float3 a, Float3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
VOG_HD Float3 operator*(float s, Float3 a) { return {s * a.x, s * a.y, s * a.z}; }
VOG_HD float dot(Float3 a, Float3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
VOG_HD Float3 cross(Float3 a, Float3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

VOG_HD Double3 operator+(Double3 a, Double3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
VOG_HD Double3 operator-(Double3 a, Double3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
VOG_HD Double3 operator*(double s, Double3 a) { return {s * a.x, s * a.y, s * a.z}; }
VOG_HD double dot(Double3 a, Double3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
VOG_HD Double3 cross(Double3 a, Double3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

VOG_HD Float3 to_float(Double3 a) {
    return {static_cast<float>(a.x), static_cast<float>(a.y), static_cast<float>(a.z)};
}
VOG_HD Double3 to_double(Float3 a) {
    return {static_cast<double>(a.x), static_cast<double>(a.y), static_cast<double>(a.z)};
}

}  // namespace vog::device
