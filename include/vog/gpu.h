// vog/gpu.h: the same pictures on a GPU. CudaSplat is the tile renderer, for any CUDA device;
// OptixModel and OptixVolume are the paper's two OptiX pipelines, for those with a driver that has
// OptiX. Every build has these names: without -DVOG_CUDA=ON or -DVOG_OPTIX=ON, without a driver or
// without a device, their constructors throw one line that says what is missing.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "vog/camera.h"
#include "vog/gaussians.h"
#include "vog/image.h"
#include "vog/shade.h"
#include "vog/trace.h"

namespace vog {

/// Object order on the GPU: projection, binning by radix sort, one block a tile, no sort by depth.
class CudaSplat {
  public:
    /// Copies the model to the GPU.
    /// kappa   as in TraceSceneOptions
    /// throws  vog::Error without a device, for a model validate() refuses, for too little memory
    explicit CudaSplat(const Gaussians& gaussians, double kappa = 0);
    ~CudaSplat();
    CudaSplat(CudaSplat&&) noexcept;
    CudaSplat& operator=(CudaSplat&&) noexcept;

    /// T per pixel at extinction 1; the same bytes every time.
    /// throws  vog::Error for an unusable camera or size, for too little GPU memory
    DepthImage render(const Camera& camera, int width, int height);
    /// Device time of the last picture by CUDA events, without the copy to the host.
    double gpu_ms() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// What progressive pictures are shaded with: colours are summed over subframes, so it comes first.
struct GpuShading {
    TransferFunction tf;
    ShadeOptions options{};
    double extinction = 1;
};

/// The paper's Gaussian renderer: custom primitives, a compacted GAS under an IAS, any-hit
/// programs that accumulate or collect.
class OptixModel {
  public:
    /// throws vog::Error without OptiX, as trace_scene does, and for too little GPU memory
    explicit OptixModel(const Gaussians& gaussians, const TraceSceneOptions& options = {});
    ~OptixModel();
    OptixModel(OptixModel&&) noexcept;
    OptixModel& operator=(OptixModel&&) noexcept;

    /// As render_trace. options.progress is not called: a picture is one launch.
    DepthImage render(const Camera& camera, int width, int height, const TraceOptions& options = {},
                      TraceReport* report = nullptr);
    /// The mean colour of `subframes` launches, each through other points of its pixels.
    Image render_progressive(const Camera& camera, int width, int height, const GpuShading& shading,
                             int subframes, const TraceOptions& options = {});
    double gpu_ms() const;  ///< of the last picture's launches, by CUDA events

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// The paper's SciVis renderer: a NanoVDB grid, walked by hierarchical DDA in the closest-hit
/// program; exact for voxels of constant value.
class OptixVolume {
  public:
    /// grid    a whole NanoVDB grid of floats (version 32) with its transform, uncompressed, in
    ///         memory aligned to 32 bytes; inactive voxels count as 0
    /// throws  vog::Error without OptiX, for another kind of grid, for too little GPU memory
    explicit OptixVolume(std::span<const std::byte> grid);
    ~OptixVolume();
    OptixVolume(OptixVolume&&) noexcept;
    OptixVolume& operator=(OptixVolume&&) noexcept;

    /// T per pixel at extinction 1.
    DepthImage render(const Camera& camera, int width, int height);
    /// The mean colour of `subframes` launches, as of OptixModel.
    Image render_progressive(const Camera& camera, int width, int height, const GpuShading& shading,
                             int subframes);
    double gpu_ms() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace vog
