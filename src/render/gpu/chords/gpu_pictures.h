// gpu_pictures.h: Pictures of fields, of values and of clipped models on an NVIDIA GPU, by the formulas of the splats.
#pragma once

#include <memory>
#include <string>

#include "render/gpu/sums/gpu_sums.h"
#include "render/trace/trace.h"
#include "vog/field_maps.h"
#include "vog/volume_picture.h"

namespace vog {

/// Renderer of one model's fields on a GPU, from any number of cameras. Renderer::cuda adds up the Gaussians of each tile,
/// Renderer::optix those on each ray; either intersects rays with Gaussians, exactly, in single precision.
/// A Gaussian drawn wider than it is (docs/method.md, "Gaussians smaller than a pixel") has its mean value and whole variance, and
/// a clip cuts the chord that is drawn.
class GpuPictures {
  public:
    /// renderer   cuda or optix
    /// gaussians  must outlive the renderer, unchanged; copied to the GPU
    /// options    boxes (aabb_sigma): of optix, as render_volume_trace and render_field_trace have them
    /// throws     vog::Error for another renderer, without a device or in a build without it, as trace_scene does, for too
    ///            little GPU memory
    GpuPictures(Renderer renderer, const Gaussians& gaussians,
                const TraceSceneOptions& options = {});
    ~GpuPictures();
    GpuPictures(GpuPictures&&) noexcept;
    GpuPictures& operator=(GpuPictures&&) noexcept;

    /// T at extinction 1 of what the clip leaves.
    /// throws  vog::Error for an unusable camera, size or clip, for too little GPU memory; so do all pictures
    DepthImage depth(const Camera& camera, int width, int height, const Clipping& clip = {});
    /// As render_field_splat without a hierarchy.
    /// throws  vog::Error for a field that the model lacks, too
    FieldMaps fields(const FieldChoice& choice, const Camera& camera, int width, int height,
                     const Clipping& clip = {});
    /// As SlabRenderer: the same slabs, to rounding. The light of one field and transfer function is kept.
    /// slabs   1 to 1024
    /// memory  for the pixels
    /// throws  vog::Error as SlabRenderer does
    VolumeImage volume(const std::string& field, const ValueTransfer& transfer,
                       const Camera& camera, int width, int height, int slabs = 32,
                       const VolumeLook& look = {}, std::vector<Rgba> memory = {});
    /// As render_maximum_splat.
    /// throws  vog::Error as it does
    ValueMap maximum(const std::string& field, const Camera& camera, int width, int height,
                     int slabs = kMaximumSlabs, const Clipping& clip = {});

    // The same pictures, left in GPU memory: 4 channels.
    void depth(const Camera& camera, const SumsSize& size, GpuSums& sums,
               const Clipping& clip = {});
    void fields(const FieldChoice& choice, const SumsUnit& unit, const Camera& camera,
                const SumsSize& size, GpuSums& sums, const Clipping& clip = {});
    void volume(const std::string& field, const ValueTransfer& transfer, const Camera& camera,
                const SumsSize& size, GpuSums& sums, int slabs = 32, const VolumeLook& look = {});
    void maximum(const std::string& field, const SumsUnit& unit, const Camera& camera,
                 const SumsSize& size, GpuSums& sums, int slabs = kMaximumSlabs,
                 const Clipping& clip = {});

    double gpu_ms() const;  ///< device time of the last picture, milliseconds by CUDA events

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace vog
