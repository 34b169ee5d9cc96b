// depth_renderer.cpp: DepthRenderer: one class for each renderer and the data it holds.
#include "render/by_value/clipped_depth.h"
#include "render/gpu/chords/gpu_pictures.h"
#include "render/gpu/gpu.h"
#include "render/gpu/voxels/gpu_volumes.h"
#include "render/pixel_limits.h"
#include "render/splat/splat.h"
#include "vog/error.h"
#include "vog/renderer.h"

namespace vog {

struct DepthRenderer::State {
    Renderer renderer{};
    std::optional<CutReport> cut{};
    std::optional<TraceReport> traced{};
    std::optional<double> gpu_ms{};

    virtual ~State() = default;
    virtual void render(const Camera& camera, int width, int height, DepthImage& depth,
                        const Progress& progress) = 0;
    virtual void set_pixel_error(double) {}
    virtual void set_samples(int) {}
};

namespace {

using State = DepthRenderer::State;

class SplatState : public State {
  public:
    SplatState(std::shared_ptr<const Gaussians> model, std::shared_ptr<const Hierarchy> hierarchy,
               const RenderOptions& options)
        : model_(std::move(model)),
          hierarchy_(std::move(hierarchy)),
          splat_(*model_, splat_options(options)) {}

    void render(const Camera& camera, int width, int height, DepthImage& depth,
                const Progress& progress) override {
        splat_.render(camera, width, height, depth, progress);
        if (has_cut_) cut = splat_.cut_report();
    }
    void set_pixel_error(double pixel_error) override { splat_.set_cut({pixel_error, true}); }

  private:
    SplatOptions splat_options(const RenderOptions& options) {
        SplatOptions splat;
        splat.aabb_sigma = options.aabb_sigma;
        splat.kappa = options.kappa;
        has_cut_ = hierarchy_ && !hierarchy_->empty() && options.aabb_sigma == 0;
        if (has_cut_) splat.hierarchy = hierarchy_.get();
        splat.cut.pixel_error = options.pixel_error.value_or(splat.cut.pixel_error);
        return splat;
    }

    std::shared_ptr<const Gaussians> model_;
    std::shared_ptr<const Hierarchy> hierarchy_;
    bool has_cut_ = false;
    SplatRenderer splat_;
};

class TraceState : public State {
  public:
    TraceState(const Gaussians& model, const RenderOptions& options)
        : scene_(trace_scene(model, {options.aabb_sigma, options.kappa})),
          options_(options.trace) {}

    void render(const Camera& camera, int width, int height, DepthImage& depth,
                const Progress& progress) override {
        options_.progress = progress;
        depth = render_trace(scene_, camera, width, height, options_, &traced.emplace());
    }

  private:
    TraceScene scene_;
    TraceOptions options_;
};

/// Clipped chords: of all Gaussians, without a hierarchy, boxes or an end of rays.
class ClippedState : public State {
  public:
    /// throws vog::Error for options that clipped pictures do not have
    ClippedState(Renderer by, std::shared_ptr<const Gaussians> model, const RenderOptions& options)
        : by_(by), model_(std::move(model)), options_(options) {
        const auto refuse = [](const char* what) {
            throw Error(std::string("a clip of Gaussians with ") + what + ", expected one of them");
        };
        validate(options.clip);
        if (options.aabb_sigma != 0) refuse("bounding boxes");
        if (options.pixel_error) refuse("a largest error of nodes");
        if (options.trace.stop_transmittance > 0) refuse("an end of rays by transmittance");
        if (options.trace.anyhit == AnyHit::collect) refuse("collected hits");
        if (options.samples != 1) refuse("several rays a pixel");
        if (by == Renderer::cuda || by == Renderer::optix)
            pictures_.emplace(by, *model_, TraceSceneOptions{0, options.kappa});
    }

    void render(const Camera& camera, int width, int height, DepthImage& depth,
                const Progress& progress) override {
        if (pictures_) {
            depth = pictures_->depth(camera, width, height, options_.clip);
            gpu_ms = pictures_->gpu_ms();
            return;
        }
        TraceOptions trace;
        trace.progress = progress;
        depth = by_ == Renderer::trace
                    ? by_value::clipped_depth_trace(*model_, options_.clip, options_.kappa, camera,
                                                    width, height, trace)
                    : by_value::clipped_depth_splat(*model_, options_.clip, options_.kappa, camera,
                                                    width, height);
    }

