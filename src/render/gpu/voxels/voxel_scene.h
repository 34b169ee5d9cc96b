// voxel_scene.h: Volumes in GPU memory and OptiX's rays through them. No OptiX headers here.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "render/device/voxels/voxel_picture.h"
#include "vog/camera.h"
#include "vog/clip.h"

namespace vog::gpu {

/// A volume with a field, each a whole NanoVDB grid of floats.
struct VoxelGridBytes {
    std::span<const std::byte> density;
    std::vector<std::span<const std::byte>>
        component{};        ///< of the field, with the nodes of `density`
    double background = 0;  ///< VoxelVolume::background
};

/// Part of a field that rays add up.
struct ShownVoxels {
    device::VoxelKind kind = device::VoxelKind::sums;
    bool field = false;             ///< the volumes' fields; false: their densities
    int component = 0;              ///< of vector fields
    bool along_rays = false;        ///< all components of vector fields, along each ray
    device::ValueTable transfer{};  ///< of light: host memory
    std::size_t pieces = 0;         ///< of the table
    device::BlinnPhong look{};
};

/// Volumes whose rays start at the box around all of them.
class VoxelScene {
  public:
    /// throws  vog::Error without OptiX
    VoxelScene();
    ~VoxelScene();
    VoxelScene(VoxelScene&&) noexcept;
    VoxelScene& operator=(VoxelScene&&) noexcept;

    /// Copies a volume to the GPU; one without active voxels is left out.
    /// throws  vog::Error for too little GPU memory
    void add(const VoxelGridBytes& volume);
    /// Number of volumes with active voxels.
    std::size_t size() const;

    /// Sums of VoxelPicture::out.
    /// samples  rays a pixel, a side
    /// returns  [height * width][4]; all 0 of a scene without volumes
    std::vector<double> draw(const ShownVoxels& shown, const CameraFrame& frame, int samples,
                             const Clipping& clip);
    double gpu_ms() const;  ///< of the last picture

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace vog::gpu
