// cuda_passes.h: Order and buffers of the passes of splatting on the GPU.
#pragma once

#include "render/gpu/cuda_memory.h"
#include "render/gpu/cuda_splat.h"

namespace vog::gpu {

/// Buffers of the passes, kept from picture to picture.
class SplatPasses {
  public:
    SplatPasses() = default;
    /// count  Gaussians
    explicit SplatPasses(std::int32_t count);

    /// T of all Gaussians; `depth` is [height * width].
    void draw(const device::SplatGaussian* gaussians, const device::SplatKernel& kernel,
              const device::Camera& camera, float* depth);
    /// T of the Gaussians that rays leave out, and the shares of all: SmallGaussians.
    void draw_small(const device::Gaussian* gaussians, const device::SplatKernel& kernel,
                    const device::Camera& camera, float* shares, float* depth);

  private:
    /// Bins the projected splats to tiles and adds them up.
    /// gaussians  of which near splats are whitened; null where none is near
    void add_up(const device::SplatGaussian* gaussians, const device::SplatKernel& kernel,
                const device::Camera& camera, float* depth);

    std::int32_t count_ = 0;
    GpuArray<device::TileSplat> splats_;
    GpuArray<std::uint64_t> touched_, first_;
    GpuArray<std::uint32_t> near_count_;
    GpuArray<std::uint32_t> tiles_, indices_;  ///< two halves each, for the sort
    GpuArray<device::Gaussian> near_;
    GpuArray<std::byte> scratch_;
};

}  // namespace vog::gpu
