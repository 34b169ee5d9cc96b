// sums_kernels.h: The last pass of pictures that stay in GPU memory: means over rays, in the layout of gpu_sums.h. The kernel
// is compiled by nvcc (sums_kernels.cu); this interface has plain pointers only.
#pragma once

#include <cstdint>

#include "render/device/camera_ray.h"

namespace vog::gpu {

enum class SumsKind : std::int32_t { depth, field, colors, maximum };

/// Arguments of the pass. A picture has rays * width x rays * height numbers of each kind.
struct SumsPass {
    SumsKind kind;
    const float*
        from;  ///< T; of field column, mean and deviation, one image each; of others 4 numbers a pixel
    float* to;  ///< [height][width][channels]
    std::int32_t width, height, channels, rays;

    // Numbers of a field or maximum: offset + scale * number, of field plus the reference along the ray.
    double offset, scale;
    device::Double3 reference;  ///< in the unit of sums; of scalar fields within the offset
    device::Camera camera;      ///< of the rays
    std::int32_t magnitude;     ///< 1: a component, of which the square counts alone
    std::int32_t more;          ///< 1: adds the square to those of other components
};
void launch_sums(const SumsPass& pass);

}  // namespace vog::gpu
