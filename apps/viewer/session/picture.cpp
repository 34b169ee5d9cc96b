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
    return tie(a) == tie(b);
}

const GlModel& GlModels::get(const std::shared_ptr<const Gaussians>& model) {
    const auto found = models_.find(model.get());
    if (found != models_.end()) return found->second.on_device;
    return models_.emplace(model.get(), Entry{model, GlModel(*model)}).first->second.on_device;
}

void Picture::require_target(PixelSize size) {
    if (!target_ || target_->width() != size.width || target_->height() != size.height)
        target_.emplace(GL_R32F, size.width, size.height);
}

void Picture::update(const PictureKey& key, int subframes, const GlSplat& splat, GlModels& models) {
    // Fewer sub-frames than are summed already: starts again.
    const int begun =
        key.renderer == WindowRenderer::gl ? subframes_ : rays_requested_ * rays_requested_;
    if (!(valid_ && key == key_) || begun > subframes) {
        key_ = key;
        valid_ = true;
        complete_ = false;
        rays_requested_ = 0;
        if (key.renderer == WindowRenderer::gl) subframes_ = 0;
    }
    if (key.renderer == WindowRenderer::gl)
        update_gl(subframes, splat, models);
    else
        update_cpu(subframes);
}

/// The Gaussians to draw: the level-of-detail cut for the key's camera, chosen at the first
/// sub-frame, or the whole model.
const GlModel& Picture::cut_model(GlModels& models) {
    if (!key_.hierarchy || key_.hierarchy->empty()) return models.get(key_.model);
    if (cut_of_ != key_.model) {
        cut_.emplace(*key_.model, *key_.hierarchy);
        cut_of_ = key_.model;
    }
    if (subframes_ == 0) {
        const Gaussians& chosen = cut_->choose(
            frame_of(key_.camera, key_.size.width, key_.size.height), {key_.pixel_error, true});
        cut_model_.reset();
        if (&chosen != key_.model.get()) cut_model_.emplace(chosen);
    }
    return cut_model_ ? *cut_model_ : models.get(key_.model);
}

void Picture::update_gl(int subframes, const GlSplat& splat, GlModels& models) {
    complete_ = subframes_ >= subframes;
    if (timer_) ms_ = timer_->ms();
    if (complete_) return;
    if (!timer_) timer_.emplace();
    require_target(key_.size);
    const GlModel& model = cut_model(models);
    drawn_ = model.size();
    timer_->begin();
    if (subframes_ == 0) {
        target_->bind();
        glClearColor(0, 0, 0, 0);
        glClear(GL_COLOR_BUFFER_BIT);
    }
    // Sub-frames add up in one target; shading divides by their number.
    splat.add(model, key_.camera, jitter_of(subframes_), *target_);
    timer_->end();
    summed_ = ++subframes_;
    ++revision_;
    complete_ = subframes_ >= subframes;
}

void Picture::request(int rays) {
    if (!cpu_) cpu_ = std::make_unique<BackgroundRenderer>();
    rays_requested_ = rays;
    const bool voxels = key_.renderer == WindowRenderer::voxels;
    cpu_->request({++cpu_key_, key_.renderer, voxels ? nullptr : key_.model,
                   voxels ? nullptr : key_.hierarchy, key_.pixel_error,
                   voxels ? key_.voxels : nullptr, key_.camera, key_.size.width, key_.size.height,
                   rays});
}

void Picture::update_cpu(int subframes) {
    if (rays_requested_ == 0) request(1);
    // More sub-frames than those of a complete picture: continues.
    if (complete_ && subframes > complete_for_) refine(rays_requested_, subframes);
    if (complete_) return;
    const std::optional<RenderedPicture> picture = cpu_->take();
    if (!picture || picture->key != cpu_key_) return;
    if (!picture->error.empty()) {
        error_ = picture->error;
        complete_ = true;
        complete_for_ = std::numeric_limits<int>::max();
        return;
    }
    require_target(key_.size);
    target_->upload(picture->depth.depth);
    subframes_ = picture->rays * picture->rays;
    summed_ = 1;  // already a mean over its rays
    ms_ = picture->ms;
    drawn_ = picture->drawn;
    ms_per_ray_ = ms_ / (double(key_.size.width) * key_.size.height * subframes_);
    ++revision_;
    refine(picture->rays, subframes);
}

void Picture::refine(int done, int subframes) {
    // By 2x2 and 4x4 rays per pixel, while that many sub-frames are requested.
    constexpr std::int64_t kRayLimit = std::int64_t{1} << 26;  // 256 MB of T
    const int rays = 2 * done;
    const std::int64_t all = std::int64_t{key_.size.width} * key_.size.height * rays * rays;
    complete_ = !(rays <= 4 && rays * rays <= subframes && all <= kRayLimit);
    complete_for_ = subframes;
    if (!complete_) request(rays);
}

GlDepth Picture::depth() const {
    if (!target_ || summed_ == 0) return {};
    return {&*target_, summed_};
}

DepthImage Picture::read() const {
    DepthImage image(target_->width(), target_->height());
    image.depth = target_->read_floats();
    const auto share = static_cast<float>(1 / depth().subframes);
    for (float& t : image.depth) t *= share;
    return image;
}

}  // namespace vog::viewer
