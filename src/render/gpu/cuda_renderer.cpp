// cuda_renderer.cpp: CudaSplat: GPU memory, and the order of the passes of a picture.
#include <algorithm>
#include <bit>

#include "render/gpu/cuda_memory.h"
#include "render/gpu/cuda_model.h"
#include "render/gpu/cuda_splat.h"
#include "render/trace/trace_model.h"
#include "vog/gpu.h"

namespace vog {

using namespace gpu;
using namespace trace;

struct CudaSplat::State {
    CudaModel model;
    std::int32_t count = 0;
    GpuArray<device::SplatGaussian> gaussians;
    GpuArray<device::TileSplat> splats;
    GpuArray<std::uint32_t> touched;
    GpuArray<std::uint64_t> offsets, first;
    GpuArray<std::uint32_t> tiles, indices;  ///< two halves each, for the sort
    GpuArray<std::byte> scratch;
    GpuArray<float> depth;
    GpuTimer timer;

    void bin(const device::Camera& camera, std::int32_t tile_columns, std::int32_t tile_count,
             SortedEntries& entries);
};

CudaSplat::CudaSplat(const Gaussians& gaussians, double kappa) {
    CudaModel model = cuda_model(gaussians, kappa);
    require_cuda();
    state_ = std::make_unique<State>();
    State& s = *state_;
    s.model = std::move(model);
    s.count = static_cast<std::int32_t>(s.model.gaussians.size());
    s.gaussians = GpuArray(s.model.gaussians, "Gaussians");
    s.model.gaussians = {};
    const auto n = static_cast<std::size_t>(s.count);
    s.splats = GpuArray<device::TileSplat>(n, "projected Gaussians");
    s.touched = GpuArray<std::uint32_t>(n, "counts of tiles");
    s.offsets = GpuArray<std::uint64_t>(n, "sums of tiles");
}

CudaSplat::~CudaSplat() = default;
CudaSplat::CudaSplat(CudaSplat&&) noexcept = default;
CudaSplat& CudaSplat::operator=(CudaSplat&&) noexcept = default;

double CudaSplat::gpu_ms() const { return state_->timer.ms(); }

void CudaSplat::State::bin(const device::Camera& camera, std::int32_t tile_columns,
                           std::int32_t tile_count, SortedEntries& entries) {
    launch_project(gaussians.data(), count, camera, model.kernel, splats.data(), touched.data());
    const std::size_t to_scan = scan_bytes(count);
    scratch.reserve(to_scan, "scratch of the sum");
    launch_scan(scratch.data(), to_scan, touched.data(), offsets.data(), count);

    // The number of entries to sort is read back between the two passes.
    std::uint64_t total = 0;
    check_cuda(
        cudaMemcpy(&total, offsets.data() + (count - 1), sizeof(total), cudaMemcpyDeviceToHost),
        "counting tiles");
    const auto entry_count = static_cast<std::int64_t>(total);
    tiles.reserve(2 * total, "entries of tiles");
    indices.reserve(2 * total, "entries of tiles");
    const int key_bits = std::max<int>(1, std::bit_width(static_cast<unsigned>(tile_count - 1)));
    entries = {tiles.data(), tiles.data() + total, indices.data(), indices.data() + total};
    if (total > 0) {
        const std::size_t to_sort = sort_bytes(entry_count, key_bits);
        scratch.reserve(to_sort, "scratch of the sort");
        launch_emit(splats.data(), offsets.data(), count, tile_columns, entries.tile,
                    entries.splat);
        launch_sort(scratch.data(), to_sort, entries, entry_count, key_bits);
    }
    launch_ranges(entries.tile, entry_count, tile_count, first.data());
}

DepthImage CudaSplat::render(const Camera& camera, int width, int height) {
    State& s = *state_;
    const device::Camera frame = scene_camera(frame_of(camera, width, height), s.model.unit);
    DepthImage image(width, height);
    if (s.count == 0) return image;
    const std::int32_t columns = (width + device::kSplatTile - 1) / device::kSplatTile;
    const std::int32_t rows = (height + device::kSplatTile - 1) / device::kSplatTile;
    s.first.reserve(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows) + 1,
                    "tiles");
    s.depth.reserve(image.depth.size(), "the picture");

    s.timer.start();
    SortedEntries entries{};
    s.bin(frame, columns, columns * rows, entries);
    launch_tiles({s.gaussians.data(), s.splats.data(), s.first.data(), entries.splat, frame,
                  s.model.kernel.kernel, columns, rows, s.depth.data()});
    s.timer.stop();
    s.depth.copy_to(image.depth.data(), image.depth.size(), "fetching the picture");
    return image;
}

}  // namespace vog
