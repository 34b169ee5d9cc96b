// panels.h: user interface beside and over the picture, by Dear ImGui.
#pragma once

#include <functional>
#include <map>
#include <string>

#include "session/session.h"
#include "ui/input.h"
#include "ui/recent_files.h"

namespace vog::viewer {

/// Rectangles of the window, in ImGui's coordinates.
struct Layout {
    Rect picture, panel, status;
    Rect play;     ///< bar of steps in time; empty: none
    float ui = 1;  ///< scale of text and controls
};
/// Layout of a window of this size; without panels the picture fills it.
/// steps  whether there is a bar of steps in time
Layout layout_of(float width, float height, float ui, bool panels, bool steps = false);

/// State of the panels between frames.
struct Gui {
    std::map<std::string, Rect> widgets;  ///< latest rectangles, by the names of scripts
    std::string open_path, look_path = "look.json", camera_path = "camera.json";
    std::string turntable_path = "turntable";
    int turntable_frames = 120;
    bool turntable_in_time = false;  ///< steps in time run once during the turn
    RecentFiles recent{{}};          ///< nothing is kept under a script
    int dragged_point = -1;          ///< index of the dragged opacity point; -1: none
    PointRange
        dragged_band{};  ///< of the transfer function of values, where dragged_point is one of several
    bool log_values = false;  ///< logarithmic axis of the editor of values
    double fps = 0;           ///< frames per second, smoothed
};

/// light  dark text on light panels
void set_style(float ui, bool light);
/// Draws panel, status line, figures, colour bar, split labels and help. Errors of the user's
/// actions become the session's message.
void draw_panels(Session& session, Gui& gui, const Layout& layout, Requests& requests);

/// Draws the quantity section: quantity, field, scale, light, clip box.
void draw_quantity(Session& session, Gui& gui);
/// Draws the colour section: map, opacity over the histogram, range, gamma, extinction.
void draw_look(Session& session, Gui& gui, float ui);
/// Draws the list of layers, each with an eye, and its map, range, bands or plane.
void draw_layers(Session& session, Gui& gui);
/// Draws the editor of the transfer function of values.
void draw_values(Session& session, Gui& gui, float ui);
/// Window and level of the shown quantity: its transfer function of values, or its scale.
/// right, up  of a drag, shares of the picture's size: wider, higher
void window_by_drag(Session& session, double right, double up);
/// Draws the colours along a strip.
/// color  of a share of its width, [0, 1]
void draw_strip(float x, float y, float width, float height,
                const std::function<Rgba(float share)>& color);
/// Selector of the background.
/// returns  whether it changed
bool edit_background(Look& look);
/// Selector of a named map.
/// returns  the chosen one; empty: none
std::string choose_map(const std::string& shown, Gui& gui);
/// Draws the bar of steps in time.
void draw_play_bar(Session& session, Gui& gui, const Layout& layout);
/// Draws figures, colour bar, split labels and help over the picture.
void draw_overlays(Session& session, Gui& gui, const Layout& layout);

/// Names ImGui's latest item for scripts.
void mark(Gui& gui, const std::string& name);
/// Runs an action of the user; an error becomes the session's message.
template <class Action>
void attempt(Session& session, const Action& action) {
    try {
        action();
    } catch (const std::exception& error) {
        session.show_error(error.what());
    }
}

}  // namespace vog::viewer
