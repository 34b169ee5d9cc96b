// cuda_splat.h: the passes of the GPU's tile renderer. The kernels are compiled by nvcc in a source
// of their own (cuda_splat.cu), behind this interface of plain pointers.
#pragma once

#include <cstddef>
#include <cstdint>

#include "render/device/tile_splat.h"

namespace vog::gpu {

/// Projects every Gaussian and counts the tiles each touches.
void launch_project(const device::SplatGaussian* gaussians, std::int32_t count,
                    const device::Camera& camera, double cutoff, device::TileSplat* splats,
                    std::uint32_t* touched);

/// Bytes of scratch memory that sums and sorts of these sizes take.
std::size_t scan_bytes(std::int32_t gaussians);
std::size_t sort_bytes(std::int64_t entries, int key_bits);

/// offsets[i] = touched[0] + ... + touched[i].
void launch_scan(void* scratch, std::size_t bytes, const std::uint32_t* touched,
                 std::uint64_t* offsets, std::int32_t count);

/// Entries (tile, splat) in the order of splats.
void launch_emit(const device::TileSplat* splats, const std::uint64_t* offsets, std::int32_t count,
                 std::int32_t tile_columns, std::uint32_t* tile, std::uint32_t* splat);

/// Two halves of a buffer each for keys and values; sorted ones may end up in either.
struct SortedEntries {
    std::uint32_t *tile, *other_tile, *splat, *other_splat;
};
/// A stable radix sort by tile: the order within a tile stays that of the splats, so that sums are
/// the same every time. On return, `tile` and `splat` are the sorted halves.
void launch_sort(void* scratch, std::size_t bytes, SortedEntries& entries, std::int64_t count,
                 int key_bits);

/// first[t] ... first[t + 1]: entries of tile t. `first` has tiles + 1 elements.
void launch_ranges(const std::uint32_t* tile, std::int64_t count, std::int32_t tiles,
                   std::uint64_t* first);

struct TilePass {
    const device::SplatGaussian* gaussians;
    const device::TileSplat* splats;
    const std::uint64_t* first;
    const std::uint32_t* splat;
    device::Camera camera;
    device::Kernel kernel;
    std::int32_t tile_columns, tile_rows;
    float* depth;
};
void launch_tiles(const TilePass& pass);

}  // namespace vog::gpu
