// background_renderer.cpp: One thread that draws one request at a time, the latest first.
#include "session/background_renderer.h"

#include <chrono>
#include <map>
#include <utility>

namespace vog::viewer {

namespace {

struct Cancelled {};

}  // namespace

/// Renderers prepared for the latest model: they outlive a picture, not the model.
struct BackgroundRenderer::Prepared {
    std::shared_ptr<const Gaussians> model;
    std::map<WindowRenderer, DepthRenderer> by;
};

DepthImage shrunk(const DepthImage& image, int factor) {
    if (factor == 1) return image;
    DepthImage mean(image.width / factor, image.height / factor);
    mean.extinction = image.extinction;
    const float weight = 1 / static_cast<float>(factor * factor);
    for (int row = 0; row < mean.height * factor; ++row)
        for (int column = 0; column < mean.width * factor; ++column)
            mean.at(column / factor, row / factor) += weight * image.at(column, row);
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

void BackgroundRenderer::request(RenderRequest request) {
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
    if (request.model != prepared_->model) *prepared_ = {request.model, {}};
    auto found = prepared_->by.find(request.renderer);
    if (found == prepared_->by.end())
        found = prepared_->by
                    .emplace(request.renderer, DepthRenderer(library_renderer(request.renderer),
                                                             request.model, {}, request.hierarchy))
                    .first;
    DepthRenderer& renderer = found->second;
    renderer.set_pixel_error(request.pixel_error);
    renderer.render(request.camera, width, height, picture.depth, progress);
    picture.drawn = renderer.cut() ? renderer.cut()->drawn() : request.model->size();
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
        request.voxels->render(request.camera, width, height, picture.depth, progress);
    else
        draw_model(request, width, height, progress, picture);
    const std::chrono::duration<double, std::milli> ms = std::chrono::steady_clock::now() - start;
    picture.depth = shrunk(picture.depth, request.rays);
    picture.ms = ms.count();
    return picture;
}

}  // namespace vog::viewer
