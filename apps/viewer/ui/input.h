// input.h: mouse and keyboard controls.
#pragma once

#include <span>
#include <string>

#include "session/session.h"

namespace vog::viewer {

/// Rectangle in ImGui's coordinates.
struct Rect {
    float x = 0, y = 0, width = 0, height = 0;
    bool holds(float px, float py) const {
        return px >= x && px < x + width && py >= y && py < y + height;
    }
};

/// Face of a box, its axis, 0 to 2, and whether it is the upper one; or a layer's slice.
struct Face {
    int axis = 0;
    bool upper = false;
    int slice = -1;  ///< layer; -1: a face of the clip box
};

/// Drag that began in the picture, until the button is released.
struct Drag {
    enum class Grip { none, rotate, pan, zoom, window, look, roll, split, clip, light };
    Grip grip = Grip::none;
    ScreenPoint last;
    Face face{};  ///< that is dragged
};

/// Requests to the program around the session.
struct Requests {
    bool quit = false;
    bool screenshot = false;  ///< of the whole window
    bool picture = false, depth = false;
    bool full_screen = false;  ///< to and fro
};

/// Applies ImGui's input to camera and settings, unless a panel uses it.
void apply_input(Session& session, Drag& state, const Rect& picture, Requests& requests);

/// Keys or buttons, and their effect.
struct KeyHelp {
    const char* keys;
    const char* effect;
};
/// All controls, for the help panel.
std::span<const KeyHelp> key_help();
/// GLFW's number of a key by name: "a", "7", "f1", "space", "left", "[". throws vog::Error for an
/// unknown name
int key_number(const std::string& name);

}  // namespace vog::viewer
