// cuda_passes.cpp: Projection, sums, entries, sort, ranges, tiles.
#include "render/gpu/cuda_passes.h"

#include <algorithm>
#include <bit>

namespace vog::gpu {

namespace {

template <class T>
T read_back(const T* from, const char* what) {
    T value{};
    check_cuda(cudaMemcpy(&value, from, sizeof(T), cudaMemcpyDeviceToHost), what);
    return value;
}

}  // namespace

SplatPasses::SplatPasses(std::int32_t count) : count_(count) {
    const auto n = static_cast<std::size_t>(count);
    splats_ = GpuArray<device::TileSplat>(n, "projected Gaussians");
    touched_ = GpuArray<std::uint64_t>(n, "counts of tiles");
    near_count_ = GpuArray<std::uint32_t>(1, "the count of near Gaussians");
}

void SplatPasses::draw(const device::SplatGaussian* gaussians, const device::SplatKernel& kernel,
                       const device::Camera& camera, float* depth) {
    check_cuda(cudaMemset(near_count_.data(), 0, sizeof(std::uint32_t)), "projecting");
    launch_project(gaussians, count_, camera, kernel, splats_.data(), touched_.data(),
                   near_count_.data());
    add_up(gaussians, kernel, camera, depth);
}

void SplatPasses::draw_small(const device::Gaussian* gaussians, const device::SplatKernel& kernel,
                             const device::Camera& camera, float* shares, float* depth) {
    launch_project_small(gaussians, count_, camera, kernel, splats_.data(), touched_.data(),
                         shares);
    // Widened Gaussians are clear of the eye plane: none is integrated at each pixel.
    add_up(nullptr, kernel, camera, depth);
}

void SplatPasses::list(ChordProjection& projection) {
    device::ChordPicture& picture = projection.picture;
    check_cuda(cudaMemset(near_count_.data(), 0, sizeof(std::uint32_t)), "projecting");
    projection.count = count_;
    projection.splats = splats_.data();
    projection.touched = touched_.data();
    projection.near = near_count_.data();
    launch_project_chords(projection);
    const Lists lists = bin(picture.camera, true);
    picture.splats = splats_.data();
    picture.first = first_.data();
    picture.entry = lists.splat;
    picture.near_last = static_cast<std::int64_t>(lists.entries);
    picture.near_first = picture.near_last - static_cast<std::int64_t>(lists.near);
    picture.tile_columns = lists.columns;
}

SplatPasses::Lists SplatPasses::bin(const device::Camera& camera, bool any_near) {
    const std::int32_t columns = (camera.width + device::kSplatTile - 1) / device::kSplatTile;
    const std::int32_t rows = (camera.height + device::kSplatTile - 1) / device::kSplatTile;
    // One more list than tiles, of the near splats.
    const std::int32_t lists = columns * rows + 1;
    first_.reserve(static_cast<std::size_t>(lists) + 1, "tiles");
    const std::size_t to_scan = scan_bytes(count_);
    scratch_.reserve(to_scan, "scratch of the sum");
    launch_scan(scratch_.data(), to_scan, touched_.data(), count_);

    // The number of entries to sort is read back between the two passes.
    const std::uint64_t total = read_back(touched_.data() + (count_ - 1), "counting tiles");
    const std::uint32_t near =
        any_near ? read_back(near_count_.data(), "counting near Gaussians") : 0;
    const auto entry_count = static_cast<std::int64_t>(total);
    tiles_.reserve(2 * total, "entries of tiles");
    indices_.reserve(2 * total, "entries of tiles");
    const int key_bits = std::max<int>(1, std::bit_width(static_cast<unsigned>(lists - 1)));
    SortedEntries entries{tiles_.data(), tiles_.data() + total, indices_.data(),
                          indices_.data() + total};
    if (total > 0) {
        const std::size_t to_sort = sort_bytes(entry_count, key_bits);
        scratch_.reserve(to_sort, "scratch of the sort");
        launch_emit(splats_.data(), touched_.data(), count_, columns, rows, entries.tile,
                    entries.splat);
        launch_sort(scratch_.data(), to_sort, entries, entry_count, key_bits);
    }
    launch_ranges(entries.tile, entry_count, lists, first_.data());
    return {columns, rows, total, near, entries.splat};
}

void SplatPasses::add_up(const device::SplatGaussian* gaussians, const device::SplatKernel& kernel,
                         const device::Camera& camera, float* depth) {
    const Lists lists = bin(camera, gaussians != nullptr);
    if (lists.near > 0) {
        near_.reserve(lists.near, "near Gaussians");
        launch_whiten(gaussians, lists.splat + (lists.entries - lists.near),
                      static_cast<std::int64_t>(lists.near), near_.data());
    }
    launch_tiles({splats_.data(), first_.data(), lists.splat, near_.data(),
                  static_cast<std::int64_t>(lists.near), camera, kernel.kernel, lists.columns,
                  lists.rows, depth});
}

}  // namespace vog::gpu
