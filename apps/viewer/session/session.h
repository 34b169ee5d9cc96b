// session.h: state of the window and its operations, called by panels, keys and scripts alike.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "quantity/look.h"
#include "quantity/quantity.h"
#include "quantity/value_edit.h"
#include "session/picture.h"
#include "session/scene_loader.h"
#include "session/steps.h"
#include "ui/trackball.h"

namespace vog::viewer {

/// Settings of the picture and the window.
struct Settings {
    WindowRenderer renderer = WindowRenderer::gl,
                   other = WindowRenderer::voxels;  ///< left and right of the split line
    bool split_on = false, difference = false;
    float split = 0.5f;              ///< position of the split line, fraction of the width
    float difference_limit = 0.02f;  ///< at the ends of the difference's colours (ShadeView)
    int level = -1;                  ///< level of detail, index into the scene's; -1: the finest
    bool coarse_moving = true;       ///< coarser cut while the camera moves and frames are slow
    float pixel_error = 1;  ///< screen-space error of the level-of-detail cut, pixels; 0: none
    double scale = 1;       ///< rendered pixels per screen pixel, along an edge
    int subframes = 64;     ///< antialiasing samples per pixel
    bool follow_exposure = false;  ///< automatic extinction whenever the picture is complete
    bool panels = true, overlay = true, help = false, color_bar = true;
    bool axes = true;           ///< of the world, with the scale bar and the probe
    bool light_window = false;  ///< dark text on light panels
    double steps_per_second = 8;
    bool loop = true;  ///< the first step follows the last
};

/// Receiver of the pictures of a film.
class PictureSink {
  public:
    virtual ~PictureSink() = default;
    /// throws vog::Error
    virtual void add(const Image& picture) = 0;
    virtual void finish() = 0;
};
/// Opens a film of this name and pictures a second. throws vog::Error where it can not be written
using OpenFilm =
    std::function<std::unique_ptr<PictureSink>(const std::string& file, double per_second)>;

/// Number under the pointer.
struct Probed {
    std::string text;  ///< "mean of temperature 1240 K, column 0.31"; empty: nothing is there
};

/// Transfer function of a field of a model, as the command's options choose it: for a first picture by value.
/// first  whether options of the field's values count, or the map alone
using ChooseTransfer =
    std::function<ValueTransfer(const Gaussians& model, const std::string& field, bool first)>;

/// Times of the latest frame, ms.
struct Measured {
    double frame_ms = 0, shade_ms = 0, gui_ms = 0;
};

/// Layers that volume pictures show in place of the model.
struct LayeredData {
    std::shared_ptr<const vog::Scene> scene;  ///< null: none
    std::vector<Layer> layers;
    std::vector<std::string> inputs;  ///< by Layer::input
};

/// Seconds of a monotonic clock.
double steady_clock_s();

class Session {
  public:
    /// Needs a current OpenGL context, which must outlive it.
    /// clock_s  current time, seconds: the camera counts as moving for a while after its last
    ///          change
    explicit Session(ReadFiles read, std::function<double()> clock_s = steady_clock_s);

    // State that callers may change between frames.
    Settings settings;
    Camera camera;
    Look look;  ///< changes take effect with look_changed()
    /// Initial view of opened files.
    ScaleFit first_fit = ScaleFit::automatic;  ///< of scales that are not stated
    std::function<Camera(const Subject&)> first_camera = [](const Subject& subject) {
        return orbit_view(subject, first_orbit(subject));
    };
    // State for display.
    Measured measured;
    Scene scene;
    Quantity quantity;  ///< what is shown; changes take effect with set_quantity()
    /// Of column, mean and deviation; of volume the range of the values.
    ColorScale scale{ColorScale::Kind::linear, 0, 1};
    ValueHistory values;             ///< transfer functions of the shown field's values
    ChooseTransfer choose_transfer;  ///< empty: the map over the field's range
    std::vector<float> histogram;    ///< fraction of the pixels with T > 0 by V, equal bins
    std::vector<float>
        value_histogram;  ///< measure of the model by value over the field's range, the largest 1
    double steepest = 0;  ///< steepest_gradient() of the field
    double automatic_extinction = 1;        ///< latest value of auto_exposure()
    std::vector<std::string> opened_files;  ///< of the latest open()
    std::string message;                    ///< latest result or error, for the status line
    bool failed = false;                    ///< the message is an error

