// panels.h: everything that is drawn over and beside the picture with Dear ImGui.
#pragma once

#include <map>
#include <string>

#include "session/session.h"
#include "ui/input.h"

namespace vog::viewer {

struct Layout {
    Rect picture, panel, status;
    float ui = 1;  ///< size of text and controls
};
/// Without panels the picture has the whole window.
Layout layout_of(float width, float height, float ui, bool panels);

/// What the panels remember between frames.
struct Gui {
    std::map<std::string, Rect> widgets;  ///< by the names that scripts use, as last laid out
    std::string open_path, look_path = "look.json", camera_path = "camera.json";
    std::string turntable_path = "turntable";
    int turntable_frames = 120;
    int dragged_point = -1;  ///< opacity point under the pointer
    double fps = 0;          ///< smoothed
};

void set_style(float ui);
/// Panel, status line, figures, colour bar, split labels and help. Failures of what the user asks
/// for become the session's message.
void draw_panels(Session& session, Gui& gui, const Layout& layout, Wishes& wishes);

/// The colour section of the panel: map, opacity over the histogram, range, gamma, exposure.
void draw_look(Session& session, Gui& gui, float ui);
/// What lies over the picture.
void draw_overlays(Session& session, Gui& gui, const Layout& layout);

/// Lets scripts find the item that was just laid out.
void mark(Gui& gui, const std::string& name);
/// Runs what the user asked for; a failure becomes the session's message.
template <class Action>
void attempt(Session& session, const Action& action) {
    try {
        action();
    } catch (const std::exception& error) {
        session.fail(error.what());
    }
}

}  // namespace vog::viewer
