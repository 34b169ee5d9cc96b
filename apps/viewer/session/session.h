// session.h: the state of the window and everything that can be done to it: what the panels, the
// keys and scripts all call.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "session/look.h"
#include "session/picture.h"
#include "session/scene_loader.h"
#include "ui/trackball.h"

namespace vog::viewer {

struct Settings {
    Renderer renderer = Renderer::gl, other = Renderer::voxels;  ///< left and right of the split
    bool split_on = false, difference = false;
    float split = 0.5f;
    float difference_limit = 0.02f;  ///< of V
    int level = -1;                  ///< of the scene; -1: the finest there is
    bool coarse_moving = true;       ///< larger parts while the camera moves and frames are slow
    float pixel_error = 1;           ///< parts smaller than this are drawn as one; 0: never
    double scale = 1;                ///< pixels rendered per pixel shown
    int subframes = 64;
    bool follow_exposure = false;  ///< auto exposure whenever the picture is complete
    bool panels = true, overlay = true, help = false, color_bar = true;
};

struct Measured {
    double frame_ms = 0, shade_ms = 0, gui_ms = 0;
};

class Session {
  public:
    /// With a current OpenGL context, which must outlive it.
    explicit Session(ReadFiles read);

    // What may be changed at will between frames.
    Settings settings;
    Camera camera;
    Look look;  ///< changes take effect with look_changed()
    std::function<Camera(const Box&)> first_camera = paper_view;  ///< of every set of files
    // What is shown.
    Measured measured;
    Scene scene;
    std::vector<float> histogram;     ///< shares of the pixels with T > 0 by V
    double automatic_extinction = 1;  ///< as auto_exposure() last found it
    std::string message;              ///< the latest thing done, or what failed
    bool failed = false;              ///< the message is of a failure

    /// Data, or a JSON file that is a look or a camera. throws vog::Error if that is neither
    void open(const std::vector<std::string>& files);
    void say(const std::string& text);
    void fail(const std::string& text);

    void look_changed();
    void auto_exposure();
    void set_view(const std::string& name);
    void fit();
    /// The camera files are opened with.
    void reset_view();
    /// At the first picture, instead of the automatic one.
    void set_first_exposure(double extinction);
    /// Index of a level by "finest", "coarsest", its number from 1, or the start of its name.
    /// throws vog::Error listing them
    int level_index(const std::string& name) const;
    void copy_flags();

    /// The picture as it is shown, split or difference included; at the size it is rendered.
    Image picture_image();
    void save_picture(const std::filesystem::path& file);
    void save_depth(const std::filesystem::path& file);
    void save_look(const std::filesystem::path& file);
    /// Frames around the up axis of the first view, as 0001.png and so on in `folder`.
    void start_turntable(const std::filesystem::path& folder, int frames);
    bool turning() const { return turntable_.has_value(); }

    /// Moves what is under way on by a frame, for a picture shown at this many pixels.
    void update(PixelSize shown);
    /// Shades into the framebuffer that is bound.
    void draw(const Viewport& to);
    /// Nothing would change if nobody touched anything.
    bool at_rest() const;
    /// Every frame brings the picture on.
    bool drawing() const;
    /// Nothing is being read, converted or measured.
    bool loaded() const { return !loading.busy; }
    /// Files have been asked for and nothing of them is shown yet.
    bool opening() const { return opening_; }
    SceneLoader::Status loading;

    const Picture& left() const { return left_; }
    const Picture& right() const { return right_; }
    /// The level that is drawn now; null: none yet.
    const Level* shown_level() const { return level_at(settings.level); }
    /// Of the scene; -1: the finest; null where there is none.
    const Level* level_at(int level) const;
    bool moving() const { return moving_; }
    double aspect() const;
    /// Of the data's box; 1 where it has no extent.
    double radius() const;
    /// Nearer to what it looks at, the camera pushes that ahead: it must get through the volume.
    double least_distance() const { return 0.05 * radius(); }

  private:
    struct Turntable {
        std::filesystem::path folder;
        Camera start;
        int frames = 0, next = 0;
    };
    void open_json(const std::string& file);
    void take_scene();
    void choose_moving_error();
    double ms_per_ray(Renderer renderer) const;
    PictureKey key(Renderer renderer) const;
    bool needs_right() const;
    bool at_first_view() const;
    void shade_into(const Viewport& to, bool checker) const;
    void inspect_depth();
    void advance_turntable();

    SceneLoader loader_;
    GlModels models_;
    GlSplat splat_;
    GlShade shade_;
    GlTimer shade_timer_;
    Picture left_, right_;
    PixelSize shown_;
    DepthImage inspected_;  ///< T as last read back
    Camera last_camera_;
    /// Exposure is still that of the first view, which finer levels may refine.
    bool exposure_open_ = true;
    bool moving_ = false, opening_ = false;
    int inspected_revision_ = -1;
    double moving_error_ = 0;  ///< pixels; what keeps up with the hand
    double last_change_s_ = 0;
    std::optional<Turntable> turntable_;
};

}  // namespace vog::viewer
