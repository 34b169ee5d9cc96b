// session_actions.cpp: named views, options for the clipboard, and files written by the session.
#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <numbers>

#include "session/session.h"
#include "vog/error.h"

namespace vog::viewer {

namespace fs = std::filesystem;

void Session::open_json(const std::string& file) {
    try {
        load_map(look, file);
        look_changed();
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
    camera = named_view(camera, name, scene.box, aspect(), first_camera(scene.box).up);
}

void Session::fit() { camera = fitted(camera, scene.box, aspect()); }

void Session::set_orthographic(bool orthographic) {
    camera = with_projection(camera, orthographic, aspect());
}

void Session::reset_view() { camera = first_camera(scene.box); }

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

void Session::copy_flags() {
    std::string file;
    if (!is_plain(look)) file = "LOOK.json";
    const std::string flags = camera_flags(camera) + " " + look_flags(look, file);
    ImGui::SetClipboardText(flags.c_str());
    show_message(file.empty() ? "copied: " + flags
                              : "copied; save the colours as LOOK.json: " + flags);
}

Image Session::picture_image() {
    if (!left_.depth().target) throw Error("there is no picture yet");
    const PixelSize size = left_.size();
    const GlTarget target(GL_RGBA8, size.width, size.height);
    target.bind();
    shade_into({0, 0, size.width, size.height}, false);
    return read_picture(size.width, size.height);
}

void Session::save_picture(const fs::path& file) {
    write_png(file, picture_image());
    show_message("wrote " + file.string());
}

void Session::save_depth(const fs::path& file) {
    if (!left_.depth().target) throw Error("there is no picture yet");
    DepthImage depth = left_.read();
    set_extinction(depth, look.extinction);
    write_exr(file, depth);
    show_message("wrote " + file.string());
}

void Session::save_look(const fs::path& file) {
    write_transfer_function(file, transfer_function(look));
    show_message("wrote " + file.string());
}

void Session::start_turntable(const fs::path& folder, int frames) {
    if (frames < 1 || frames > 9999)
        throw Error(fmt::format("turntable: {} pictures, expected 1 to 9999", frames));
    std::error_code code;
    fs::create_directories(folder, code);
    if (!fs::is_directory(folder))
        throw Error(fmt::format("{}: cannot create this folder", folder.string()));
    turntable_ = Turntable{folder, camera, frames, 0};
}

void Session::advance_turntable() {
    if (!turntable_) return;
    Turntable& t = *turntable_;
    // About the up axis of the first view, not of the screen: the data stay upright.
    const auto at = [&](int frame) {
        return turned_about(t.start, first_camera(scene.box).up,
                            2 * std::numbers::pi * frame / t.frames);
    };
    const bool complete = left_.complete() && (!needs_right() || right_.complete());
    if (complete && t.next > 0) {
        try {
            write_png(t.folder / fmt::format("{:04}.png", t.next), picture_image());
        } catch (const Error&) {
            turntable_.reset();
            throw;
        }
        show_message(fmt::format("turntable: {} of {}", t.next, t.frames));
        if (t.next == t.frames) {
            camera = t.start;
            show_message(fmt::format("wrote {} pictures to {}", t.frames, t.folder.string()));
            turntable_.reset();
            return;
        }
    }
    if (complete || t.next == 0) camera = at(t.next++);
}

}  // namespace vog::viewer
