// background_renderer.cpp: one thread, one request at a time, the latest wins.
#include "session/background_renderer.h"

#include <chrono>
#include <utility>

#include "vog/gpu.h"
#include "vog/splat.h"
#include "vog/trace.h"

namespace vog::viewer {

namespace {

struct Cancelled {};

}  // namespace

/// Buffers and hierarchies outlive a picture, not a model.
struct BackgroundRenderer::Prepared {
    std::shared_ptr<const Gaussians> model;
    std::shared_ptr<const Hierarchy> hierarchy;
    std::optional<SplatRenderer> splat;
    std::optional<TraceScene> trace;
    std::optional<CudaSplat> cuda;
    std::optional<OptixModel> optix;
};

DepthImage shrunk(const DepthImage& image, int factor) {
    if (factor == 1) return image;
    DepthImage mean(image.width / factor, image.height / factor);
    mean.extinction = image.extinction;
    const float share = 1 / static_cast<float>(factor * factor);
    for (int row = 0; row < mean.height * factor; ++row)
        for (int column = 0; column < mean.width * factor; ++column)
            mean.at(column / factor, row / factor) += share * image.at(column, row);
    return mean;
}

BackgroundRenderer::BackgroundRenderer()
    : prepared_(std::make_unique<Prepared>()), thread_([this] { work(); }) {}

BackgroundRenderer::~BackgroundRenderer() {
    {
        const std::lock_guard lock(mutex_);
        end_ = cancel_ = true;
    }
    wake_.notify_one();
    thread_.join();
}

void BackgroundRenderer::ask(RenderRequest request) {
    {
        const std::lock_guard lock(mutex_);
        if (running_ && running_key_ != request.key) cancel_ = true;
        waiting_ = std::move(request);
    }
    wake_.notify_one();
}

std::optional<RenderedPicture> BackgroundRenderer::take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(ready_, std::nullopt);
}

bool BackgroundRenderer::busy() {
    const std::lock_guard lock(mutex_);
    return running_ || waiting_.has_value() || ready_.has_value();
}

double BackgroundRenderer::fraction() {
    const std::lock_guard lock(mutex_);
    return running_ ? fraction_ : 0;
}

void BackgroundRenderer::work() {
    std::unique_lock lock(mutex_);
    while (true) {
        wake_.wait(lock, [&] { return end_ || waiting_.has_value(); });
        if (end_) return;
        const RenderRequest request = std::move(*waiting_);
        waiting_.reset();
        running_key_ = request.key;
        running_ = true;
        cancel_ = false;
        fraction_ = 0;
        lock.unlock();
        std::optional<RenderedPicture> picture;
        try {
            picture = render(request);
        } catch (const Cancelled&) {
        } catch (const std::exception& error) {
            picture = RenderedPicture{request.key, request.rays, {}, 0, 0, error.what()};
        }
        lock.lock();
        running_ = false;
        if (picture) ready_ = std::move(picture);
    }
}

void BackgroundRenderer::draw_model(const RenderRequest& request, int width, int height,
                                    const Progress& progress, RenderedPicture& picture) {
    Prepared& with = *prepared_;
    if (request.model != with.model) {
        with = Prepared{};
        with.model = request.model;
        with.hierarchy = request.hierarchy;
    }
    const Gaussians& model = *request.model;
    DepthImage& image = picture.depth;
    picture.drawn = model.size();
    const Camera& camera = request.camera;
    switch (request.renderer) {
        case Renderer::trace: {
            if (!with.trace) with.trace = trace_scene(model);
            TraceOptions options;
            options.progress = progress;
            image = render_trace(*with.trace, camera, width, height, options);
            break;
        }
        case Renderer::cuda:
            if (!with.cuda) with.cuda.emplace(model);
            image = with.cuda->render(camera, width, height);
            break;
        case Renderer::optix:
            if (!with.optix) with.optix.emplace(model);
            image = with.optix->render(camera, width, height);
            break;
        default:
            if (!with.splat) {
                SplatOptions options;
                options.hierarchy = with.hierarchy.get();
                with.splat.emplace(model, options);
            }
            with.splat->set_cut({request.pixel_error, true});
            with.splat->render(camera, width, height, image, progress);
            picture.drawn = with.splat->cut_report().drawn();
    }
}

RenderedPicture BackgroundRenderer::render(const RenderRequest& request) {
    const auto progress = [this](double fraction) {
        const std::lock_guard lock(mutex_);
        if (cancel_) throw Cancelled{};
        fraction_ = fraction;
    };
    const auto start = std::chrono::steady_clock::now();
    const int width = request.width * request.rays, height = request.height * request.rays;
    RenderedPicture picture{request.key, request.rays, {}, 0, 0, {}};
    if (request.voxels)
        picture.depth = request.voxels->draw(request.camera, width, height, progress);
    else
        draw_model(request, width, height, progress, picture);
    const std::chrono::duration<double, std::milli> ms = std::chrono::steady_clock::now() - start;
    picture.depth = shrunk(picture.depth, request.rays);
    picture.ms = ms.count();
    return picture;
}

}  // namespace vog::viewer
