// background_renderer.h: Draws pictures that take longer than a frame (all renderers but OpenGL) in a
// thread of their own, so that the window stays responsive.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "quantity/quantity.h"
#include "render/gpu/sums/gpu_sums.h"
#include "screen/screen.h"
#include "session/renderer_names.h"
#include "vog/camera.h"
#include "vog/gaussians.h"
#include "vog/lod.h"
#include "vog/progress.h"
#include "vog/voxel_field.h"

namespace vog::viewer {

/// Voxels with their fields.
struct VoxelData {
    vog::Scene whole;  ///< as it was read, for T
    vog::Scene parts;  ///< volumes that add up, or the parts of a mesh, with all fields
};

/// Everything sums depend on: pictures with equal keys are equal.
struct PictureKey {
    WindowRenderer renderer = WindowRenderer::gl;
    std::shared_ptr<const Gaussians> model;       ///< for all renderers but voxels
    std::shared_ptr<const Hierarchy> hierarchy;   ///< of the model; null: no levels of detail
    std::shared_ptr<const VoxelData> voxels;      ///< for the voxel renderer
    std::shared_ptr<const vog::Scene> layered{};  ///< in place of all these; null: no layers
    int layers = 0;                               ///< number of their latest change
    ResolvedPicture picture;                      ///< sums_of
    PixelSize size() const { return {picture.request.width, picture.request.height}; }
    friend bool operator==(const PictureKey& a, const PictureKey& b) {
        return a.renderer == b.renderer && a.model == b.model && a.hierarchy == b.hierarchy &&
               a.voxels == b.voxels && a.layered == b.layered && a.layers == b.layers &&
               same_sums(a.picture, b.picture);
    }
};

/// One picture to draw.
struct RenderRequest {
    std::uint64_t key = 0;  ///< identifies the picture: RenderedPicture::key
    PictureKey what;
    int rays = 1;  ///< rays^2 rays a pixel, on a square lattice; the picture is their mean
    bool stays_on_gpu = false;  ///< pictures of GPU renderers are left in GPU memory
};

struct RenderedPicture {
    std::uint64_t key = 0;
    int rays = 1;
    SumImage sums;
    double ms = 0;
    std::size_t drawn = 0;            ///< Gaussians; 0: unknown, of voxels
    std::string error;                ///< message, where the picture could not be drawn
    std::optional<GpuSums> on_gpu{};  ///< in place of `sums`, where that was requested
};

class BackgroundRenderer {
  public:
    BackgroundRenderer();
    ~BackgroundRenderer();
    BackgroundRenderer(const BackgroundRenderer&) = delete;
    BackgroundRenderer& operator=(const BackgroundRenderer&) = delete;

    /// Replaces a waiting request, and ends the one in progress if its key is another.
    void request(RenderRequest request);
    /// The latest finished picture, returned once.
    std::optional<RenderedPicture> take();
    /// Takes GPU memory back for a later picture. Nothing reads it any more.
    void give_back(GpuSums sums);
    bool busy();
    /// Finished fraction of the picture in progress, [0, 1].
    double fraction();

  private:
    void work();
    RenderedPicture render(const RenderRequest& request);
    void draw_on_host(const PictureKey& what, const Progress& progress, RenderedPicture& picture);
    void draw_on_gpu(const RenderRequest& request, RenderedPicture& picture);
    struct Prepared;
    std::unique_ptr<Prepared> prepared_;  ///< used by the thread alone

    std::mutex mutex_;  ///< guards the members below
    std::condition_variable wake_;
    std::optional<RenderRequest> waiting_;
    std::optional<RenderedPicture> ready_;
    std::vector<GpuSums> spare_;  ///< GPU memory for pictures: none that is ready or shown
    std::uint64_t running_key_ = 0;
    bool running_ = false, cancel_ = false, end_ = false;
    double fraction_ = 0;
    std::thread thread_;
};

}  // namespace vog::viewer
