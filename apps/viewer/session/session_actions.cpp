// session_actions.cpp: named views, requests for the clipboard, and files written by the session.
#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <numbers>

#include "quantity/probe.h"
#include "quantity/shown_request.h"
#include "session/session.h"
#include "vog/error.h"
#include "vog/picture_record.h"

namespace vog::viewer {

namespace fs = std::filesystem;

void Session::open_json(const std::string& file) {
    try {
        set_map(file);
    } catch (const Error& no_look) {
        try {
            camera = read_camera(file);
        } catch (const Error& no_camera) {
            throw Error(fmt::format("neither a transfer function ({}) nor a camera ({})",
                                    no_look.what(), no_camera.what()));
        }
    }
    show_message("opened " + file);
}

void Session::set_view(const std::string& name) {
    camera = named_view(camera, name, scene.subject, aspect(), up());
}

Vec3d Session::up() const { return up_.value_or(first_camera(scene.subject).up); }

void Session::set_z_up(bool z_up) {
    up_ = z_up ? Vec3d{0, 0, 1} : Vec3d{0, 1, 0};
    camera.up = *up_;
    // The up axis must not be that of the view.
    const Vec3d ahead = camera.look_at - camera.eye;
    if (length(cross(ahead, camera.up)) < 1e-3 * length(ahead)) set_view(z_up ? "+x" : "+z");
}

void Session::fit() { camera = fitted(camera, scene.subject, aspect()); }

void Session::set_orthographic(bool orthographic) {
    camera = with_projection(camera, orthographic, aspect());
}

void Session::reset_view() { camera = first_camera(scene.subject); }

int Session::level_index(const std::string& name) const {
    const int count = static_cast<int>(scene.levels.size());
    if (name == "finest") return -1;
    if (name == "coarsest") return 0;
    std::string names;
    for (int n = 0; n < count; ++n) {
        const std::string& level = scene.levels[static_cast<std::size_t>(n)].name;
        if (name == std::to_string(n + 1) || level.starts_with(name)) return n;
        names += (n ? ", " : "") + level;
    }
    throw Error(fmt::format("no level '{}' (there are: {}; or 1 to {}, coarsest, finest)", name,
                            names, count));
}

std::string Session::record() const {
    const PixelSize size = left_.size();
    PictureRequest request =
        request_of(quantity, look, camera, scale, values.now().get(), size.width, size.height);
    if (!shows_layers()) return record_json({std::move(request), opened_files});
    request.field.clear(), request.transfer = {}, request.layers = layered_.layers;
    return record_json({std::move(request), layered_.inputs});
}

void Session::copy_request() {
    std::string text = record();
    for (std::size_t at = 0; (at = text.find('\'', at)) != std::string::npos; at += 4)
        text.replace(at, 1, "'\\''");  // of shells
    ImGui::SetClipboardText(("--request '" + text + "'").c_str());
    show_message("copied for vog render: the request of this picture");
}

Image Session::picture_image() {
    if (!left_.has_sums()) throw Error("there is no picture yet");
    const PixelSize size = left_.size();
    const GlTarget target(GL_RGBA8, size.width, size.height);
    target.bind();
    shade_into({0, 0, size.width, size.height}, false);
    return read_picture(size.width, size.height);
}

void Session::save_picture(const fs::path& file) {
    write_png(file, picture_image(), record());
    show_message("wrote " + file.string());
}

void Session::save_depth(const fs::path& file) {
    if (!left_.has_sums()) throw Error("there is no picture yet");
    Picture picture;
    picture.made = left_.picture();
    picture.sums = numbers();
    Sums& sums = picture.sums;
    const Show show = picture.made.request.show;
    if (is_depth(show)) {
        DepthImage depth = depth_of(sums);
        set_extinction(depth, look.extinction);
        write_exr(file, depth, record());
    } else if (show == Show::volume) {
        write_exr(file, over(sums.light, sums.width, sums.height, Rgba{0, 0, 0, 0}), record());
    } else if (picture.made.field.part == FieldPart::magnitude) {
        const NamedValues channels[] = {{"column", sums.column}, {"rms", sums.mean}};
        write_channels(file, sums.width, sums.height, channels, record());
    } else {
        write_numbers(file, picture, record());
    }
    show_message("wrote " + file.string());
}

void Session::save_look(const fs::path& file) {
    if (quantity.show == Show::volume && values.now())
        write_value_transfer(file, *values.now());
    else
        write_transfer_function(
            file, has_scale(quantity.show) ? map_function(look) : transfer_function(look));
    show_message("wrote " + file.string());
}

void Session::start_turntable(const fs::path& output, int frames, bool in_time) {
    if (frames < 1 || frames > 9999)
        throw Error(fmt::format("turntable: {} pictures, expected 1 to 9999", frames));
    if (in_time && !steps_) throw Error("no steps in time are open: vog view --steps");
    Recording recording;
    recording.output = output;
    recording.turns = true;
    recording.of_time = in_time;
    recording.frames = frames;
    start_recording(std::move(recording));
}

void Session::start_time_export(const fs::path& output) {
    if (!steps_) throw Error("no steps in time are open: vog view --steps");
    Recording recording;
    recording.output = output;
    recording.of_time = true;
    recording.frames = static_cast<int>(step_count());
    start_recording(std::move(recording));
}

void Session::start_recording(Recording recording) {
    play(false);
    recording.camera = camera;
    recording.step = step_;
    const std::string extension = recording.output.extension().string();
    if (extension == ".mp4" || extension == ".webm") {
        if (!open_film) throw Error("this window makes no films; choose a folder");
        const double per_second = recording.turns ? 30 : settings.steps_per_second;
        recording.film = open_film(recording.output.string(), per_second);
    } else {
        std::error_code code;
        fs::create_directories(recording.output, code);
        if (!fs::is_directory(recording.output))
            throw Error(fmt::format("{}: cannot create this folder", recording.output.string()));
    }
    recording_ = std::move(recording);
}

void Session::advance_recording() {
    if (!recording_) return;
    Recording& r = *recording_;
    const bool complete = left_.complete() && (!needs_right() || right_.complete()) &&
                          (!steps_ || shown_step_ == step_) && site_pending_ == 0;
    if (complete && r.next > 0) {
        try {
            if (r.film)
                r.film->add(picture_image());
            else
                write_png(r.output / fmt::format("{:04}.png", r.next), picture_image(), record());
            if (r.next == r.frames && r.film) r.film->finish();
        } catch (const Error&) {
            recording_.reset();
            throw;
        }
        show_message(
            fmt::format("{}: {} of {}", r.turns ? "turntable" : "steps", r.next, r.frames));
        if (r.next == r.frames) {
            camera = r.camera;
            if (steps_) set_step(r.step);
            show_message(fmt::format("wrote {} pictures to {}", r.frames, r.output.string()));
            recording_.reset();
            return;
        }
    }
    if (!complete && r.next > 0) return;
    // About the up axis of the data, not of the screen: they stay upright.
    if (r.of_time)
        set_step(static_cast<std::size_t>(r.next) * step_count() /
                 static_cast<std::size_t>(r.frames));
    if (r.turns) camera = turned_about(r.camera, up(), 2 * std::numbers::pi * r.next / r.frames);
    ++r.next;
}

}  // namespace vog::viewer
