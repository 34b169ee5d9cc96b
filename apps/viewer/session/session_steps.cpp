// session_steps.cpp: steps in time: the one shown, and playing.
#include <fmt/core.h>

#include <filesystem>

#include "session/session.h"
#include "vog/error.h"

namespace vog::viewer {

void Session::open_steps(std::vector<std::string> files) {
    steps_ = std::make_unique<Steps>(std::move(files), read_);
    step_ = 0;
    shown_step_.reset();
    opening_ = true;
    loading = {true, "reading " + steps_->file(0), 0, {}};
}

void Session::set_step(std::size_t step) {
    if (step >= step_count())
        throw Error(fmt::format("no step {}, expected 1 to {}", step + 1, step_count()));
    step_ = step;
    steps_->want(step);
}

void Session::play(bool on) {
    playing_ = on && step_count() > 1;
    last_step_s_ = clock_s_();
    // From the beginning, where the last step has been reached.
    if (playing_ && !settings.loop && step_ + 1 == step_count()) set_step(0);
}

void Session::update_steps() {
    loading = {};
    // The next step is due, and here.
    const std::size_t next = (step_ + 1) % step_count();
    const bool shown = shown_step_ == step_ && left_.has_sums();
    if (playing_ && shown && clock_s_() - last_step_s_ >= 1 / settings.steps_per_second) {
        if (next == 0 && !settings.loop) {
            playing_ = false;
        } else if (steps_->get(next)) {
            last_step_s_ = clock_s_();
            set_step(next);
        }
    }
    if (shown_step_ == step_) return;
    std::shared_ptr<const Level> level;
    try {
        level = steps_->get(step_);
    } catch (const Error& error) {
        playing_ = false;
        loading.error = error.what();
        show_error(error.what());
        opening_ = false;
        if (shown_step_) step_ = *shown_step_;
        // Without the step, the picture of another would be saved in its place.
        if (recording_) {
            camera = recording_->camera;
            recording_.reset();
        }
        return;
    }
    if (!level) {
        loading = {true, "reading " + steps_->file(step_), 0, {}};
        return;
    }
    const bool first = !shown_step_.has_value();
    shown_step_ = step_;
    gl_.models.clear();
    scene.levels = {*level};
    scene.voxels = nullptr;
    scene.title = std::filesystem::path(steps_->file(step_)).filename().string();
    scene.facts = fmt::format("step {} of {}", step_ + 1, step_count());
    settings.level = -1;
    if (!first) return;
    // The first step sets view, extinction and ranges of all.
    opening_ = false;
    ++scene.opened;
    scene.subject = subject_of(*level->model);
    values_of_.clear();
    camera = first_camera(scene.subject);
    show_message(scene.title);
}

}  // namespace vog::viewer
