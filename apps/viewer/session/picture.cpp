// picture.cpp: accumulation of OpenGL sub-frames, and requests to the background renderer.
#include "session/picture.h"

#include <limits>
#include <tuple>

namespace vog::viewer {

bool operator==(const PictureKey& a, const PictureKey& b) {
    const auto tie = [](const PictureKey& k) {
        return std::tie(k.renderer, k.model, k.hierarchy, k.pixel_error, k.voxels,
                        k.camera.orthographic_width, k.camera.eye, k.camera.look_at, k.camera.up,
                        k.camera.fov_degrees, k.size);
    };
    return tie(a) == tie(b) && a.drawn == b.drawn;
}

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
    const GLenum format = key_.drawn.channels() == 1 ? GL_R32F : GL_RGBA32F;
    if (!target_ || target_->width() != size.width || target_->height() != size.height ||
        target_->channels() != key_.drawn.channels())
        target_.emplace(format, size.width, size.height);
}

void ProgressivePicture::update(const PictureKey& key, int subframes, GlRenderers& gl) {
    // Fewer sub-frames than are summed already: starts again.
    const int begun =
        key.renderer == WindowRenderer::gl ? subframes_ : rays_requested_ * rays_requested_;
    if (!(valid_ && key == key_) || begun > subframes) {
        sums_of_key_ = sums_of_key_ && key.drawn.kind == key_.drawn.kind &&
                       key.drawn.channels() == key_.drawn.channels() &&
                       key.drawn.field.field == key_.drawn.field.field;
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
    const bool by_value =
        key_.drawn.kind == Drawn::Kind::light || key_.drawn.kind == Drawn::Kind::maximum;
    if (!key_.hierarchy || key_.hierarchy->empty() || by_value) return models.get(key_.model);
    if (cut_of_ != key_.model) {
        cut_.emplace(*key_.model, *key_.hierarchy);
        cut_of_ = key_.model;
    }
    if (subframes_ == 0) {
        chosen_ = &cut_->choose(frame_of(key_.camera, key_.size.width, key_.size.height),
                                {key_.pixel_error, true});
        cut_model_.reset();
        if (chosen_ != key_.model.get()) cut_model_.emplace(*chosen_);
    }
    if (!cut_model_) return models.get(key_.model);
    gaussians = chosen_;
    return *cut_model_;
}

void ProgressivePicture::add_sums(const Gaussians& gaussians, GlModelFields& on_device,
                                  GlRenderers& gl) const {
    const Drawn& drawn = key_.drawn;
    const Jitter jitter = jitter_of(subframes_);
    if (drawn.kind == Drawn::Kind::light || drawn.kind == Drawn::Kind::maximum) {
        if (!gl.slabs) gl.slabs.emplace();
        gl.slabs->add({&on_device.model(), &on_device.field(gaussians, drawn.field),
                       gaussians.fields.find_scalar(drawn.field.field), drawn.transfer, &drawn.look,
                       drawn.slabs},
                      key_.camera, jitter, *target_);
    } else if (drawn.channels() == 1) {
        gl.splat.add(on_device.model(), key_.camera, jitter, *target_);
    } else {
        const GlField* field =
            drawn.kind == Drawn::Kind::field ? &on_device.field(gaussians, drawn.field) : nullptr;
        gl.fields.add(on_device.model(), field, key_.camera, jitter, drawn.look.clip, *target_);
    }
}

void ProgressivePicture::update_gl(int subframes, GlRenderers& gl) {
    complete_ = subframes_ >= subframes;
    way_ = "";
    if (timer_) ms_ = timer_->ms();
    if (complete_) return;
    if (!timer_) timer_.emplace();
    require_target(key_.size);
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
    const bool voxels = key_.renderer == WindowRenderer::voxels;
    const bool on_gpu =
        key_.renderer == WindowRenderer::cuda || key_.renderer == WindowRenderer::optix;
    cpu_->request({++cpu_key_, key_.renderer, voxels ? nullptr : key_.model,
                   voxels ? nullptr : key_.hierarchy, key_.pixel_error,
                   voxels ? key_.voxels : nullptr, key_.drawn, key_.camera, key_.size.width,
                   key_.size.height, rays, on_gpu && gpu.stays_on_gpu()});
}

void ProgressivePicture::show(RenderedPicture& picture, GpuUpload& gpu) {
    const bool on_gpu =
        key_.renderer == WindowRenderer::cuda || key_.renderer == WindowRenderer::optix;
    way_ = on_gpu ? "copied" : "";
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
    require_target(key_.size);
    show(*picture, gpu);
    sums_of_key_ = true;
    subframes_ = picture->rays * picture->rays;
    summed_ = 1;  // already a mean over its rays
    ms_ = picture->ms;
    drawn_ = picture->drawn;
    ms_per_ray_ = ms_ / (double(key_.size.width) * key_.size.height * subframes_);
    ++revision_;
    refine(picture->rays, subframes, gpu);
}

void ProgressivePicture::refine(int done, int subframes, GpuUpload& gpu) {
    // By 2x2 and 4x4 rays per pixel, while that many sub-frames are requested.
    constexpr std::int64_t kRayLimit = std::int64_t{1} << 26;  // 256 MB a channel
    const int rays = 2 * done;
    const std::int64_t all = std::int64_t{key_.size.width} * key_.size.height * rays * rays;
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
