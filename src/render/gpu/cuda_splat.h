// cuda_splat.h: Passes of splatting on the GPU. The kernels are compiled by nvcc (cuda_splat.cu);
// this interface has plain pointers only.
#pragma once

#include <cstddef>
#include <cstdint>

#include "render/device/tile_splat.h"

namespace vog::gpu {

/// Projects every Gaussian and counts the tiles that each touches.
void launch_project(const device::SplatGaussian* gaussians, std::int32_t count,
                    const device::Camera& camera, const device::SplatKernel& kernel,
                    device::TileSplat* splats, std::uint32_t* touched);

/// The same for a ray tracer: only Gaussians that rays leave out touch tiles.
/// shares  [count] factor on tau along rays; 0: left out
void launch_project_small(const device::Gaussian* gaussians, std::int32_t count,
                          const device::Camera& camera, const device::SplatKernel& kernel,
                          device::TileSplat* splats, std::uint32_t* touched, float* shares);

/// Bytes of scratch memory for prefix sums and sorts of these sizes.
std::size_t scan_bytes(std::int32_t gaussians);
std::size_t sort_bytes(std::int64_t entries, int key_bits);

/// offsets[i] = touched[0] + ... + touched[i].
void launch_scan(void* scratch, std::size_t bytes, const std::uint32_t* touched,
                 std::uint64_t* offsets, std::int32_t count);

/// Writes the entries (tile, splat) in the order of splats.
void launch_emit(const device::TileSplat* splats, const std::uint64_t* offsets, std::int32_t count,
                 std::int32_t tile_columns, std::uint32_t* tile, std::uint32_t* splat);

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

/// Arguments of the last pass, which adds up the splats of every tile.
struct TilePass {
    const device::SplatGaussian* gaussians;
    const device::TileSplat* splats;
    const std::uint64_t* first;
    const std::uint32_t* splat;
    device::Camera camera;
    device::Kernel kernel;
    std::int32_t tile_columns, tile_rows;
    float* depth;  ///< [height * width] T at extinction 1
};
void launch_tiles(const TilePass& pass);

}  // namespace vog::gpu
