// background_renderer.cpp: One thread that draws one request at a time, the latest first.
#include "session/background_renderer.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <utility>

#include "vog/error.h"
#include "vog/gpu.h"
#include "vog/gpu_pictures.h"
#include "vog/splat.h"

namespace vog::viewer {

namespace {

struct Cancelled {};

/// T, in as many channels as asked.
SumImage sums_of(DepthImage depth, int channels) {
    SumImage sums{depth.width, depth.height, channels, {}};
    if (channels == 1) {
        sums.value = std::move(depth.depth);
        return sums;
    }
    sums.value.resize(4 * depth.depth.size());
    for (std::size_t n = 0; n < depth.depth.size(); ++n) sums.value[4 * n] = depth.depth[n];
    return sums;
}

SumImage sums_of(const ValueMap& maximum, FieldUnit unit) {
    SumImage sums{maximum.width, maximum.height, 4, std::vector<float>(4 * maximum.value.size())};
    for (std::size_t n = 0; n < maximum.value.size(); ++n) {
        const double value = (double{maximum.value[n]} - unit.reference) / unit.unit;
        if (std::isnan(value)) continue;
        sums.value[4 * n] = 1;
        sums.value[4 * n + 1] = static_cast<float>(value);
        sums.value[4 * n + 2] = static_cast<float>(value * value);
    }
    return sums;
}

SumImage sums_of(const FieldMaps& maps, FieldPart part, FieldUnit unit) {
    SumImage sums{maps.width, maps.height, 4, std::vector<float>(4 * maps.column.size())};
    for (std::size_t n = 0; n < maps.column.size(); ++n) {
        const double column = double{maps.column[n]};
        if (!(column > 0)) continue;
        double mean = (double{maps.mean[n]} - unit.reference) / unit.unit;
        double deviation = double{maps.deviation[n]} / unit.unit;
        if (part == FieldPart::magnitude) deviation = std::exchange(mean, 0.0);
        sums.value[4 * n] = maps.column[n];
        sums.value[4 * n + 1] = static_cast<float>(column * mean);
        sums.value[4 * n + 2] = static_cast<float>(column * (mean * mean + deviation * deviation));
    }
    return sums;
}

SumImage sums_of(const VolumeImage& picture) {
    SumImage sums{picture.width, picture.height, 4, {}};
    sums.value.reserve(4 * picture.pixel.size());
    for (const Rgba& pixel : picture.pixel)
        sums.value.insert(sums.value.end(), {pixel.r, pixel.g, pixel.b, pixel.a});
    return sums;
}

FieldUnit unit_of_voxels(const VoxelField& field, const VoxelData& data) {
    // The unit of the models' fields, whose range is that of all volumes.
    double lower = field.lower, upper = field.upper;
    for (const std::vector<VoxelField>& each : data.fields)
        if (each.front().name == field.name)
            for (const VoxelField& part : each)
                lower = std::min(lower, part.lower), upper = std::max(upper, part.upper);
    Fields fields;
    const auto add = [&](auto& to) {
        to.emplace_back();
        to.back().name = field.name;
        to.back().lower = lower, to.back().upper = upper;
    };
    if (field.is_vector())
        add(fields.vector);
    else
        add(fields.scalar);
    return viewer::unit_of(fields, field.name);
}

SumImage draw_voxels(const RenderRequest& request, int width, int height,
                     const Progress& progress) {
    const VoxelData& data = *request.voxels;
    const Drawn& drawn = request.drawn;
    ReferenceOptions options;
    options.progress = progress;
    options.clip = drawn.look.clip;
    if (drawn.kind == Drawn::Kind::depth) {
        DepthImage depth;
        if (drawn.look.clip.empty()) {
            data.depth->render(request.camera, width, height, depth, progress);
        } else {
            RenderOptions clipped;
            clipped.clip = drawn.look.clip;
            DepthRenderer(vog::Renderer::reference, std::span(data.volumes), clipped)
                .render(request.camera, width, height, depth, progress);
        }
        return sums_of(std::move(depth), drawn.channels());
    }
    const auto found = std::ranges::find_if(data.fields, [&](const std::vector<VoxelField>& field) {
        return field.front().name == drawn.field.field;
    });
    if (found == data.fields.end())
        throw Error(fmt::format("the voxels have no field '{}'", drawn.field.field));
    if (drawn.kind == Drawn::Kind::light)
        return sums_of(render_volume_reference(data.volumes, *found, *drawn.transfer,
                                               request.camera, width, height, options, drawn.look));
    const FieldUnit unit = unit_of_voxels(found->front(), data);
    if (drawn.kind == Drawn::Kind::maximum)
        return sums_of(
            render_maximum_reference(data.volumes, *found, request.camera, width, height, options),
            unit);
    return sums_of(render_field_reference(data.volumes, *found, drawn.field.part, request.camera,
                                          width, height, options),
                   drawn.field.part, unit);
}

/// GPU renderers add up the rays of a pixel themselves.
bool on_gpu(const RenderRequest& request) {
    return !request.voxels &&
           (request.renderer == WindowRenderer::cuda || request.renderer == WindowRenderer::optix);
}

}  // namespace

/// Renderers prepared for the latest model: they outlive a picture, not the model.
struct BackgroundRenderer::Prepared {
    std::shared_ptr<const Gaussians> model;
    Clipping clip;  ///< of `by`
    std::map<WindowRenderer, DepthRenderer> by;
    std::optional<SlabRenderer>
        slabs;  ///< for pictures that differ in the transfer function alone from this one
    Drawn slabs_of;
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

void BackgroundRenderer::draw_depth(const RenderRequest& request, int width, int height,
                                    const Progress& progress, RenderedPicture& picture) {
    // Clipped pictures have no levels of detail, and are prepared anew for another clip.
    const Clipping& clip = request.drawn.look.clip;
    Drawn prepared_for = request.drawn;
    prepared_for.look.clip = prepared_->clip;
    if (!(request.drawn == prepared_for)) prepared_->by.clear();
    prepared_->clip = clip;
    auto found = prepared_->by.find(request.renderer);
    if (found == prepared_->by.end()) {
        RenderOptions options;
        options.clip = clip;
        found = prepared_->by
                    .emplace(request.renderer,
                             DepthRenderer(library_renderer(request.renderer), request.model,
                                           options, clip.empty() ? request.hierarchy : nullptr))
                    .first;
    }
    DepthRenderer& renderer = found->second;
    renderer.set_pixel_error(request.pixel_error);
    DepthImage depth;
    renderer.render(request.camera, width, height, depth, progress);
    picture.drawn = renderer.cut() ? renderer.cut()->drawn() : request.model->size();
    picture.sums = sums_of(std::move(depth), request.drawn.channels());
}

void BackgroundRenderer::draw_model(const RenderRequest& request, int width, int height,
                                    const Progress& progress, RenderedPicture& picture) {
    if (request.model != prepared_->model) *prepared_ = {request.model, {}, {}, {}, {}, {}, {}, {}};
    const Drawn& drawn = request.drawn;
    if (on_gpu(request)) return draw_on_gpu(request, picture);
    if (drawn.kind == Drawn::Kind::depth)
        return draw_depth(request, width, height, progress, picture);
    const Gaussians& model = *request.model;
    picture.drawn = model.size();
    const bool splat = request.renderer == WindowRenderer::splat;
    TraceOptions rays;
    rays.progress = progress;
    if (drawn.kind == Drawn::Kind::field) {
        const FieldUnit unit = viewer::unit_of(model.fields, drawn.field.field);
        if (!splat) {
            picture.sums = sums_of(render_field_trace(model, drawn.field, request.camera, width,
                                                      height, rays, {}, drawn.look.clip),
                                   drawn.field.part, unit);
            return;
        }
        SplatOptions options;
        options.progress = progress;
        CutReport report;
        if (request.hierarchy && !request.hierarchy->empty() && request.pixel_error > 0 &&
            drawn.look.clip.empty()) {
            options.hierarchy = request.hierarchy.get();
            options.cut.pixel_error = request.pixel_error;
        }
        picture.sums = sums_of(render_field_splat(model, drawn.field, request.camera, width, height,
                                                  options, &report, drawn.look.clip),
                               drawn.field.part, unit);
        picture.drawn = report.drawn();
        return;
    }
    if (drawn.kind == Drawn::Kind::maximum) {
        const FieldUnit unit = viewer::unit_of(model.fields, drawn.field.field);
        SlabOptions options;
        options.slabs = drawn.slabs;
        options.look.clip = drawn.look.clip;
        picture.sums =
            sums_of(splat ? render_maximum_splat(model, drawn.field.field, request.camera, width,
                                                 height, options)
                          : render_maximum_trace(model, drawn.field.field, request.camera, width,
                                                 height, rays, {}, drawn.look.clip),
                    unit);
        return;
    }
    if (!splat) {
        picture.sums =
            sums_of(render_volume_trace(model, drawn.field.field, *drawn.transfer, request.camera,
                                        width, height, rays, {}, drawn.look));
        return;
    }
    Drawn same = drawn;
    same.transfer = prepared_->slabs_of.transfer;
    if (prepared_->slabs && same == prepared_->slabs_of) {
        prepared_->slabs->set_transfer(*drawn.transfer);
    } else {
        SlabOptions options;
        options.slabs = drawn.slabs;
        options.look = drawn.look;
        prepared_->slabs.emplace(model, drawn.field.field, *drawn.transfer, options);
    }
    prepared_->slabs_of = drawn;
    VolumeImage image;
    prepared_->slabs->render(request.camera, width, height, image);
    picture.sums = sums_of(image);
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
    if (request.voxels)
        picture.sums = draw_voxels(request, width, height, progress);
    else
        draw_model(request, width, height, progress, picture);
    const std::chrono::duration<double, std::milli> ms = std::chrono::steady_clock::now() - start;
    picture.sums = shrunk(std::move(picture.sums), lattice);
    picture.ms = ms.count();
    return picture;
}

}  // namespace vog::viewer
