// cuda_runtime.h: CUDA C++ as C++: qualifiers, a thread's indices, barriers, atomic functions, launches.
#pragma once

#include <cuda_runtime_api.h>
#include <math.h>

#include <atomic>
#include <cstdint>
#include <functional>

#define __host__
#define __device__
#define __global__
#define __constant__
// Shared memory has a section of its own, so that a block finds it filled with 0xff bytes.
#define __shared__ static __attribute__((section("vog_shared")))
#define __launch_bounds__(...)

extern thread_local uint3 threadIdx, blockIdx;
extern thread_local dim3 blockDim, gridDim;
void __syncthreads();
int __syncthreads_or(int predicate);

struct cudaLaunchConfig_t {
    dim3 gridDim, blockDim;
    std::size_t dynamicSmemBytes;
    cudaStream_t stream;
    struct cudaLaunchAttribute* attrs;
    unsigned numAttrs;
};

namespace vog::emulation {

/// Runs `body` once for every thread of every block, when the default stream is waited for.
/// returns  cudaErrorInvalidConfiguration for shapes beyond a GPU's limits
cudaError_t launch_blocks(const cudaLaunchConfig_t& shape, std::function<void()> body);
/// Adds work to a stream, null: the default one; it runs when the stream is waited for.
void add_work(cudaStream_t stream, std::function<void()> work);
void finish_stream(cudaStream_t stream);

/// Memory of the GPU by other interfaces than CUDA's runtime.
void* allocate_memory(std::size_t bytes);
void release_memory(void* data);
/// Remembers an error for cudaGetLastError.
cudaError_t result(cudaError_t code);

}  // namespace vog::emulation

template <class... Formal, class... Actual>
cudaError_t cudaLaunchKernelEx(const cudaLaunchConfig_t* shape, void (*kernel)(Formal...),
                               Actual&&... arguments) {
    return vog::emulation::launch_blocks(
        *shape, [kernel, ... held = static_cast<Formal>(arguments)] { kernel(held...); });
}

template <class T>
T atomicAdd(T* at, T value) {
    return std::atomic_ref(*at).fetch_add(value);
}
template <class T>
T atomicMax(T* at, T value) {
    std::atomic_ref shared(*at);
    T old = shared.load();
    while (old < value && !shared.compare_exchange_weak(old, value)) {
    }
    return old;
}
