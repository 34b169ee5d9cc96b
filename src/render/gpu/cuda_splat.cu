// cuda_splat.cu: CUDA kernels of splatting. One thread a Gaussian until the entries are sorted by
// tile, then one block a tile and one thread a pixel; splats of a tile are read into shared memory
// in batches. No sorting by depth: T is a sum.
#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>

#include "render/gpu/cuda_memory.h"
#include "render/gpu/cuda_splat.h"

namespace vog::gpu {

namespace {

using device::TileSplat;

constexpr int kBlock = 256;

int blocks_for(std::int64_t count) { return static_cast<int>((count + kBlock - 1) / kBlock); }

__global__ void project_kernel(const device::SplatGaussian* gaussians, std::int32_t count,
                               device::Camera camera, device::SplatKernel kernel, TileSplat* splats,
                               std::uint32_t* touched) {
    const std::int32_t i = static_cast<std::int32_t>(blockIdx.x * blockDim.x + threadIdx.x);
    if (i >= count) return;
    TileSplat splat;
    std::uint32_t tiles = 0;
    if (device::project(device::source_of(gaussians[i]), camera, kernel, splat)) {
        const device::PixelRange range = device::tiles_of(splat.pixels);
        tiles = static_cast<std::uint32_t>((range.x1 - range.x0 + 1) * (range.y1 - range.y0 + 1));
        splats[i] = splat;
    }
    touched[i] = tiles;
}

__global__ void project_small_kernel(const device::Gaussian* gaussians, std::int32_t count,
                                     device::Camera camera, device::SplatKernel kernel,
                                     TileSplat* splats, std::uint32_t* touched, float* shares) {
    const std::int32_t i = static_cast<std::int32_t>(blockIdx.x * blockDim.x + threadIdx.x);
    if (i >= count) return;
    TileSplat splat;
    std::uint32_t tiles = 0;
    const bool drawn = device::project(device::source_of(gaussians[i]), camera, kernel, splat);
    if (drawn && splat.widened) {
        const device::PixelRange range = device::tiles_of(splat.pixels);
        tiles = static_cast<std::uint32_t>((range.x1 - range.x0 + 1) * (range.y1 - range.y0 + 1));
        splats[i] = splat;
    }
    touched[i] = tiles;
    shares[i] = splat.widened ? 0.0f : splat.share;
}

__global__ void emit_kernel(const TileSplat* splats, const std::uint64_t* offsets,
                            std::int32_t count, std::int32_t tile_columns, std::uint32_t* tile,
                            std::uint32_t* splat) {
    const std::int32_t i = static_cast<std::int32_t>(blockIdx.x * blockDim.x + threadIdx.x);
    if (i >= count) return;
    std::uint64_t at = i ? offsets[i - 1] : 0;
    if (at == offsets[i]) return;
    const device::PixelRange range = device::tiles_of(splats[i].pixels);
    for (std::int32_t y = range.y0; y <= range.y1; ++y)
        for (std::int32_t x = range.x0; x <= range.x1; ++x) {
            tile[at] = static_cast<std::uint32_t>(y * tile_columns + x);
            splat[at++] = static_cast<std::uint32_t>(i);
        }
}

/// Thread n writes first[t] for the tiles t after that of entry n - 1, up to that of entry n.
__global__ void ranges_kernel(const std::uint32_t* tile, std::int64_t count, std::int32_t tiles,
                              std::uint64_t* first) {
    const std::int64_t n = static_cast<std::int64_t>(blockIdx.x) * blockDim.x + threadIdx.x;
    if (n > count) return;
    const std::int64_t begin = n == 0 ? 0 : static_cast<std::int64_t>(tile[n - 1]) + 1;
    const std::int64_t end = n == count ? tiles : static_cast<std::int64_t>(tile[n]);
    for (std::int64_t t = begin; t <= end; ++t) first[t] = static_cast<std::uint64_t>(n);
}

__global__ void __launch_bounds__(kBlock) tiles_kernel(TilePass pass) {
    constexpr int kBatch = 64;  // splats of 92 bytes: 6 kB a block, so many blocks a processor
    __shared__ TileSplat batch[kBatch];
    __shared__ std::uint32_t index[kBatch];
    const int thread = static_cast<int>(threadIdx.x);
    const std::int32_t t = static_cast<std::int32_t>(blockIdx.x);
    const std::int32_t column =
        t % pass.tile_columns * device::kSplatTile + thread % device::kSplatTile;
    const std::int32_t row =
        t / pass.tile_columns * device::kSplatTile + thread / device::kSplatTile;
    const device::Double3 d = pass.camera.corner +
                              static_cast<double>(column) * pass.camera.step_x +
                              static_cast<double>(row) * pass.camera.step_y;
    const float slant = static_cast<float>(sqrt(device::dot(d, d)));

    // One sum a batch: the rounding error of 10,000 terms is then that of 160.
    float total = 0;
    for (std::uint64_t at = pass.first[t]; at < pass.first[t + 1]; at += kBatch) {
        const int filled =
            static_cast<int>(min(static_cast<unsigned long long>(kBatch),
                                 static_cast<unsigned long long>(pass.first[t + 1] - at)));
        __syncthreads();
        if (thread < filled) {
            index[thread] = pass.splat[at + static_cast<std::uint64_t>(thread)];
            batch[thread] = pass.splats[index[thread]];
        }
        __syncthreads();
        float far = 0, near = 0;
        for (int n = 0; n < filled; ++n) {
            if (batch[n].near)
                near += device::near_depth(pass.gaussians[index[n]], pass.camera,
                                           pass.kernel.cutoff2, column, row);
            else
                far += device::far_depth(batch[n], pass.kernel, column, row);
        }
        total += far * slant + near;
    }
    if (column < pass.camera.width && row < pass.camera.height)
        pass.depth[static_cast<std::size_t>(row) * static_cast<std::size_t>(pass.camera.width) +
                   static_cast<std::size_t>(column)] = total;
}

}  // namespace

void launch_project(const device::SplatGaussian* gaussians, std::int32_t count,
                    const device::Camera& camera, const device::SplatKernel& kernel,
                    device::TileSplat* splats, std::uint32_t* touched) {
    project_kernel<<<blocks_for(count), kBlock>>>(gaussians, count, camera, kernel, splats,
                                                  touched);
    check_cuda(cudaGetLastError(), "projecting");
}

void launch_project_small(const device::Gaussian* gaussians, std::int32_t count,
                          const device::Camera& camera, const device::SplatKernel& kernel,
                          device::TileSplat* splats, std::uint32_t* touched, float* shares) {
    project_small_kernel<<<blocks_for(count), kBlock>>>(gaussians, count, camera, kernel, splats,
                                                        touched, shares);
    check_cuda(cudaGetLastError(), "projecting");
}

std::size_t scan_bytes(std::int32_t gaussians) {
    std::size_t bytes = 0;
    check_cuda(
        cub::DeviceScan::InclusiveSum(nullptr, bytes, static_cast<const std::uint32_t*>(nullptr),
                                      static_cast<std::uint64_t*>(nullptr), gaussians),
        "sizing the sum");
    return bytes;
}

std::size_t sort_bytes(std::int64_t entries, int key_bits) {
    std::size_t bytes = 0;
    cub::DoubleBuffer<std::uint32_t> none;
    check_cuda(cub::DeviceRadixSort::SortPairs(nullptr, bytes, none, none, entries, 0, key_bits),
               "sizing the sort");
    return bytes;
}

void launch_scan(void* scratch, std::size_t bytes, const std::uint32_t* touched,
                 std::uint64_t* offsets, std::int32_t count) {
    check_cuda(cub::DeviceScan::InclusiveSum(scratch, bytes, touched, offsets, count),
               "summing tiles");
}

void launch_emit(const device::TileSplat* splats, const std::uint64_t* offsets, std::int32_t count,
                 std::int32_t tile_columns, std::uint32_t* tile, std::uint32_t* splat) {
    emit_kernel<<<blocks_for(count), kBlock>>>(splats, offsets, count, tile_columns, tile, splat);
    check_cuda(cudaGetLastError(), "listing tiles");
}

void launch_sort(void* scratch, std::size_t bytes, SortedEntries& entries, std::int64_t count,
                 int key_bits) {
    cub::DoubleBuffer<std::uint32_t> tile(entries.tile, entries.other_tile);
    cub::DoubleBuffer<std::uint32_t> splat(entries.splat, entries.other_splat);
    check_cuda(cub::DeviceRadixSort::SortPairs(scratch, bytes, tile, splat, count, 0, key_bits),
               "sorting by tile");
    entries = {tile.Current(), tile.Alternate(), splat.Current(), splat.Alternate()};
}

void launch_ranges(const std::uint32_t* tile, std::int64_t count, std::int32_t tiles,
                   std::uint64_t* first) {
    ranges_kernel<<<blocks_for(count + 1), kBlock>>>(tile, count, tiles, first);
    check_cuda(cudaGetLastError(), "finding tiles");
}

void launch_tiles(const TilePass& pass) {
    static_assert(device::kSplatTile * device::kSplatTile == kBlock);
    tiles_kernel<<<pass.tile_columns * pass.tile_rows, kBlock>>>(pass);
    check_cuda(cudaGetLastError(), "rendering tiles");
}

}  // namespace vog::gpu