    /// Opens models as steps in time, at the first of them.
    void open_steps(std::vector<std::string> files);
    /// Steps of the open sequence; 0: none is open.
    std::size_t step_count() const { return steps_ ? steps_->count() : 0; }
    std::size_t step() const { return step_; }
    /// Shows a step once it is read. throws vog::Error for one that is not there
    void set_step(std::size_t step);
    bool playing() const { return playing_; }
    void play(bool on);
    /// Steps in memory after the present one.
    std::size_t steps_ahead() const { return steps_ ? steps_->ahead() : 0; }

    /// Opens data, or a JSON file with a transfer function or a camera.
    /// throws vog::Error for a JSON file of neither
    void open(const std::vector<std::string>& files);
    void show_message(const std::string& text);
    void show_error(const std::string& text);

    /// throws  vog::Error as resolve() does
    void set_layers(LayeredData data);
    /// Whether the picture shows layers.
    bool shows_layers() const { return layered_.scene && quantity.show == Show::volume; }
    /// With their transfer functions.
    const std::vector<Layer>& layers() const { return layered_.layers; }
    /// File and field of a layer.
    std::string layer_name(std::size_t n) const;
    bool is_surface(std::size_t n) const { return layered_as_.layers[n].field.field.empty(); }
    void set_layer_visible(std::size_t n, bool visible);
    /// Box of a layer's data, world units.
    Box layer_box(std::size_t n) const { return outline_of(layered_.scene->layers[n].subject); }
    /// Changes a layer's transfer function, plane, colour or opacity.
    /// throws  vog::Error as resolve() does; nothing changes then
    void edit_layer(std::size_t n, const std::function<void(Layer&)>& change);

    void look_changed();
    void auto_exposure();
    /// Shows a quantity; its field is the nearest the model has.
    /// field   as field_for reads it; empty: the present one, else the first
    /// throws  vog::Error for a field that the model lacks; nothing changes then
    void set_quantity(Show show, const std::string& field = {});
    /// Another scale of column, mean and deviation.
    /// throws  vog::Error for ends that are no scale
    void set_scale(const ColorScale& scale);
    /// The scale that fits the present picture; of volume the transfer function that the field begins with.
    void automatic_scale();
    /// Shadows of the light, which lies at the upper left of this view unless it has a direction.
    void set_shadows(bool on);
    /// Another transfer function of values.
    /// throws  vog::Error as validate does
    void set_values(ValueTransfer transfer);
    /// Colours by another map, of the quantity shown.
    void set_map(const std::string& name_or_file);
    /// Space that all quantities show; nothing: all.
    /// throws  vog::Error for a box that is inside out
    void set_clip(const std::optional<Box>& box);
    /// Number at a point of the picture, from its top left, shares of its size.
    Probed probe(double x, double y) const;
    /// Fields of the open model; none before something is open.
    const Fields& fields() const;
    void set_view(const std::string& name);
    void fit();
    /// Parallel rays, or a pinhole, at the same size of what the camera looks at.
    void set_orthographic(bool orthographic);
    /// Vertical direction of the data: of the initial view, unless it was switched.
    Vec3d up() const;
    /// Makes z vertical, or y.
    void set_z_up(bool z_up);
    /// Back to the initial view of the files.
    void reset_view();
    /// Extinction of the first picture, in place of the automatic one.
    void set_first_exposure(double extinction);
    /// Index of a level by "finest", "coarsest", its number from 1, or the start of its name.
    /// throws vog::Error, with the levels there are
    int level_index(const std::string& name) const;
    /// Copies the view, the quantity and the look to the clipboard as --request of vog render.
    void copy_request();
    /// What is shown as JSON, a record of vog/picture_record.h.
    std::string record() const;

    /// The shaded picture, with split or difference, at its rendered size. throws vog::Error before
    /// the first picture
    Image picture_image();
    void save_picture(const std::filesystem::path& file);
    /// Saves the numbers of the picture as EXR: T; column, mean and deviation of a field; colours of a volume.
    void save_depth(const std::filesystem::path& file);
    void save_look(const std::filesystem::path& file);
    /// Saves `frames` pictures of a full turn about the up axis of the data, as 0001.png, ... in a folder, or as a
    /// film (.mp4, .webm).
    /// in_time  time runs once during the turn. throws vog::Error where no steps are open
    void start_turntable(const std::filesystem::path& output, int frames, bool in_time = false);
    /// Saves a picture of each step in time likewise.
    void start_time_export(const std::filesystem::path& output);
    bool turning() const { return recording_.has_value(); }
    OpenFilm open_film;  ///< empty: no films

