// background_renderer.h: pictures that take longer than a frame: splat, rays, their GPU twins and the
// voxels, in a thread of their own, so that the window stays alive.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "session/renderer_names.h"
#include "session/voxels.h"
#include "vog/camera.h"
#include "vog/gaussians.h"
#include "vog/image.h"
#include "vog/lod.h"
#include "vog/progress.h"

namespace vog::viewer {

/// Either a model or voxels.
struct RenderRequest {
    std::uint64_t key = 0;  ///< the asker's name for it
    Renderer renderer = Renderer::splat;
    std::shared_ptr<const Gaussians> model;
    std::shared_ptr<const Hierarchy> hierarchy;  ///< of the model; what splat draws a cut through
    double pixel_error = 0;                      ///< of the cut
    std::shared_ptr<const Voxels> voxels;
    Camera camera;
    int width = 0, height = 0;
    int rays = 1;  ///< of a pixel, along each side: their mean is what is asked for
};

struct RenderedPicture {
    std::uint64_t key = 0;
    int rays = 1;
    DepthImage depth;
    double ms = 0;
    std::size_t drawn = 0;  ///< Gaussians; 0: not known
    std::string error;      ///< why there is none
};

class BackgroundRenderer {
  public:
    BackgroundRenderer();
    ~BackgroundRenderer();
    BackgroundRenderer(const BackgroundRenderer&) = delete;
    BackgroundRenderer& operator=(const BackgroundRenderer&) = delete;

    /// Takes the place of any request before it; one with another key is ended.
    void ask(RenderRequest request);
    /// The latest picture that is ready, once.
    std::optional<RenderedPicture> take();
    bool busy();
    /// Finished share of what is under way.
    double fraction();

  private:
    void work();
    RenderedPicture render(const RenderRequest& request);
    void draw_model(const RenderRequest& request, int width, int height, const Progress& progress,
                    RenderedPicture& picture);
    struct Prepared;
    std::unique_ptr<Prepared> prepared_;  ///< the thread's own: what the latest model needs

    std::mutex mutex_;  ///< guards what follows
    std::condition_variable wake_;
    std::optional<RenderRequest> waiting_;
    std::optional<RenderedPicture> ready_;
    std::uint64_t running_key_ = 0;
    bool running_ = false, cancel_ = false, end_ = false;
    double fraction_ = 0;
    std::thread thread_;
};

/// Means of squares of factor x factor pixels.
DepthImage shrunk(const DepthImage& image, int factor);

}  // namespace vog::viewer
