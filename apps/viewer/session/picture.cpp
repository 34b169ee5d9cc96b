// picture.cpp: accumulation of OpenGL sub-frames, and requests to the background renderer.
#include "session/picture.h"

#include <limits>

namespace vog::viewer {

const GlField& GlModelFields::field(const Gaussians& gaussians, const FieldChoice& choice) {
    const std::pair name{choice.field, choice.part};
    const auto found = fields_.find(name);
    if (found != fields_.end()) return found->second;
    return fields_.emplace(name, GlField(model_, gaussians, choice)).first->second;
}

GlModelFields& GlModels::get(const std::shared_ptr<const Gaussians>& model) {
    const auto found = models_.find(model.get());
    if (found != models_.end()) return found->second.on_device;
    return models_.emplace(model.get(), Entry{model, GlModelFields(*model)})
        .first->second.on_device;
}

void ProgressivePicture::require_target(PixelSize size) {
    const int channels = channels_of(key_.picture);
    if (!target_ || target_->width() != size.width || target_->height() != size.height ||
        target_->channels() != channels)
        target_.emplace(channels == 1 ? GL_R32F : GL_RGBA32F, size.width, size.height);
}

void ProgressivePicture::update(const PictureKey& key, int subframes, GlRenderers& gl) {
    // Fewer sub-frames than are summed already: starts again.
    const int begun =
        key.renderer == WindowRenderer::gl ? subframes_ : rays_requested_ * rays_requested_;
    if (!(valid_ && key == key_) || begun > subframes) {
        sums_of_key_ = sums_of_key_ && same_kind(key.picture, key_.picture);
        key_ = key;
        valid_ = true;
        complete_ = false;
        rays_requested_ = 0;
        if (key.renderer == WindowRenderer::gl) subframes_ = 0;
    }
    if (key.renderer == WindowRenderer::gl)
        update_gl(subframes, gl);
    else
        update_cpu(subframes, gl.gpu);
}

/// The Gaussians to draw: the level-of-detail cut for the key's camera, chosen at the first
/// sub-frame, or the whole model.
/// gaussians  receives them
GlModelFields& ProgressivePicture::cut_model(GlModels& models, const Gaussians*& gaussians) {
    gaussians = key_.model.get();
    // Nodes are no substitute by value: light of a mean value is not the mean light, nor the largest one.
    const ResolvedPicture& picture = key_.picture;
    if (!key_.hierarchy || key_.hierarchy->empty() || is_by_value(picture.request.show))
        return models.get(key_.model);
    if (cut_of_ != key_.model) {
        cut_.emplace(*key_.model, *key_.hierarchy);
        cut_of_ = key_.model;
    }
    if (subframes_ == 0) {
        const auto [width, height] = key_.size();
        chosen_ = &cut_->choose(frame_of(picture.camera(), width, height),
                                {picture.request.options.pixel_error.value_or(0), true});
        cut_model_.reset();
        if (chosen_ != key_.model.get()) cut_model_.emplace(*chosen_);
    }
    if (!cut_model_) return models.get(key_.model);
    gaussians = chosen_;
    return *cut_model_;
}

void ProgressivePicture::add_sums(const Gaussians& gaussians, GlModelFields& on_device,
                                  GlRenderers& gl) {
    const ResolvedPicture& picture = key_.picture;
    const PictureRequest& request = picture.request;
    const Camera& camera = picture.camera();
    const Jitter jitter = jitter_of(subframes_);
    if (is_depth(request.show) && channels_of(picture) == 1)
        return gl.splat.add(on_device.model(), camera, jitter, *target_);
    const GlField* field =
        is_depth(request.show) ? nullptr : &on_device.field(gaussians, picture.field);
    if (!is_by_value(request.show))
        return gl.fields.add(on_device.model(), field, camera, jitter, request.options.clip,
                             *target_);
    if (!gl.slabs) gl.slabs.emplace();
    gl.slabs->add({&on_device.model(), field, gaussians.fields.find_scalar(picture.field.field),
                   &gaussians, picture},
                  camera, jitter, *target_, &kept_);
}

void ProgressivePicture::update_gl(int subframes, GlRenderers& gl) {
    complete_ = subframes_ >= subframes;
    way_ = "";
    if (timer_) ms_ = timer_->ms();
    if (complete_) return;
    if (!timer_) timer_.emplace();
    require_target(key_.size());
    const Gaussians* gaussians = nullptr;
    GlModelFields& model = cut_model(gl.models, gaussians);
    drawn_ = model.model().size();
    timer_->begin();
    if (subframes_ == 0) target_->clear();
    // Sub-frames add up in one target; shading divides by their number.
    add_sums(*gaussians, model, gl);
    timer_->end();
    summed_ = ++subframes_;
    sums_of_key_ = true;
    ++revision_;
    complete_ = subframes_ >= subframes;
}

void ProgressivePicture::request(int rays, GpuUpload& gpu) {
    if (!cpu_) cpu_ = std::make_unique<BackgroundRenderer>();
    rays_requested_ = rays;
    cpu_->request({++cpu_key_, key_, rays, on_gpu(key_.renderer) && gpu.stays_on_gpu()});
}

void ProgressivePicture::show(RenderedPicture& picture, GpuUpload& gpu) {
    way_ = on_gpu(key_.renderer) ? "copied" : "";
    if (!picture.on_gpu) return target_->upload(picture.sums.value);
    const std::string failure = gpu.fill(*target_, *picture.on_gpu);
    cpu_->give_back(std::move(*picture.on_gpu));
    if (failure.empty())
        way_ = "shared";
    else
        error_ = "pictures come through host memory: " + failure;
}

void ProgressivePicture::update_cpu(int subframes, GpuUpload& gpu) {
    if (rays_requested_ == 0) request(1, gpu);
    // More sub-frames than those of a complete picture: continues.
    if (complete_ && subframes > complete_for_) refine(rays_requested_, subframes, gpu);
    if (complete_) return;
    std::optional<RenderedPicture> picture = cpu_->take();
    if (!picture) return;
    if (picture->key != cpu_key_) {
        if (picture->on_gpu) cpu_->give_back(std::move(*picture->on_gpu));
        return;
    }
    if (!picture->error.empty()) {
        error_ = picture->error;
        complete_ = true;
        complete_for_ = std::numeric_limits<int>::max();
        return;
    }
    require_target(key_.size());
    show(*picture, gpu);
    sums_of_key_ = true;
    subframes_ = picture->rays * picture->rays;
    summed_ = 1;  // already a mean over its rays
    ms_ = picture->ms;
    drawn_ = picture->drawn;
    ms_per_ray_ = ms_ / (double(size().width) * size().height * subframes_);
    ++revision_;
    refine(picture->rays, subframes, gpu);
}

void ProgressivePicture::refine(int done, int subframes, GpuUpload& gpu) {
    // By 2x2 and 4x4 rays per pixel, while that many sub-frames are requested.
    constexpr std::int64_t kRayLimit = std::int64_t{1} << 26;  // 256 MB a channel
    const int rays = 2 * done;
    const std::int64_t all = std::int64_t{size().width} * size().height * rays * rays;
    complete_ = !(rays <= 4 && rays * rays <= subframes && all <= kRayLimit);
    complete_for_ = subframes;
    if (!complete_) request(rays, gpu);
}

GlDepth ProgressivePicture::depth() const {
    if (!target_ || summed_ == 0) return {};
    return {&*target_, summed_};
}

SumImage ProgressivePicture::read() const {
    SumImage image{target_->width(), target_->height(), target_->channels(),
                   target_->read_floats()};
    const auto share = static_cast<float>(1 / depth().subframes);
    for (float& sum : image.value) sum *= share;
    return image;
}

}  // namespace vog::viewer