  private:
    Renderer by_;
    std::shared_ptr<const Gaussians> model_;
    RenderOptions options_;
    std::optional<GpuPictures> pictures_{};
};

class CudaState : public State {
  public:
    CudaState(const Gaussians& model, const RenderOptions& options)
        : splat_(model, options.kappa) {}

    void render(const Camera& camera, int width, int height, DepthImage& depth,
                const Progress&) override {
        depth = splat_.render(camera, width, height);
        gpu_ms = splat_.gpu_ms();
    }

  private:
    CudaSplat splat_;
};

class OptixModelState : public State {
  public:
    OptixModelState(const Gaussians& model, const RenderOptions& options)
        : model_(model, {options.aabb_sigma, options.kappa}),
          options_(options.trace),
          samples_(options.samples) {}

    void render(const Camera& camera, int width, int height, DepthImage& depth,
                const Progress&) override {
        depth = model_.render(camera, width, height, options_, &traced.emplace(), samples_);
        gpu_ms = model_.gpu_ms();
    }
    void set_samples(int samples) override { samples_ = samples; }

  private:
    OptixModel model_;
    TraceOptions options_;
    int samples_;
};

/// The Gaussians of a cut through a hierarchy, sent to the GPU for each picture.
class GpuCutState : public State {
  public:
    GpuCutState(Renderer by, std::shared_ptr<const Gaussians> model,
                std::shared_ptr<const Hierarchy> hierarchy, const RenderOptions& options)
        : by_(by),
          model_(std::move(model)),
          hierarchy_(std::move(hierarchy)),
          options_(options),
          cut_(*model_, *hierarchy_, cutoff_of_kappa(options.kappa, model_->cutoff)) {}

    void render(const Camera& camera, int width, int height, DepthImage& depth,
                const Progress& progress) override {
        const Gaussians& drawn =
            cut_.choose(frame_of(camera, width, height), {*options_.pixel_error, true});
        cut = cut_.report();
        if (by_ == Renderer::cuda)
            draw(CudaState(drawn, options_), camera, width, height, depth, progress);
        else
            draw(OptixModelState(drawn, options_), camera, width, height, depth, progress);
    }
    void set_pixel_error(double pixel_error) override { options_.pixel_error = pixel_error; }
    void set_samples(int samples) override { options_.samples = samples; }

  private:
    void draw(State&& by, const Camera& camera, int width, int height, DepthImage& depth,
              const Progress& progress) {
        by.render(camera, width, height, depth, progress);
        traced = by.traced;
        gpu_ms = by.gpu_ms;
    }

    Renderer by_;
    std::shared_ptr<const Gaussians> model_;
    std::shared_ptr<const Hierarchy> hierarchy_;
    RenderOptions options_;
    ViewCut cut_;
};

std::vector<VoxelGrid> voxel_grids(std::span<const Volume> volumes,
                                   const VoxelGridOptions& options) {
    std::vector<VoxelGrid> grids;
    for (const Volume& volume : volumes) grids.push_back(voxel_grid(volume, options));
    return grids;
}

class OptixVolumesState : public State {
  public:
    /// volumes  or levels
    template <class Voxels>
    OptixVolumesState(const Voxels& volumes, const RenderOptions& options)
        : volumes_(volumes), options_{{}, options.samples, options.clip} {}

    void render(const Camera& camera, int width, int height, DepthImage& depth,
                const Progress&) override {
        depth = volumes_.depth(camera, width, height, options_);
        gpu_ms = volumes_.gpu_ms();
    }
    void set_samples(int samples) override { options_.samples = samples; }

  private:
    GpuVolumes volumes_;
    ReferenceOptions options_;
};

/// Grids  LevelGrids or std::vector<VoxelGrid>
template <class Grids>
class ReferenceState : public State {
  public:
    ReferenceState(Grids grids, const RenderOptions& options)
        : grids_(std::move(grids)), options_{{}, options.samples, options.clip} {}

