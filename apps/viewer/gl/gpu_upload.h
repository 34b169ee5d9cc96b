// gpu_upload.h: Pictures of GPU renderers on their way to textures: through a buffer object that CUDA fills, where one GPU draws
// both, or through host memory.
#pragma once

#include <optional>
#include <string>

#include "gl/gl_objects.h"
#include "render/gpu/sums/gpu_sums.h"

namespace vog::viewer {

class GpuUpload {
  public:
    /// Of pictures that are copied even where they could be shared.
    static GpuUpload by_copies() {
        GpuUpload upload;
        upload.stays_on_gpu_ = false;
        return upload;
    }
    /// Whether pictures are to stay in GPU memory: asked of the current context once.
    bool stays_on_gpu();
    /// Fills the target, which has the size of the sums. A buffer that cannot be shared ends sharing; the picture is copied.
    /// returns  the reason in that case; empty: no failure
    /// throws   vog::Error where copying fails, too
    std::string fill(const GlTarget& target, const GpuSums& sums);

  private:
    void require_buffer(std::size_t bytes);

    std::optional<bool> stays_on_gpu_;
    std::size_t bytes_ = 0;  ///< of buffer_
    GlBuffer buffer_;
    std::optional<GlSumsBuffer> shared_;  ///< destroyed before buffer_
};

}  // namespace vog::viewer
