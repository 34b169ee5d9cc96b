// optix_film.h: what OptiX pictures are exposed on: T, and the progressive sum of colours.
#pragma once

#include <vector>

#include "render/device/launch.h"
#include "render/gpu/cuda_memory.h"
#include "vog/gpu.h"

namespace vog::gpu {

class OptixFilm {
  public:
    /// For pictures of T alone.
    void load(int width, int height);
    /// For progressive pictures: also the colours, as a table over V.
    void load(int width, int height, const GpuShading& shading);

    device::Film film(std::uint32_t subframe) const;
    DepthImage depth() const;
    /// Mean colour over `subframes`.
    Image mean(int subframes) const;

  private:
    int width_ = 0, height_ = 0;
    bool progressive_ = false;
    device::ColorTable colors_{};
    GpuArray<float> depth_;
    GpuArray<device::Float4> accumulation_, table_;
};

}  // namespace vog::gpu
