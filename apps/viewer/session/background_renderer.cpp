// background_renderer.cpp: One thread that draws one request at a time, the latest first.
#include "session/background_renderer.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <utility>

#include "render/picture/source_renderer.h"
#include "vog/error.h"

namespace vog::viewer {

namespace {

struct Cancelled {};

/// The unit of a field in sums: of voxels that of the models' fields, whose range is that of all volumes.
FieldUnit unit_in(const vog::Scene& scene, const std::string& name) {
    if (!scene.has_voxels()) return viewer::unit_of(scene.model().model->fields, name);
    const auto& all = scene.voxels().fields;
    const auto found = std::ranges::find(all, name, &SampledField::name);
    if (found == all.end()) throw Error(fmt::format("the voxels have no field '{}'", name));
    Fields fields;
    const auto add = [&](auto& to) {
        auto& one = to.emplace_back();
        one.name = name;
        one.lower = std::ranges::min(found->values, {}, &VoxelField::lower).lower;
        one.upper = std::ranges::max(found->values, {}, &VoxelField::upper).upper;
    };
    found->is_vector ? add(fields.vector) : add(fields.scalar);
    return viewer::unit_of(fields, name);
}

}  // namespace

/// Renderers prepared for the latest data: they outlive a picture.
struct BackgroundRenderer::Prepared {
    std::shared_ptr<const Gaussians> model;
    std::shared_ptr<const Hierarchy> hierarchy;
    std::shared_ptr<const VoxelData> voxels;
    std::shared_ptr<const vog::Scene> layered;
    std::optional<PictureRenderer> of_model, of_whole, of_parts, of_layers;
    std::map<WindowRenderer, std::unique_ptr<pictures::SourceRenderer>> gpu;
};

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

void BackgroundRenderer::give_back(GpuSums sums) {
    const std::lock_guard lock(mutex_);
    spare_.push_back(std::move(sums));
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
            picture = RenderedPicture{request.key, request.rays, {}, 0, 0, error.what(), {}};
        }
        lock.lock();
        running_ = false;
        if (!picture) continue;
        if (ready_ && ready_->on_gpu) spare_.push_back(std::move(*ready_->on_gpu));
        ready_ = std::move(picture);
    }
}

void BackgroundRenderer::draw_on_host(const PictureKey& what, const Progress& progress,
                                      RenderedPicture& rendered) {
    const bool is_depth = vog::is_depth(what.picture.request.show);
    std::optional<PictureRenderer>& renderer = what.layered   ? prepared_->of_layers
                                               : !what.voxels ? prepared_->of_model
                                               : is_depth     ? prepared_->of_whole
                                                              : prepared_->of_parts;
    if (!renderer && what.layered) {
        renderer.emplace(*what.layered);
    } else if (!renderer && what.voxels) {
        renderer.emplace(is_depth ? what.voxels->whole : what.voxels->parts);
    } else if (!renderer) {
        vog::Scene of_model;
        of_model.sources.push_back(ModelSource{what.model, what.hierarchy});
        renderer.emplace(std::move(of_model));
    }
    const FieldUnit unit = is_depth || what.layered
                               ? FieldUnit{}
                               : unit_in(renderer->scene(), what.picture.field.field);
    Sums sums;
    renderer->draw(what.picture, sums, progress);
    const auto& cut = renderer->report().cut;
    rendered.drawn = cut ? cut->drawn() : what.model ? what.model->size() : 0;
    rendered.sums = sums_from(std::move(sums), what.picture, unit);
}

void BackgroundRenderer::draw_on_gpu(const RenderRequest& request, RenderedPicture& rendered) {
    GpuSums sums;
    {
        const std::lock_guard lock(mutex_);
        if (!spare_.empty()) {
            sums = std::move(spare_.back());
            spare_.pop_back();
        }
    }
    const PictureKey& what = request.what;
    const auto& model = what.model;
    std::unique_ptr<pictures::SourceRenderer>& gpu = prepared_->gpu[what.renderer];
    if (!gpu) gpu = pictures::gpu_pictures(library_renderer(what.renderer), {model, nullptr}, {});
    const FieldUnit unit = viewer::unit_of(model->fields, what.picture.field.field);
    gpu->draw_sums(what.picture, {unit.reference, unit.unit}, request.rays, sums);
    rendered.drawn = model->size();
    if (request.stays_on_gpu) {
        rendered.on_gpu = std::move(sums);
        return;
    }
    rendered.sums = {sums.width(), sums.height(), sums.channels(), sums.fetch()};
    give_back(std::move(sums));
}

RenderedPicture BackgroundRenderer::render(const RenderRequest& request) {
    const auto progress = [this](double fraction) {
        const std::lock_guard lock(mutex_);
        if (cancel_) throw Cancelled{};
        fraction_ = fraction;
    };
    const auto start = std::chrono::steady_clock::now();
    RenderedPicture rendered{request.key, request.rays, {}, 0, 0, {}, {}};
    PictureKey what = request.what;
    if (what.model != prepared_->model || what.hierarchy != prepared_->hierarchy ||
        what.voxels != prepared_->voxels || what.layered != prepared_->layered)
        *prepared_ = {what.model, what.hierarchy, what.voxels, what.layered, {}, {}, {}, {}, {}};
    if (on_gpu(what.renderer)) {
        draw_on_gpu(request, rendered);
    } else {
        what.picture.request.renderer = library_renderer(what.renderer);
        what.picture.request.width *= request.rays, what.picture.request.height *= request.rays;
        draw_on_host(what, progress, rendered);
        rendered.sums = shrunk(std::move(rendered.sums), request.rays);
    }
    const std::chrono::duration<double, std::milli> ms = std::chrono::steady_clock::now() - start;
    rendered.ms = ms.count();
    return rendered;
}

}  // namespace vog::viewer
