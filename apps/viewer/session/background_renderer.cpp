// background_renderer.cpp: One thread that draws one request at a time, the latest first.
#include "session/background_renderer.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <utility>

#include "render/gpu/chords/gpu_pictures.h"
#include "render/gpu/gpu.h"
#include "render/splat/splat.h"
#include "vog/error.h"

namespace vog::viewer {

namespace {

struct Cancelled {};

/// Numbers of a picture as channels, in a field's unit.
SumImage channels_of(Sums sums, const Drawn& drawn, FieldUnit unit) {
    SumImage image{sums.width, sums.height, drawn.channels(), {}};
    if (image.channels == 1) {
        image.value = std::move(sums.column);
        return image;
    }
    const auto pixels =
        static_cast<std::size_t>(sums.width) * static_cast<std::size_t>(sums.height);
    image.value.resize(4 * pixels);
    for (std::size_t n = 0; n < pixels; ++n) {
        float* const to = &image.value[4 * n];
        const auto set = [&](double weight, double mean, double deviation) {
            mean = (mean - unit.reference) / unit.unit, deviation /= unit.unit;
            if (drawn.field.part == FieldPart::magnitude) deviation = std::exchange(mean, 0.0);
            to[0] = static_cast<float>(weight), to[1] = static_cast<float>(weight * mean);
            to[2] = static_cast<float>(weight * (mean * mean + deviation * deviation));
        };
        switch (drawn.kind) {
            case Drawn::Kind::depth:
                to[0] = sums.column[n];
                break;
            case Drawn::Kind::light: {
                const Rgba& pixel = sums.light[n];
                to[0] = pixel.r, to[1] = pixel.g, to[2] = pixel.b, to[3] = pixel.a;
                break;
            }
            case Drawn::Kind::maximum:
                if (!std::isnan(sums.maximum[n])) set(1, double{sums.maximum[n]}, 0);
                break;
            case Drawn::Kind::field:
                if (sums.column[n] > 0)
                    set(double{sums.column[n]}, double{sums.mean[n]}, double{sums.deviation[n]});
        }
    }
    return image;
}

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

/// What is drawn as the library's picture.
ResolvedPicture picture_of(const RenderRequest& request, int width, int height) {
    constexpr Show kShows[] = {Show::depth, Show::mean, Show::volume, Show::maximum};
    const Drawn& drawn = request.drawn;
    ResolvedPicture picture;
    picture.field = drawn.field;
    if (drawn.transfer) picture.chosen.transfer = *drawn.transfer;
    PictureRequest& made = picture.request;
    made.show = kShows[static_cast<std::size_t>(drawn.kind)];
    made.look = drawn.look;
    made.slabs = drawn.slabs;
    made.camera = request.camera;
    made.width = width, made.height = height;
    made.renderer = request.voxels ? vog::Renderer::reference : library_renderer(request.renderer);
    made.options.clip = drawn.look.clip;
    if (!request.voxels) made.options.pixel_error = request.pixel_error;
    return picture;
}

/// GPU renderers add up the rays of a pixel themselves.
bool on_gpu(const RenderRequest& request) {
    return !request.voxels &&
           (request.renderer == WindowRenderer::cuda || request.renderer == WindowRenderer::optix);
}

}  // namespace

/// Renderers prepared for the latest data: they outlive a picture.
struct BackgroundRenderer::Prepared {
    std::shared_ptr<const Gaussians> model;
    std::shared_ptr<const Hierarchy> hierarchy;
    std::shared_ptr<const VoxelData> voxels;
    std::optional<PictureRenderer> of_model, of_whole, of_parts;
    // On a GPU: T without a clip, and all else.
    std::optional<CudaSplat> cuda;
    std::optional<OptixModel> optix;
    std::map<WindowRenderer, GpuPictures> gpu;
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

void BackgroundRenderer::draw_on_host(const RenderRequest& request, int width, int height,
                                      const Progress& progress, RenderedPicture& picture) {
    const bool is_depth = request.drawn.kind == Drawn::Kind::depth;
    std::optional<PictureRenderer>& renderer = !request.voxels ? prepared_->of_model
                                               : is_depth      ? prepared_->of_whole
                                                               : prepared_->of_parts;
    if (!renderer && request.voxels) {
        renderer.emplace(is_depth ? request.voxels->whole : request.voxels->parts);
    } else if (!renderer) {
        vog::Scene of_model;
        of_model.sources.push_back(ModelSource{request.model, request.hierarchy});
        renderer.emplace(std::move(of_model));
    }
    const vog::Scene& scene = renderer->scene();
    const FieldUnit unit = is_depth || request.drawn.kind == Drawn::Kind::light
                               ? FieldUnit{}
                               : unit_in(scene, request.drawn.field.field);
    Sums sums;
    renderer->draw(picture_of(request, width, height), sums, progress);
    const auto& cut = renderer->report().cut;
    picture.drawn = cut ? cut->drawn() : request.model ? request.model->size() : 0;
    picture.sums = channels_of(std::move(sums), request.drawn, unit);
}

void BackgroundRenderer::draw_on_gpu(const RenderRequest& request, RenderedPicture& picture) {
    GpuSums sums;
    {
        const std::lock_guard lock(mutex_);
        if (!spare_.empty()) {
            sums = std::move(spare_.back());
            spare_.pop_back();
        }
    }
    picture.drawn = request.model->size();
    draw_sums(request, sums);
    if (request.stays_on_gpu) {
        picture.on_gpu = std::move(sums);
        return;
    }
    picture.sums = {sums.width(), sums.height(), sums.channels(), sums.fetch()};
    give_back(std::move(sums));
}

void BackgroundRenderer::draw_sums(const RenderRequest& request, GpuSums& sums) {
    const Gaussians& model = *request.model;
    const Drawn& drawn = request.drawn;
    const Clipping& clip = drawn.look.clip;
    const SumsSize size{request.width, request.height, request.rays};
    if (drawn.kind == Drawn::Kind::depth && clip.empty()) {
        if (request.renderer == WindowRenderer::cuda) {
            if (!prepared_->cuda) prepared_->cuda.emplace(model);
            prepared_->cuda->render(request.camera, size, sums);
        } else {
            if (!prepared_->optix) prepared_->optix.emplace(model);
            prepared_->optix->render(request.camera, size, sums);
        }
        return;
    }
    GpuPictures& pictures =
        prepared_->gpu.try_emplace(request.renderer, library_renderer(request.renderer), model)
            .first->second;
    const std::string& field = drawn.field.field;
    const FieldUnit of_field = viewer::unit_of(model.fields, field);
    const SumsUnit unit{of_field.reference, of_field.unit};
    switch (drawn.kind) {
        case Drawn::Kind::depth:
            return pictures.depth(request.camera, size, sums, clip);
        case Drawn::Kind::field:
            return pictures.fields(drawn.field, unit, request.camera, size, sums, clip);
        case Drawn::Kind::light:
            return pictures.volume(field, *drawn.transfer, request.camera, size, sums, drawn.slabs,
                                   drawn.look);
        case Drawn::Kind::maximum:
            return pictures.maximum(field, unit, request.camera, size, sums, drawn.slabs, clip);
    }
}

RenderedPicture BackgroundRenderer::render(const RenderRequest& request) {
    const auto progress = [this](double fraction) {
        const std::lock_guard lock(mutex_);
        if (cancel_) throw Cancelled{};
        fraction_ = fraction;
    };
    const auto start = std::chrono::steady_clock::now();
    const int lattice = on_gpu(request) ? 1 : request.rays;
    const int width = request.width * lattice, height = request.height * lattice;
    RenderedPicture picture{request.key, request.rays, {}, 0, 0, {}, {}};
    if (request.model != prepared_->model || request.hierarchy != prepared_->hierarchy ||
        request.voxels != prepared_->voxels)
        *prepared_ = {request.model, request.hierarchy, request.voxels, {}, {}, {}, {}, {}, {}};
    if (on_gpu(request))
        draw_on_gpu(request, picture);
    else
        draw_on_host(request, width, height, progress, picture);
    const std::chrono::duration<double, std::milli> ms = std::chrono::steady_clock::now() - start;
    picture.sums = shrunk(std::move(picture.sums), lattice);
    picture.ms = ms.count();
    return picture;
}

}  // namespace vog::viewer