    void render(const Camera& camera, int width, int height, DepthImage& depth,
                const Progress& progress) override {
        ReferenceOptions options = options_;
        options.progress = progress;
        depth = render_reference(grids_, camera, width, height, options);
    }
    void set_samples(int samples) override { options_.samples = samples; }

  private:
    Grids grids_;
    ReferenceOptions options_;
};

/// throws vog::Error for a renderer that does not draw the input, or options that are not its
void check(Renderer renderer, RenderInput input, const RenderOptions& options) {
    (void)renderer_for(info_of(renderer).name, input);
    require_options(renderer, input, changed_options(options), OptionSpelling::arguments);
}

}  // namespace

DepthRenderer::DepthRenderer(Renderer renderer, std::shared_ptr<const Gaussians> model,
                             const RenderOptions& options,
                             std::shared_ptr<const Hierarchy> hierarchy) {
    check(renderer, RenderInput::gaussians, options);
    if (!options.clip.empty()) {
        state_ = std::make_unique<ClippedState>(renderer, std::move(model), options);
        state_->renderer = renderer;
        return;
    }
    const bool on_gpu = renderer == Renderer::cuda || renderer == Renderer::optix;
    if (on_gpu && options.pixel_error && hierarchy && !hierarchy->empty()) {
        state_ = std::make_unique<GpuCutState>(renderer, std::move(model), std::move(hierarchy),
                                               options);
        state_->renderer = renderer;
        return;
    }
    switch (renderer) {
        case Renderer::trace:
            state_ = std::make_unique<TraceState>(*model, options);
            break;
        case Renderer::cuda:
            state_ = std::make_unique<CudaState>(*model, options);
            break;
        case Renderer::optix:
            state_ = std::make_unique<OptixModelState>(*model, options);
            break;
        default:
            state_ = std::make_unique<SplatState>(std::move(model), std::move(hierarchy), options);
    }
    state_->renderer = renderer;
}

DepthRenderer::DepthRenderer(Renderer renderer, std::span<const Volume> volumes,
                             const RenderOptions& options) {
    check(renderer, RenderInput::volumes, options);
    if (renderer == Renderer::optix)
        state_ = std::make_unique<OptixVolumesState>(volumes, options);
    else
        state_ = std::make_unique<ReferenceState<std::vector<VoxelGrid>>>(
            voxel_grids(volumes, options.voxels), options);
    state_->renderer = renderer;
}

DepthRenderer::DepthRenderer(Renderer renderer, const Levels& levels,
                             const RenderOptions& options) {
    check(renderer, RenderInput::levels, options);
    if (renderer == Renderer::optix)
        state_ = std::make_unique<OptixVolumesState>(levels, options);
    else
        state_ = std::make_unique<ReferenceState<LevelGrids>>(level_grids(levels, options.voxels),
                                                              options);
    state_->renderer = renderer;
}

DepthRenderer::DepthRenderer(Renderer renderer, const VolumeSet& volumes,
                             const RenderOptions& options)
    : DepthRenderer(volumes.is_mesh()
                        ? DepthRenderer(renderer, static_cast<const Levels&>(volumes), options)
                        : DepthRenderer(renderer, std::span(volumes.volumes), options)) {}

DepthRenderer::~DepthRenderer() = default;
DepthRenderer::DepthRenderer(DepthRenderer&&) noexcept = default;
DepthRenderer& DepthRenderer::operator=(DepthRenderer&&) noexcept = default;

void DepthRenderer::render(const Camera& camera, int width, int height, DepthImage& depth,
                           const Progress& progress) {
    state_->render(camera, width, height, depth, progress);
}

void DepthRenderer::set_samples(int samples) { state_->set_samples(samples); }
void DepthRenderer::set_pixel_error(double pixel_error) { state_->set_pixel_error(pixel_error); }
Renderer DepthRenderer::renderer() const { return state_->renderer; }
const std::optional<CutReport>& DepthRenderer::cut() const { return state_->cut; }
const std::optional<TraceReport>& DepthRenderer::traced() const { return state_->traced; }
std::optional<double> DepthRenderer::gpu_ms() const { return state_->gpu_ms; }

}  // namespace vog
