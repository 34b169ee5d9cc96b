// sums_memory.h: Memory of gpu_sums.h.
#pragma once

#include "render/gpu/cuda_memory.h"
#include "render/gpu/sums/gpu_sums.h"
#include "render/gpu/sums/sums_kernels.h"

namespace vog {

struct GpuSums::State {
    int width = 0, height = 0, channels = 0;
    gpu::GpuArray<float> value;  ///< as large as the largest picture so far

    std::size_t floats() const {
        return static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
               static_cast<std::size_t>(channels);
    }
    /// Takes the size of a picture; contents are undefined then.
    /// returns  the pass that fills the sums, without its source and field
    gpu::SumsPass prepare(gpu::SumsKind kind, const SumsSize& size, int image_channels);
    /// Sets all sums to 0: a picture of nothing.
    void clear();
    /// Runs the pass, and waits for the default stream: other streams and threads may read then.
    static void finish(const gpu::SumsPass& pass);
};

namespace gpu {

/// Width or height of the picture that rays are drawn in.
/// throws  vog::Error for rays out of range
int lattice(const SumsSize& size, int SumsSize::*side);

}  // namespace gpu

}  // namespace vog
