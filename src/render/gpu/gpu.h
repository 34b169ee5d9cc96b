// gpu.h: T on an NVIDIA GPU: splatting by CUDA, ray tracing by OptiX.
// CudaSplat needs a CUDA device, OptixModel and OptixVolume (the paper's two pipelines) a driver
// with OptiX. All builds have these classes: without -DVOG_CUDA=ON or -DVOG_OPTIX=ON, a driver or a
// device, their constructors throw one line naming the missing part.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "render/gpu/sums/gpu_sums.h"
#include "render/trace/trace.h"
#include "vog/camera.h"
#include "vog/gaussians.h"
#include "vog/image.h"

namespace vog {

/// Splatting on the GPU: projection, binning by radix sort, one thread block a tile, no sorting by
/// depth.
class CudaSplat {
  public:
    /// Copies the model to the GPU.
    /// kappa   SplatOptions::kappa
    /// throws  vog::Error without a device, for a model validate() refuses, for too little memory
    explicit CudaSplat(const Gaussians& gaussians, double kappa = 0);
    ~CudaSplat();
    CudaSplat(CudaSplat&&) noexcept;
    CudaSplat& operator=(CudaSplat&&) noexcept;

    /// Optical depth T per pixel at extinction 1; the same bytes in every run.
    /// throws  vog::Error for an unusable camera or size, for too little GPU memory
    DepthImage render(const Camera& camera, int width, int height);
    /// The same, left in GPU memory: 1 channel.
    void render(const Camera& camera, const SumsSize& size, GpuSums& sums);
    /// Device time of the last picture, milliseconds by CUDA events, without the copy to the host.
    double gpu_ms() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// The paper's Gaussian renderer: custom primitives in a compacted geometry acceleration structure
/// under an instance acceleration structure, with any-hit programs that accumulate or collect.
class OptixModel {
  public:
    /// throws vog::Error without OptiX, as trace_scene does, and for too little GPU memory
    explicit OptixModel(const Gaussians& gaussians, const TraceSceneOptions& options = {});
    ~OptixModel();
    OptixModel(OptixModel&&) noexcept;
    OptixModel& operator=(OptixModel&&) noexcept;

    /// As render_trace. options.progress is not called.
    /// samples  ReferenceOptions::samples: T is the mean over samples x samples launches
    DepthImage render(const Camera& camera, int width, int height, const TraceOptions& options = {},
                      TraceReport* report = nullptr, int samples = 1);
    /// The same, left in GPU memory: 1 channel. Rays of a pixel are samples.
    void render(const Camera& camera, const SumsSize& size, GpuSums& sums,
                const TraceOptions& options = {});
    double gpu_ms() const;  ///< device time of the last picture, milliseconds by CUDA events

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// The paper's SciVis renderer: a NanoVDB grid, traversed by a hierarchical DDA in the closest-hit
/// program. Exact for voxels of constant value.
class OptixVolume {
  public:
    /// grid    a whole NanoVDB grid of floats (version 32) with its transform, uncompressed, in
    ///         memory aligned to 32 bytes; inactive voxels count as 0
    /// throws  vog::Error without OptiX, for another kind of grid, for too little GPU memory
    explicit OptixVolume(std::span<const std::byte> grid);
    ~OptixVolume();
    OptixVolume(OptixVolume&&) noexcept;
    OptixVolume& operator=(OptixVolume&&) noexcept;

    /// Optical depth T per pixel at extinction 1.
    /// samples  as of OptixModel::render
    DepthImage render(const Camera& camera, int width, int height, int samples = 1);
    double gpu_ms() const;  ///< as OptixModel::gpu_ms

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace vog
