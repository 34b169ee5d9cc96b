// optix_film.h: Output buffers of OptiX pictures: T, and the sum of colours over subframes.
#pragma once

#include <vector>

#include "render/device/launch.h"
#include "render/gpu/cuda_memory.h"
#include "vog/gpu.h"

namespace vog::gpu {

class OptixFilm {
  public:
    /// Allocates the buffer of a picture of T alone.
    void load(int width, int height);
    /// T of one unit of a ray's depth, for later pictures; 1 unless set.
    void set_depth_unit(double unit) { depth_unit_ = unit; }
    /// Allocates the buffers of a progressive picture, with the colours as a table over V.
    void load(int width, int height, const GpuShading& shading);

    device::Film film(std::uint32_t subframe) const;
    DepthImage depth() const;
    /// Mean colour over `subframes`.
    Image mean(int subframes) const;

  private:
    int width_ = 0, height_ = 0;
    bool progressive_ = false;
    double depth_unit_ = 1;
    device::ColorTable colors_{};
    GpuArray<float> depth_;
    GpuArray<device::Float4> accumulation_, table_;
};

}  // namespace vog::gpu
