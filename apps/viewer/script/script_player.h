// script_player.h: plays a script through the same input as a hand's.
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

/// What an action may ask of the program around the session.
struct Stage {
    Session& session;
    Gui& gui;
    Screen& screen;
    Rect picture;  ///< as last laid out
};

class ScriptPlayer {
  public:
    explicit ScriptPlayer(const std::filesystem::path& file);

    /// Sets the mouse and the keys as the action under way wants them, after the screen has.
    void feed(ImGuiIO& io);
    /// Goes on with the next actions, up to one that needs time. Before a frame is laid out.
    void play(Stage& stage);
    /// Writes what the actions asked for, of the frame that is in the framebuffer now.
    void after_frame(const Stage& stage);
    bool ended() const { return next_ == actions_.size() && input_.empty() && screenshot_.empty(); }

  private:
    /// Mouse and keys for one frame.
    struct Input {
        float x = 0, y = 0, wheel = 0;
        int button = -1, key = -1;
        bool shift = false, ctrl = false, alt = false;
    };
    void start(const Action& action, Stage& stage);
    bool start_input(const Action& action, Stage& stage);
    bool start_camera(const Action& action, Stage& stage);
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
    int frames_ = 0;  ///< since the action started
    std::deque<Input> input_;
    Input pointer_;
    std::string screenshot_;
};

}  // namespace vog::viewer