    /// Advances loading, rendering and the turntable by one frame. shown  size of the picture
    void update(PixelSize shown);
    /// Shades into the bound framebuffer.
    void draw(const Viewport& to);
    /// Whether further frames without input would change nothing.
    bool at_rest() const;
    /// Whether OpenGL renders in every frame.
    bool drawing() const;
    /// Whether reading, converting and measuring have ended.
    bool loaded() const { return !loading.busy; }
    /// Whether files are being opened, and none of their data is displayed yet.
    bool opening() const { return opening_; }
    SceneLoader::Status loading;

    const ProgressivePicture& left() const { return left_; }
    const ProgressivePicture& right() const { return right_; }
    /// The displayed level of detail; null: none yet.
    const Level* shown_level() const { return level_at(settings.level); }
    /// Level of the scene by index; -1: the finest; null: the scene is empty.
    const Level* level_at(int level) const;
    bool moving() const { return moving_; }
    double aspect() const;  ///< width / height of the picture
    /// Half the diagonal of the data's box, world units; 1 for a box without extent.
    double radius() const;
    /// Smallest distance from eye to look_at, world units: closer, zooming moves look_at ahead, so
    /// that the camera gets through the volume.
    double least_distance() const { return 0.05 * radius(); }

  private:
    /// A turn, or all steps in time, being saved.
    struct Recording {
        std::filesystem::path output;  ///< folder or film
        bool turns = false, of_time = false;
        Camera camera;         ///< before
        std::size_t step = 0;  ///< before
        int frames = 0, next = 0;
        std::unique_ptr<PictureSink> film;
    };
    void start_recording(Recording recording);
    void open_json(const std::string& file);
    void update_scene();
    void update_moving_error();
    void update_site();
    /// Largest error of nodes that are drawn now, pixels.
    double pixel_error() const;
    double ms_per_ray(WindowRenderer renderer) const;
    PictureKey key(WindowRenderer renderer) const;
    ResolvedPicture layered_picture(const PictureRequest& request) const;
    bool needs_right() const;
    bool at_first_view() const;
    void shade_into(const Viewport& to, bool checker) const;
    void inspect();
    void inspect_visibility();
    std::string probe_volume(int column, int row) const;
    void begin_values();
    void update_quantity();
    FieldUnit field_unit() const;
    Sums numbers() const;
    bool has_depth() const;
    ShadeView shade_view() const;
    void advance_recording();
    void update_steps();

    LayeredData layered_;
    ResolvedPicture layered_as_;  ///< resolved
    int layer_changes_ = 0;
    SceneLoader loader_;
    ReadFiles read_;  ///< of steps
    GlRenderers gl_;
    GlShade shade_;
    GlTimer shade_timer_;
    ProgressivePicture left_, right_;
    PixelSize shown_;
    std::function<double()> clock_s_;
    Sums inspected_;                     ///< numbers as last read back
    ResolvedPicture inspected_picture_;  ///< the picture that they belong to
    /// The latest probe of a volume: nothing is computed again for a pointer at rest.
    mutable struct {
        int column = -1, row = -1, revision = -1;
        std::string text;
    } probed_;
    float most_column_ = 0;     ///< largest column in them
    bool scale_open_ = true;    ///< the scale follows the pictures until one is complete
    std::string values_of_;     ///< field of `values`
    bool values_first_ = true;  ///< no transfer function was chosen yet
    std::optional<Vec3d> up_;   ///< of set_z_up
    std::string wanted_field_;  ///< of set_quantity before anything is open
    Camera last_camera_;
    /// The extinction is still the automatic one of the initial view, which finer levels refine.
    bool exposure_open_ = true;
    bool moving_ = false, opening_ = false;
    int inspected_revision_ = -1;
    double moving_error_ = 0;  ///< screen-space error of the cut that keeps frames fast, pixels
    double last_change_s_ = 0;
    std::shared_ptr<const Gaussians> site_model_;  ///< of the view, of an opened site
    std::shared_ptr<SiteCut> site_of_;             ///< what it comes from
    std::uint64_t site_revision_ = 0;              ///< SiteCutReport::revision of it
    std::size_t site_pending_ = 0;                 ///< chunks that are being read
    std::string site_fault_;                       ///< shown once
    std::optional<Recording> recording_;
    std::unique_ptr<Steps> steps_;
    std::size_t step_ = 0;
    std::optional<std::size_t> shown_step_;
    bool playing_ = false;
    double last_step_s_ = 0;
};

}  // namespace vog::viewer
