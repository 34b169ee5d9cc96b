// kernel_start.h: Launches of kernels with one thread an item.
#pragma once

#include <cuda_runtime.h>

#include <cstdint>

#include "render/device/tile_splat.h"
#include "render/gpu/cuda_memory.h"

namespace vog::gpu {

constexpr int kBlock = 256;

/// Starts a kernel with one thread for each of `count` items, count >= 1.
template <class... Formal, class... Actual>
void start(const char* doing, void (*kernel)(Formal...), std::int64_t count, Actual... arguments) {
    cudaLaunchConfig_t shape = {};
    shape.gridDim = dim3(static_cast<unsigned>((count + kBlock - 1) / kBlock));
    shape.blockDim = dim3(kBlock);
    check_cuda(cudaLaunchKernelEx(&shape, kernel, arguments...), doing);
}

__device__ inline std::int64_t thread_index() {
    return static_cast<std::int64_t>(blockIdx.x) * blockDim.x + threadIdx.x;
}

/// Place of a thread in the picture: a block is a tile, a thread a pixel.
struct TilePlace {
    std::int32_t tile, thread, column, row;
};
__device__ inline TilePlace place_in(std::int32_t tile_columns) {
    const auto t = static_cast<std::int32_t>(blockIdx.x);
    const auto thread = static_cast<std::int32_t>(threadIdx.x);
    return {t, thread, t % tile_columns * device::kSplatTile + thread % device::kSplatTile,
            t / tile_columns * device::kSplatTile + thread / device::kSplatTile};
}

}  // namespace vog::gpu
