// cuda_splat.h: Passes of splatting on the GPU. The kernels are compiled by nvcc (cuda_splat.cu);
// this interface has plain pointers only.
#pragma once

#include <cstddef>
#include <cstdint>

#include "render/device/launch.h"
#include "render/device/tile_splat.h"

namespace vog::gpu {

/// Projects every Gaussian and counts the tiles that each touches. One that reaches the eye plane counts once,
/// for the list of near Gaussians, which every tile adds.
/// touched  [count]
/// near     number of near Gaussians is added to it
void launch_project(const device::SplatGaussian* gaussians, std::int32_t count,
                    const device::Camera& camera, const device::SplatKernel& kernel,
                    device::TileSplat* splats, std::uint64_t* touched, std::uint32_t* near);

/// The same for a ray tracer: only Gaussians that rays leave out touch tiles; none is near.
/// shares  [count] factor on tau along rays; 0: left out
void launch_project_small(const device::Gaussian* gaussians, std::int32_t count,
                          const device::Camera& camera, const device::SplatKernel& kernel,
                          device::TileSplat* splats, std::uint64_t* touched, float* shares);

/// Bytes of scratch memory for prefix sums and sorts of these sizes.
std::size_t scan_bytes(std::int32_t gaussians);
std::size_t sort_bytes(std::int64_t entries, int key_bits);

/// touched[i] = touched[0] + ... + touched[i], in place. 64 bits: 2^31 Gaussians touch up to 2^24 tiles each.
void launch_scan(void* scratch, std::size_t bytes, std::uint64_t* touched, std::int32_t count);

/// Writes the entries (tile, splat) in the order of splats; near splats have the tile behind the last.
/// offsets  [count] sums by launch_scan
void launch_emit(const device::TileSplat* splats, const std::uint64_t* offsets, std::int32_t count,
                 std::int32_t tile_columns, std::int32_t tile_rows, std::uint32_t* tile,
                 std::uint32_t* splat);

/// Double buffers of keys (tiles) and values (splats).
struct SortedEntries {
    std::uint32_t *tile, *other_tile, *splat, *other_splat;
};
/// Stable radix sort by tile: within a tile the order of splats is kept, so that sums are the same in
/// every run. On return, `tile` and `splat` are the sorted halves.
void launch_sort(void* scratch, std::size_t bytes, SortedEntries& entries, std::int64_t count,
                 int key_bits);

/// Finds the entries of each tile t, first[t] ... first[t + 1] - 1.
/// first  [tiles + 1]
void launch_ranges(const std::uint32_t* tile, std::int64_t count, std::int32_t tiles,
                   std::uint64_t* first);

/// Writes the near Gaussians in the form of intersect().
/// splat  [count] their indices
/// near   [count]
void launch_whiten(const device::SplatGaussian* gaussians, const std::uint32_t* splat,
                   std::int64_t count, device::Gaussian* near);

/// Arguments of the last pass, which adds up the splats of every tile and the near Gaussians.
struct TilePass {
    const device::TileSplat* splats;
    const std::uint64_t* first;
    const std::uint32_t* splat;
    const device::Gaussian* near;
    std::int64_t near_count;
    device::Camera camera;
    device::Kernel kernel;
    std::int32_t tile_columns, tile_rows;
    float* depth;  ///< [height * width] T at extinction 1
};
void launch_tiles(const TilePass& pass);

/// Sums over the rays of a picture.
struct CountTotals {
    unsigned long long hits, slabs;
    unsigned most_slabs;
};
/// Adds up counts of rays; `totals` is cleared before.
void launch_count(const device::RayCounts* counts, std::int64_t pixels, CountTotals* totals);

}  // namespace vog::gpu
