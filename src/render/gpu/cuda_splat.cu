// cuda_splat.cu: CUDA kernels of splatting. One thread a Gaussian until the entries are sorted by
// tile, then one block a tile and one thread a pixel; splats of a tile are read into shared memory
// in batches. No sorting by depth: T is a sum.
#include <cuda_runtime.h>

#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>

#include "render/gpu/cuda_splat.h"
#include "render/gpu/kernel_start.h"

namespace vog::gpu {

namespace {

using device::TileSplat;

__global__ void project_kernel(const device::SplatGaussian* gaussians, std::int32_t count,
                               device::Camera camera, device::SplatKernel kernel, TileSplat* splats,
                               std::uint64_t* touched, std::uint32_t* near) {
    const std::int64_t i = thread_index();
    if (i >= count) return;
    TileSplat splat;
    touched[i] = 0;
    if (!device::project(device::source_of(gaussians[i]), camera, kernel, splat)) return;
    splats[i] = splat;
    touched[i] = splat.near ? 1 : static_cast<std::uint64_t>(device::tile_count(splat));
    if (splat.near) atomicAdd(near, 1u);
}

__global__ void project_small_kernel(const device::Gaussian* gaussians, std::int32_t count,
                                     device::Camera camera, device::SplatKernel kernel,
                                     TileSplat* splats, std::uint64_t* touched, float* shares) {
    const std::int64_t i = thread_index();
    if (i >= count) return;
    TileSplat splat;
    const bool drawn =
        device::project(device::source_of(gaussians[i]), camera, kernel, splat) && splat.widened;
    if (drawn) splats[i] = splat;
    touched[i] = drawn ? static_cast<std::uint64_t>(device::tile_count(splat)) : 0;
    shares[i] = splat.widened ? 0.0f : splat.share;
}

__global__ void emit_kernel(const TileSplat* splats, const std::uint64_t* offsets,
                            std::int32_t count, std::int32_t tile_columns, std::int32_t tile_rows,
                            std::uint32_t* tile, std::uint32_t* splat) {
    const std::int64_t i = thread_index();
    if (i >= count) return;
    std::uint64_t at = i ? offsets[i - 1] : 0;
    if (at == offsets[i]) return;
    if (splats[i].near) {
        tile[at] = static_cast<std::uint32_t>(tile_columns * tile_rows);
        splat[at] = static_cast<std::uint32_t>(i);
        return;
    }
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
    const std::int64_t n = thread_index();
    if (n > count) return;
    const std::int64_t begin = n == 0 ? 0 : static_cast<std::int64_t>(tile[n - 1]) + 1;
    const std::int64_t end = n == count ? tiles : static_cast<std::int64_t>(tile[n]);
    for (std::int64_t t = begin; t <= end; ++t) first[t] = static_cast<std::uint64_t>(n);
}

__global__ void whiten_kernel(const device::SplatGaussian* gaussians, const std::uint32_t* splat,
                              std::int64_t count, device::Gaussian* near) {
    const std::int64_t n = thread_index();
    if (n < count) near[n] = device::whitened(gaussians[splat[n]]);
}

__device__ void add_to_pixel(const TilePass& pass, const TilePlace& at, float depth, bool first) {
    if (at.column >= pass.camera.width || at.row >= pass.camera.height) return;
    float& pixel =
        pass.depth[static_cast<std::size_t>(at.row) * static_cast<std::size_t>(pass.camera.width) +
                   static_cast<std::size_t>(at.column)];
    pixel = first ? depth : pixel + depth;
}

__global__ void __launch_bounds__(kBlock) tiles_kernel(TilePass pass) {
    constexpr int kBatch = 64;  // splats of 84 bytes: 5 kB a block, so many blocks a processor
    __shared__ TileSplat batch[kBatch];
    const TilePlace at = place_in(pass.tile_columns);
    // One sum a batch: the rounding error of 10,000 terms is then that of 160.
    float total = 0;
    const std::uint64_t end = pass.first[at.tile + 1];
    for (std::uint64_t begin = pass.first[at.tile]; begin < end; begin += kBatch) {
        const int filled = end - begin < kBatch ? static_cast<int>(end - begin) : kBatch;
        __syncthreads();
        if (at.thread < filled)
            batch[at.thread] =
                pass.splats[pass.splat[begin + static_cast<std::uint64_t>(at.thread)]];
        __syncthreads();
        float sum = 0;
        for (int n = 0; n < filled; ++n)
            sum += device::far_depth(batch[n], pass.kernel, at.column, at.row);
        total += sum;
    }
    const device::Double3 d = pass.camera.corner +
                              static_cast<double>(at.column) * pass.camera.step_x +
                              static_cast<double>(at.row) * pass.camera.step_y;
    add_to_pixel(pass, at, total * static_cast<float>(sqrt(device::dot(d, d))), true);
}

/// Adds the near Gaussians; one thread each leaves out those that the tile's rays cannot meet.
__global__ void __launch_bounds__(kBlock) near_kernel(TilePass pass) {
    constexpr int kBatch = 64;
    __shared__ device::Gaussian batch[kBatch];
    __shared__ bool meets[kBatch];
    const TilePlace at = place_in(pass.tile_columns);
    const device::Ray ray = device::whole_ray(pass.camera, at.column, at.row);
    float total = 0;
    for (std::int64_t begin = 0; begin < pass.near_count; begin += kBatch) {
        const std::int64_t left = pass.near_count - begin;
        const int filled = left < kBatch ? static_cast<int>(left) : kBatch;
        __syncthreads();
        if (at.thread < filled) {
            batch[at.thread] = pass.near[begin + at.thread];
            meets[at.thread] = device::may_meet(
                batch[at.thread],
                device::frustum_of(pass.camera, device::pixels_of(at.tile, pass.tile_columns)),
                pass.kernel.cutoff2);
        }
        __syncthreads();
        float sum = 0;
        for (int n = 0; n < filled; ++n)
            if (meets[n]) sum += device::near_depth(batch[n], ray, pass.kernel.cutoff2);
        total += sum;
    }
    add_to_pixel(pass, at, total, false);
}

/// Adds up the counts of the block's rays in shared memory, and the blocks' sums by atomics.
__global__ void count_kernel(const device::RayCounts* counts, std::int64_t pixels,
                             CountTotals* totals) {
    __shared__ unsigned long long hits[kBlock], slabs[kBlock];
    __shared__ unsigned most[kBlock];
    const std::int64_t pixel = thread_index();
    const int thread = static_cast<int>(threadIdx.x);
    const device::RayCounts own = pixel < pixels ? counts[pixel] : device::RayCounts{0, 0, 0};
    hits[thread] = own.hits;
    slabs[thread] = own.slabs;
    most[thread] = own.most_slabs;
    for (int half = kBlock / 2; half > 0; half /= 2) {
        __syncthreads();
        if (thread >= half) continue;
        hits[thread] += hits[thread + half];
        slabs[thread] += slabs[thread + half];
        if (most[thread + half] > most[thread]) most[thread] = most[thread + half];
    }
    if (thread > 0) return;
    atomicAdd(&totals->hits, hits[0]);
    atomicAdd(&totals->slabs, slabs[0]);
    atomicMax(&totals->most_slabs, most[0]);
}

}  // namespace

void launch_project(const device::SplatGaussian* gaussians, std::int32_t count,
                    const device::Camera& camera, const device::SplatKernel& kernel,
                    device::TileSplat* splats, std::uint64_t* touched, std::uint32_t* near) {
    start("projecting", project_kernel, count, gaussians, count, camera, kernel, splats, touched,
          near);
}

void launch_project_small(const device::Gaussian* gaussians, std::int32_t count,
                          const device::Camera& camera, const device::SplatKernel& kernel,
                          device::TileSplat* splats, std::uint64_t* touched, float* shares) {
    start("projecting", project_small_kernel, count, gaussians, count, camera, kernel, splats,
          touched, shares);
}

std::size_t scan_bytes(std::int32_t gaussians) {
    std::size_t bytes = 0;
    std::uint64_t* none = nullptr;
    check_cuda(cub::DeviceScan::InclusiveSum(nullptr, bytes, none, none, gaussians),
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

void launch_scan(void* scratch, std::size_t bytes, std::uint64_t* touched, std::int32_t count) {
    check_cuda(cub::DeviceScan::InclusiveSum(scratch, bytes, touched, touched, count),
               "summing tiles");
}

void launch_emit(const device::TileSplat* splats, const std::uint64_t* offsets, std::int32_t count,
                 std::int32_t tile_columns, std::int32_t tile_rows, std::uint32_t* tile,
                 std::uint32_t* splat) {
    start("listing tiles", emit_kernel, count, splats, offsets, count, tile_columns, tile_rows,
          tile, splat);
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
    start("finding tiles", ranges_kernel, count + 1, tile, count, tiles, first);
}

void launch_whiten(const device::SplatGaussian* gaussians, const std::uint32_t* splat,
                   std::int64_t count, device::Gaussian* near) {
    start("listing near Gaussians", whiten_kernel, count, gaussians, splat, count, near);
}

void launch_tiles(const TilePass& pass) {
    static_assert(device::kSplatTile * device::kSplatTile == kBlock);
    const std::int64_t tiles = std::int64_t{pass.tile_columns} * pass.tile_rows;
    start("rendering tiles", tiles_kernel, tiles * kBlock, pass);
    if (pass.near_count > 0) start("rendering near Gaussians", near_kernel, tiles * kBlock, pass);
}

void launch_count(const device::RayCounts* counts, std::int64_t pixels, CountTotals* totals) {
    start("adding up counts", count_kernel, pixels, counts, pixels, totals);
}

}  // namespace vog::gpu
