// optix_film.h: Output buffers of OptiX pictures.
#pragma once

#include "render/device/launch.h"
#include "render/gpu/cuda_memory.h"
#include "vog/image.h"

namespace vog::gpu {

/// throws  vog::Error for samples out of range: ReferenceOptions::samples
void check_samples(int samples);

/// T of a picture of one launch or of samples x samples, through the centres of equal parts of each pixel.
class OptixFilm {
  public:
    /// Allocates the buffers of a picture.
    void load(int width, int height, int samples);
    /// T of one unit of a ray's depth, for later pictures; 1 unless set.
    void set_depth_unit(double unit) { depth_unit_ = unit; }

    int launches() const { return samples_ * samples_; }
    /// Film of launch n.
    device::Film film(int n) const;
    DepthImage depth() const;
    const float* device_depth() const { return depth_.data(); }  ///< [height * width] in GPU memory

  private:
    int width_ = 0, height_ = 0, samples_ = 1;
    double depth_unit_ = 1;
    GpuArray<float> depth_;
    GpuArray<double> sum_;
};

}  // namespace vog::gpu
