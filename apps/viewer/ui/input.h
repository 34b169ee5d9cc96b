// input.h: what the mouse and the keys do.
#pragma once

#include <span>
#include <string>

#include "session/session.h"

namespace vog::viewer {

/// In ImGui's coordinates.
struct Rect {
    float x = 0, y = 0, width = 0, height = 0;
    bool holds(float px, float py) const {
        return px >= x && px < x + width && py >= y && py < y + height;
    }
};

/// What a drag that began in the picture does until the button is let go.
struct Hand {
    enum class Grip { none, rotate, pan, zoom, look, roll, split } grip = Grip::none;
    ScreenPoint last;
};

/// Things that only the program around the session can do.
struct Wishes {
    bool quit = false;
    bool screenshot = false;  ///< of the whole window
    bool picture = false, depth = false;
};

/// Moves the camera and the settings as ImGui's input says, where no panel wants it.
void apply_input(Session& session, Hand& hand, const Rect& picture, Wishes& wishes);

struct KeyHelp {
    const char* keys;
    const char* what;
};
/// Every key and button, for the help panel.
std::span<const KeyHelp> key_help();
/// GLFW's number of a key: "a", "7", "f1", "space", "left", "[". throws vog::Error
int key_number(const std::string& name);

}  // namespace vog::viewer
