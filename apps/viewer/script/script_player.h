// script_player.h: runs a script through the same input path as mouse and keyboard.
#pragma once

#include <deque>
#include <filesystem>
#include <string>
#include <vector>

#include "script/script.h"
#include "session/session.h"
#include "ui/panels.h"

struct ImGuiIO;

namespace vog::viewer {

/// Parts of the program that actions use.
struct Stage {
    Session& session;
    Gui& gui;
    Screen& screen;
    Rect picture;  ///< rectangle of the picture in the latest layout
};

/// Runs the actions of a script, frame by frame.
class ScriptPlayer {
  public:
    explicit ScriptPlayer(const std::filesystem::path& file);

    /// Sets mouse and keys of the current action in `io`; called after Screen::begin_frame.
    void feed(ImGuiIO& io);
    /// Runs the next actions, up to one that needs further frames; called before a frame's layout.
    /// throws vog::Error with the line of the action
    void play(Stage& stage);
    /// Writes a requested screenshot of the frame in the framebuffer.
    void after_frame(const Stage& stage);
    bool ended() const { return next_ == actions_.size() && input_.empty() && screenshot_.empty(); }

  private:
    /// State of mouse and keys in one frame.
    struct Input {
        float x = -1, y = -1, wheel = 0;  ///< at first outside the window
        int button = -1, key = -1;
        bool shift = false, ctrl = false, alt = false;
    };
    void start(const Action& action, Stage& stage);
    bool start_input(const Action& action, Stage& stage);
    bool start_camera(const Action& action, Stage& stage);
    bool start_quantity(const Action& action, Stage& stage);
    bool start_look(const Action& action, Stage& stage);
    bool start_file(const Action& action, Stage& stage);
    bool waits(const Action& action, Stage& stage);
    void drag(int button, Input at, float x1, float y1);
    void press(Input input);

    std::string name_;
    std::vector<Action> actions_;
    std::size_t next_ = 0;
    bool started_ = false;
    double started_s_ = 0;
    int frames_ = 0;  ///< since the current action started
    std::deque<Input> input_;
    Input pointer_;
    std::string screenshot_;
};

}  // namespace vog::viewer
