// optix_volume.cpp: OptixVolume, the paper's SciVis renderer.
#include <fmt/core.h>
#include <nanovdb/NanoVDB.h>

#include <cstdint>

#include "render/gpu/gpu.h"
#include "render/gpu/optix/optix_film.h"
#include "render/gpu/voxels/voxel_scene.h"
#include "vog/error.h"

namespace vog {

using namespace gpu;

namespace {

/// throws  vog::Error unless the bytes are a NanoVDB grid of floats
void check(std::span<const std::byte> bytes) {
    using Grid = nanovdb::NanoGrid<float>;
    const auto fail = [](const std::string& what) {
        throw Error("optix: expected a NanoVDB grid of floats: " + what);
    };
    if (bytes.size() < sizeof(Grid))
        fail(fmt::format("{} bytes, expected {} or more", bytes.size(), sizeof(Grid)));
    if (reinterpret_cast<std::uintptr_t>(bytes.data()) % NANOVDB_DATA_ALIGNMENT != 0)
        fail("its memory is not aligned to 32 bytes");
    const Grid& grid = *reinterpret_cast<const Grid*>(bytes.data());
    if (!grid.isValid()) fail("it does not begin as one");
    if (grid.gridType() != nanovdb::GridType::Float) fail("its values are of another type");
    if (grid.gridSize() > bytes.size())
        fail(fmt::format("truncated, {} of {} bytes", bytes.size(), grid.gridSize()));
}

}  // namespace

struct OptixVolume::State {
    VoxelScene scene;
};

OptixVolume::OptixVolume(std::span<const std::byte> grid) {
    check(grid);
    state_ = std::make_unique<State>();
    state_->scene.add({grid});
}

OptixVolume::~OptixVolume() = default;
OptixVolume::OptixVolume(OptixVolume&&) noexcept = default;
OptixVolume& OptixVolume::operator=(OptixVolume&&) noexcept = default;

double OptixVolume::gpu_ms() const { return state_->scene.gpu_ms(); }

DepthImage OptixVolume::render(const Camera& camera, int width, int height, int samples) {
    const CameraFrame frame = frame_of(camera, width, height);
    check_samples(samples);
    const std::vector<double> sums = state_->scene.draw({}, frame, samples, {});
    DepthImage image(width, height);
    for (std::size_t n = 0; n < image.depth.size(); ++n)
        image.depth[n] = static_cast<float>(sums[4 * n] / (samples * samples));
    return image;
}

}  // namespace vog
