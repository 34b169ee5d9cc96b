// sums_kernels.cu: The kernel of pictures that stay in GPU memory, one thread a pixel.
#include <cuda_runtime.h>

#include "render/gpu/kernel_start.h"
#include "render/gpu/sums/sums_kernels.h"

namespace vog::gpu {

namespace {

/// Adds the sums of one ray.
__device__ void add_ray(const SumsPass& p, std::int64_t column, std::int64_t row, double* sums) {
    const std::int64_t width = std::int64_t{p.width} * p.rays;
    const std::int64_t pixels = width * p.height * p.rays, n = row * width + column;
    double weight = 1, value = 0, deviation = 0;
    switch (p.kind) {
        case SumsKind::depth:
            sums[0] += static_cast<double>(p.from[n]);
            return;
        case SumsKind::colors:
            for (int c = 0; c < 4; ++c) sums[c] += static_cast<double>(p.from[4 * n + c]);
            return;
        case SumsKind::maximum:
            if (!(p.from[4 * n] >= 0)) return;
            value = p.offset + p.scale * static_cast<double>(p.from[4 * n]);
            break;
        case SumsKind::field:
            if (!(p.from[n] > 0)) return;
            const device::Double3 along = p.camera.corner +
                                          static_cast<double>(column) * p.camera.step_x +
                                          static_cast<double>(row) * p.camera.step_y;
            weight = static_cast<double>(p.from[n]);
            value = p.offset + p.scale * static_cast<double>(p.from[pixels + n]) +
                    device::dot(p.reference, along) / sqrt(device::dot(along, along));
            deviation = p.scale * static_cast<double>(p.from[2 * pixels + n]);
    }
    sums[0] += weight;
    if (!p.magnitude) sums[1] += weight * value;
    sums[2] += weight * (value * value + deviation * deviation);
}

__global__ void sums_kernel(SumsPass p) {
    const std::int64_t n = thread_index();
    if (n >= std::int64_t{p.width} * p.height) return;
    double sums[4] = {0, 0, 0, 0};
    for (int y = 0; y < p.rays; ++y)
        for (int x = 0; x < p.rays; ++x)
            add_ray(p, n % p.width * p.rays + x, n / p.width * p.rays + y, sums);
    const double share = 1 / (static_cast<double>(p.rays) * p.rays);
    float* to = p.to + n * p.channels;
    if (p.more) {
        to[2] += static_cast<float>(share * sums[2]);
        return;
    }
    for (int c = 0; c < p.channels; ++c) to[c] = static_cast<float>(share * sums[c]);
}

}  // namespace

void launch_sums(const SumsPass& pass) {
    start("summing rays", sums_kernel, std::int64_t{pass.width} * pass.height, pass);
}

}  // namespace vog::gpu
