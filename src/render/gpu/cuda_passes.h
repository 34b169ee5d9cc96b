// cuda_passes.h: Order and buffers of the passes of splatting on the GPU.
#pragma once

#include "render/gpu/chords/chord_kernels.h"
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
    /// Projects a model and lists its Gaussians by tile; fills the projection's pointers to them.
    void list(ChordProjection& projection);

  private:
    /// Entries of Gaussians by tile; behind those of the last tile the near ones.
    struct Lists {
        std::int32_t columns, rows;
        std::uint64_t entries, near;
        const std::uint32_t* splat;
    };
    /// Bins the projected splats to tiles.
    /// any_near  false: none is near
    Lists bin(const device::Camera& camera, bool any_near);
    /// Lists the projected splats and adds them up.
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
