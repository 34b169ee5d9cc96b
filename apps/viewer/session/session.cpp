// session.cpp: one frame of the session: new data, level of detail, pictures, histogram and
// exposure.
#include "session/session.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "vog/error.h"
#include "vog/exposure.h"
#include "vog/periodic.h"

namespace vog::viewer {

namespace {

/// The camera counts as moving for this long after its last change.
constexpr double kSettleS = 0.2;
constexpr double kSlowFrameMs = 45, kQuickFrameMs = 20;
constexpr double kMovingErrorLimit_px = 16;  ///< shapes are still recognisable

/// Fraction of the pixels with T > 0 by V, in 128 equal bins.
std::vector<float> histogram_of(const std::vector<float>& column, double extinction) {
    constexpr std::size_t kBins = 128;
    std::vector<float> share(kBins);
    std::size_t covered = 0;
    for (const float t : column) {
        if (!(t > 0)) continue;
        const double v = -std::expm1(-double{t} * extinction);
        ++share[std::min(static_cast<std::size_t>(v * kBins), kBins - 1)];
        ++covered;
    }
    if (covered)
        for (float& each : share) each /= static_cast<float>(covered);
    return share;
}

}  // namespace

double steady_clock_s() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

Session::Session(ReadFiles read, std::function<double()> clock_s)
    : loader_(read), read_(std::move(read)), clock_s_(std::move(clock_s)) {}

void Session::open(const std::vector<std::string>& files) {
    if (files.front().ends_with(".json")) return open_json(files.front());
    steps_.reset();
    play(false);
    loader_.open(files);
    opened_files = files;
    opening_ = true;
    // The loader's status is read with each frame, so that an error is shown once.
    loading = {true, {}, 0, {}};
}

void Session::show_message(const std::string& text) {
    message = text;
    failed = false;
}
void Session::show_error(const std::string& text) {
    message = text;
    failed = true;
}

double Session::aspect() const {
    return shown_.height > 0 ? static_cast<double>(shown_.width) / shown_.height : 1;
}

double Session::radius() const {
    const double radius = scene.subject.box.empty() ? 1 : scene.subject.box.radius();
    return radius > 0 ? radius : 1;
}

void Session::update_scene() {
    loading = loader_.status();
    if (!loading.error.empty()) {
        show_error(loading.error);
        opening_ = false;
    }
    const int opened = scene.opened;
    const Level* selected = settings.level < 0 ? nullptr : level_at(settings.level);
    const std::shared_ptr<const Gaussians> model = selected ? selected->model : nullptr;
    const bool first_level = scene.levels.empty();
    if (!loader_.take(scene)) return;
    // A periodic model is shown inside its box, unless a clip was stated.
    if ((first_level || scene.opened != opened) && !scene.levels.empty() &&
        quantity.look.clip.empty())
        quantity.look.clip.box = periodic_box(*scene.levels.front().model);
    if (scene.opened == opened) {
        // New levels are inserted between the others: the selected one stays selected.
        for (std::size_t n = 0; model && n < scene.levels.size(); ++n)
            if (scene.levels[n].model == model) settings.level = static_cast<int>(n);
        return;
    }
    // Other files: initial view and settings.
    opening_ = false;
    gl_.models.clear();
    values_of_.clear();
    site_model_.reset();
    site_of_.reset();
    site_pending_ = 0;
    site_fault_.clear();
    settings.level = -1;
    moving_error_ = 0;
    if (opened > 0) layered_ = {};
    camera = first_camera(layered_.scene ? layered_.scene->subject : scene.subject);
    set_shadows(quantity.look.shadows);
    if (opened > 0) exposure_open_ = true;
    if (!scene.voxels && settings.other == WindowRenderer::voxels)
        settings.other = WindowRenderer::splat;
    if (scene.voxels && opened == 0) settings.other = WindowRenderer::voxels;
    show_message(scene.title);
}

const Level* Session::level_at(int level) const {
    if (scene.levels.empty()) return nullptr;
    const int last = static_cast<int>(scene.levels.size()) - 1;
    return &scene.levels[static_cast<std::size_t>(level < 0 ? last : std::min(level, last))];
}

void Session::update_moving_error() {
    const bool changed = camera != last_camera_;
    last_camera_ = camera;
    const double now = clock_s_();
    if (changed) last_change_s_ = now;
    moving_ = settings.coarse_moving && !recording_ && now - last_change_s_ < kSettleS;
    if (!moving_ || !changed || scene.levels.empty()) return;
    // Twice the error (about an eighth of the Gaussians) after a slow frame, half of it after a
    // fast one.
    if (measured.frame_ms > kSlowFrameMs)
        moving_error_ = std::clamp(2 * moving_error_, 2.0, kMovingErrorLimit_px);
    else if (measured.frame_ms < kQuickFrameMs)
        moving_error_ = moving_error_ > 2 ? 0.5 * moving_error_ : 0;
}

double Session::ms_per_ray(WindowRenderer renderer) const {
    return shows_layers() || settings.renderer == renderer ? left_.ms_per_ray()
                                                           : right_.ms_per_ray();
}

PictureKey Session::key(WindowRenderer renderer) const {
    const Level* level = shown_level();
    PictureKey key;
    if (shows_layers()) renderer = WindowRenderer::splat;
    key.renderer = renderer;
    if (shows_layers())
        key.layered = layered_.scene, key.layers = layer_changes_;
    else if (renderer == WindowRenderer::voxels)
        key.voxels = scene.voxels;
    else
        key.model = level->site && site_model_ ? site_model_ : level->model;
    PictureRequest request;
    request.show = quantity.show;
    request.look = quantity.look;
    request.slabs = quantity.slabs;
    request.options.clip = quantity.look.clip;
    request.camera = camera;
    if (key.model && (renderer == WindowRenderer::gl || renderer == WindowRenderer::splat)) {
        key.hierarchy = level->hierarchy;
        request.options.pixel_error = pixel_error();
    }
    double pixels = settings.scale;
    // Slow renderers use a sixteenth of the rays while the camera moves.
    const double rays = pixels * pixels * shown_.width * shown_.height;
    if (moving_ && renderer != WindowRenderer::gl && rays * ms_per_ray(renderer) > kSlowFrameMs)
        pixels *= 0.25;
    request.width = std::max(1, static_cast<int>(std::lround(shown_.width * pixels)));
    request.height = std::max(1, static_cast<int>(std::lround(shown_.height * pixels)));
    key.picture = key.layered ? layered_picture(request)
                              : sums_of(std::move(request), quantity.field, values.now().get());
    return key;
}

double Session::pixel_error() const {
    const double chosen = double{settings.pixel_error};
    return moving_ ? std::max(chosen, moving_error_) : chosen;
}

/// Takes the Gaussians of a site that the view needs and that have been read.
void Session::update_site() {
    const Level* level = shown_level();
    if (!level->site) return;
    SiteCut& site = *level->site;
    const double pixels = settings.scale;
    const auto side = [&](int shown) {
        return std::max(1, static_cast<int>(std::lround(shown * pixels)));
    };
    const Gaussians& chosen = site.choose_available(
        frame_of(camera, side(shown_.width), side(shown_.height)), {pixel_error(), true}, {});
    site_pending_ = site.report().pending;
    if (const std::string fault = site.fault(); fault != site_fault_) {
        site_fault_ = fault;
        show_error(fault + "; coarser parts stand in");
    }
    if (site_model_ && site_of_ == level->site && site.report().revision == site_revision_) return;
    site_of_ = level->site;
    site_revision_ = site.report().revision;
    site_model_ = std::make_shared<const Gaussians>(chosen);
    gl_.models.clear();
}

bool Session::needs_right() const { return settings.split_on || settings.difference; }

void Session::update(PixelSize shown) {
    shown_ = shown;
    if (steps_)
        update_steps();
    else
        update_scene();
    if (scene.levels.empty()) return;
    if (!scene.voxels) {  // a model has no voxels to render
        if (settings.renderer == WindowRenderer::voxels) settings.renderer = WindowRenderer::gl;
        if (settings.other == WindowRenderer::voxels) settings.other = WindowRenderer::splat;
    }
    update_moving_error();
    update_site();
    update_quantity();
    const int subframes = moving_ ? 1 : std::max(1, settings.subframes);
    left_.update(key(settings.renderer), subframes, gl_);
    if (needs_right()) right_.update(key(settings.other), subframes, gl_);
    for (ProgressivePicture* picture : {&left_, &right_})
        if (const std::string error = picture->take_error(); !error.empty()) show_error(error);
    inspect();
    advance_recording();
}

bool Session::at_first_view() const { return camera == first_camera(scene.subject); }

bool Session::drawing() const {
    if (scene.levels.empty()) return false;
    const bool left = settings.renderer == WindowRenderer::gl && !left_.complete();
    const bool right = needs_right() && settings.other == WindowRenderer::gl && !right_.complete();
    return moving_ || left || right || site_pending_ > 0;
}

bool Session::at_rest() const {
    return !loading.busy && !moving_ && !recording_ && !playing_ && site_pending_ == 0 &&
           (!steps_ || shown_step_ == step_) &&
           (scene.levels.empty() || (left_.complete() && (!needs_right() || right_.complete())));
}

void Session::inspect() {
    if (!left_.has_sums()) return;
    // Reading back waits for the device, so only the first picture of a kind and complete ones are read.
    const bool first = inspected_revision_ < 0 || !same_kind(left_.picture(), inspected_picture_);
    if (!first && !(left_.complete() && !moving_ && left_.revision() != inspected_revision_))
        return;
    inspected_ = numbers();
    inspected_picture_ = left_.picture();
    inspected_revision_ = left_.revision();
    most_column_ = largest_column(inspected_);
    if (has_depth()) inspect_visibility();
    if (has_scale(quantity.show) && scale_open_) {
        scale = fitted_scale_of(inspected_, quantity.show, first_fit);
        scale_open_ = !(loaded() && left_.complete());
    }
}

void Session::inspect_visibility() {
    if (exposure_open_ || settings.follow_exposure) {
        look.extinction = automatic_extinction = picture_extinction(depth_of(inspected_));
        shade_.set_look(look);
        // Ends when the view is left, or when all levels are there.
        exposure_open_ = exposure_open_ && at_first_view() && !(loaded() && left_.complete());
    }
    histogram = histogram_of(inspected_.column, look.extinction);
}

Sums Session::numbers() const { return numbers_of(left_.read(), left_.picture(), field_unit()); }

/// Whether the inspected numbers are T or a column.
bool Session::has_depth() const {
    return inspected_revision_ >= 0 && is_depth(inspected_picture_.request.show);
}

void Session::look_changed() {
    shade_.set_look(look);
    if (look.extinction != automatic_extinction) exposure_open_ = false;
    if (has_depth()) histogram = histogram_of(inspected_.column, look.extinction);
}

void Session::auto_exposure() {
    if (!left_.has_sums() || !is_depth(left_.picture().request.show)) return;
    inspected_ = numbers();
    look.extinction = automatic_extinction = picture_extinction(depth_of(inspected_));
    look_changed();
}

void Session::set_first_exposure(double extinction) {
    look.extinction = automatic_extinction = extinction;
    exposure_open_ = false;
    look_changed();
}

void Session::shade_into(const Viewport& to, bool checker) const {
    const GlDepth a = left_.depth();
    const GlDepth b = needs_right() && right_.has_sums() ? right_.depth() : a;
    ShadeView view = shade_view();
    view.split = settings.split_on ? settings.split : 1.0f;
    view.difference = settings.difference;
    view.difference_limit = settings.difference_limit;
    view.checker = checker;
    shade_.draw(a, b, view, to);
}

void Session::draw(const Viewport& to) {
    if (!left_.has_sums()) return;
    shade_timer_.begin();
    shade_into(to, true);
    shade_timer_.end();
    measured.shade_ms = shade_timer_.ms();
}

}  // namespace vog::viewer
