// voxel_scene.cpp: VoxelScene: uploads, the box of the hierarchy, launch parameters.
#include "render/gpu/voxels/voxel_scene.h"

#include <nanovdb/NanoVDB.h>

#include <array>
#include <cmath>
#include <cstdint>

#include "render/gpu/half_spaces.h"
#include "render/gpu/optix/optix_pipeline.h"

namespace vog::gpu {

namespace {

using Grid = nanovdb::NanoGrid<float>;

Affine world_from_index(const Grid& grid) {
    const nanovdb::Map& map = grid.map();
    Affine out;
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) out.linear(r, c) = map.mMatD[3 * r + c];
        out.translation[r] = map.mVecD[r];
    }
    return out;
}

/// A volume in GPU memory.
struct Uploaded {
    GpuArray<std::byte> density;
    std::vector<GpuArray<std::byte>> component;
    device::VoxelVolume volume{};  ///< without its grids
};

GpuArray<std::byte> sent(std::span<const std::byte> bytes, const char* what) {
    GpuArray<std::byte> array(bytes.size(), what);
    check_cuda(cudaMemcpy(array.data(), bytes.data(), bytes.size(), cudaMemcpyHostToDevice),
               "sending voxels");
    return array;
}

}  // namespace

struct VoxelScene::State {
    std::shared_ptr<OptixDevice> device = optix_device();
    OptixRayPipeline pipeline{device, kVoxelEntryPoints};
    std::vector<Uploaded> volumes;
    Box box;  ///< world box of the active voxels

    // Of the box, made when first drawn.
    std::unique_ptr<OptixHierarchy> hierarchy;
    double unit = 1;
    device::Bounds bounds{};  ///< in scene units
    device::Double3 center{};

    GpuArray<device::VoxelVolume> shown;
    GpuArray<device::HalfSpace> planes;
    GpuArray<device::ValuePiece> pieces;
    GpuArray<std::uint32_t> buckets;
    GpuArray<double> out;
    GpuTimer timer;

    void enclose();
    void choose(const ShownVoxels& which, device::VoxelPicture& picture);
};

VoxelScene::VoxelScene() : state_(std::make_unique<State>()) {}
VoxelScene::~VoxelScene() = default;
VoxelScene::VoxelScene(VoxelScene&&) noexcept = default;
VoxelScene& VoxelScene::operator=(VoxelScene&&) noexcept = default;

std::size_t VoxelScene::size() const { return state_->volumes.size(); }
double VoxelScene::gpu_ms() const { return state_->timer.ms(); }

void VoxelScene::add(const VoxelGridBytes& volume) {
    State& s = *state_;
    const Grid& grid = *reinterpret_cast<const Grid*>(volume.density.data());
    if (grid.indexBBox().empty()) return;
    Uploaded added;
    added.density = sent(volume.density, "voxels");
    for (const std::span<const std::byte> bytes : volume.component)
        added.component.push_back(sent(bytes, "the field at voxels"));

    const Affine to_world = world_from_index(grid);
    const Mat3 to_index = inverse(to_world.linear);
    const auto& lower = grid.indexBBox().min();
    const auto& upper = grid.indexBBox().max();
    const Vec3d corner{double(lower[0]), double(lower[1]), double(lower[2])};
    for (int r = 0; r < 3; ++r) added.volume.row[r] = plain(to_index.row[r]);
    added.volume.background = volume.background;
    added.volume.corner = plain(to_world(corner));
    added.volume.corner_in_grid = plain(corner + Vec3d{0.5, 0.5, 0.5});
    // Voxel i fills [i - 1/2, i + 1/2].
    s.box.include(transformed(to_world, {corner - Vec3d{0.5, 0.5, 0.5},
                                         {upper[0] + 0.5, upper[1] + 0.5, upper[2] + 0.5}}));
    s.volumes.push_back(std::move(added));
    s.hierarchy.reset();
}

/// Builds the hierarchy: one box around all volumes.
void VoxelScene::State::enclose() {
    if (hierarchy) return;
    unit = std::ldexp(1.0, std::ilogb(box.radius()) + 1);
    const double per_unit = 1 / unit;
    bounds = {plain(per_unit * box.lower), plain(per_unit * box.upper)};
    center = plain(per_unit * box.center());
    FloatBox around;
    for (int axis = 0; axis < 3; ++axis) {
        const double half = 0.5 * per_unit * (box.upper[axis] - box.lower[axis]) + 4 * kBoxSlack;
        around.lower[axis] = static_cast<float>(-half);
        around.upper[axis] = static_cast<float>(half);
    }
    hierarchy = std::make_unique<OptixHierarchy>(device, std::vector<FloatBox>{around});
}

/// Sets the volumes and the light of a picture.
void VoxelScene::State::choose(const ShownVoxels& which, device::VoxelPicture& picture) {
    std::vector<device::VoxelVolume> all;
    for (const Uploaded& from : volumes) {
        device::VoxelVolume& volume = all.emplace_back(from.volume);
        volume.density = from.density.data();
        if (!which.field || from.component.empty()) continue;
        for (std::size_t n = 0; n < (which.along_rays ? 3 : 1); ++n)
            volume.component[n] =
                from.component[n + static_cast<std::size_t>(which.component)].data();
    }
    shown.reserve(all.size(), "volumes");
    shown.copy_from(all, "sending volumes");
    picture.kind = which.kind;
    picture.count = static_cast<std::int32_t>(all.size());
    picture.volume = shown.data();
    picture.along_rays = which.along_rays ? 1 : 0;
    picture.look = which.look;
    picture.transfer = which.transfer;
    if (which.pieces == 0) return;
    const device::ValuePiece* piece = which.transfer.piece;
    const std::uint32_t* first = which.transfer.first;
    pieces.reserve(which.pieces, "the transfer function");
    pieces.copy_from({piece, piece + which.pieces}, "sending the transfer function");
    buckets.reserve(device::kValueBuckets, "the transfer function");
    buckets.copy_from({first, first + device::kValueBuckets}, "sending the transfer function");
    picture.transfer.piece = pieces.data();
    picture.transfer.first = buckets.data();
}

std::vector<double> VoxelScene::draw(const ShownVoxels& which, const CameraFrame& frame,
                                     int samples, const Clipping& clip) {
    State& s = *state_;
    std::vector<double> sums(4 * static_cast<std::size_t>(frame.width) *
                             static_cast<std::size_t>(frame.height));
    if (s.volumes.empty()) return sums;
    s.enclose();
    device::Launch launch{};
    launch.traversable = s.hierarchy->handle();
    launch.camera = scene_camera(frame, s.unit);
    launch.bounds = s.bounds;
    launch.center = s.center;
    s.choose(which, launch.voxels);
    launch.voxels.camera = scene_camera(frame, 1);
    launch.voxels.samples = samples;
    const std::vector<device::HalfSpace> cut = half_spaces(clip, 1);
    s.planes.reserve(cut.size(), "planes of the clip");
    if (!cut.empty()) s.planes.copy_from(cut, "planes of the clip");
    launch.voxels.planes = s.planes.data();
    launch.voxels.plane_count = static_cast<std::int32_t>(cut.size());
    s.out.reserve(sums.size(), "the picture");
    launch.voxels.out = s.out.data();
    s.timer.start();
    s.pipeline.run(launch);
    s.timer.stop();
    s.out.copy_to(sums.data(), sums.size(), "fetching the picture");
    return sums;
}

}  // namespace vog::gpu
