// optix_volume.cpp: OptixVolume, the paper's SciVis renderer.
#include <fmt/core.h>
#include <nanovdb/NanoVDB.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "render/gpu/optix/optix_film.h"
#include "render/gpu/optix/optix_pipeline.h"
#include "vog/error.h"
#include "vog/gpu.h"

namespace vog {

using namespace gpu;

namespace {

device::Double3 plain(Vec3d v) { return {v.x, v.y, v.z}; }

const nanovdb::NanoGrid<float>& checked(std::span<const std::byte> bytes) {
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
    return grid;
}

Affine world_from_index(const nanovdb::NanoGrid<float>& grid) {
    const nanovdb::Map& map = grid.map();
    Affine out;
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) out.linear(r, c) = map.mMatD[3 * r + c];
        out.translation[r] = map.mVecD[r];
    }
    return out;
}

}  // namespace

struct OptixVolume::State {
    std::shared_ptr<OptixDevice> device = optix_device();
    OptixRayPipeline pipeline{device, kVoxelEntryPoints};
    GpuArray<std::byte> grid;
    std::unique_ptr<OptixHierarchy> hierarchy;
    Affine index_from_world;
    device::Bounds bounds{};  ///< world box of the active voxels, in scene units
    device::Double3 center{};
    double unit = 1;
    OptixFilm film;
    GpuTimer timer;

    device::Launch launch_for(const CameraFrame& frame) const;
};

OptixVolume::OptixVolume(std::span<const std::byte> grid) {
    const nanovdb::NanoGrid<float>& nano = checked(grid);
    state_ = std::make_unique<State>();
    State& s = *state_;
    const Affine to_world = world_from_index(nano);
    s.index_from_world = inverse(to_world);
    if (nano.indexBBox().empty()) return;
    s.grid = GpuArray<std::byte>(grid.size(), "voxels");
    check_cuda(cudaMemcpy(s.grid.data(), grid.data(), grid.size(), cudaMemcpyHostToDevice),
               "sending voxels");

    // World box of the active voxels; voxel i fills [i - 1/2, i + 1/2].
    const auto& lower = nano.indexBBox().min();
    const auto& upper = nano.indexBBox().max();
    const Box box = transformed(to_world, {{lower[0] - 0.5, lower[1] - 0.5, lower[2] - 0.5},
                                           {upper[0] + 0.5, upper[1] + 0.5, upper[2] + 0.5}});
    s.unit = std::ldexp(1.0, std::ilogb(box.radius()) + 1);
    const double per_unit = 1 / s.unit;
    s.bounds = {plain(per_unit * box.lower), plain(per_unit * box.upper)};
    s.center = plain(per_unit * box.center());
    FloatBox around;
    for (int axis = 0; axis < 3; ++axis) {
        const double half = 0.5 * per_unit * (box.upper[axis] - box.lower[axis]) + 4 * kBoxSlack;
        around.lower[axis] = static_cast<float>(-half);
        around.upper[axis] = static_cast<float>(half);
    }
    s.hierarchy = std::make_unique<OptixHierarchy>(s.device, std::vector<FloatBox>{around});
}

OptixVolume::~OptixVolume() = default;
OptixVolume::OptixVolume(OptixVolume&&) noexcept = default;
OptixVolume& OptixVolume::operator=(OptixVolume&&) noexcept = default;

double OptixVolume::gpu_ms() const { return state_->timer.ms(); }

device::Launch OptixVolume::State::launch_for(const CameraFrame& frame) const {
    device::Launch launch{};
    launch.traversable = hierarchy->handle();
    launch.camera = scene_camera(frame, unit);
    launch.bounds = bounds;
    launch.center = center;
    launch.grid = grid.data();
    // A pixel has the same t in index space, for any transform.
    const Mat3& linear = index_from_world.linear;
    launch.index_camera = {plain(index_from_world(frame.first_origin) + Vec3d{0.5, 0.5, 0.5}),
                           plain(linear * frame.shift_x),
                           plain(linear * frame.shift_y),
                           plain(linear * frame.corner),
                           plain(linear * frame.step_x),
                           plain(linear * frame.step_y),
                           frame.width,
                           frame.height,
                           frame.orthographic ? 1 : 0};
    return launch;
}

DepthImage OptixVolume::render(const Camera& camera, int width, int height, int samples) {
    State& s = *state_;
    const CameraFrame frame = frame_of(camera, width, height);
    check_samples(samples);
    if (!s.hierarchy) return DepthImage(width, height);
    s.film.load(width, height, samples);
    device::Launch launch = s.launch_for(frame);
    s.timer.start();
    for (int n = 0; n < s.film.launches(); ++n) {
        launch.film = s.film.film(n);
        s.pipeline.run(launch);
    }
    s.timer.stop();
    return s.film.depth();
}

}  // namespace vog
