// scene_loader.h: what is shown: the data of the files and the models made of them, level by level, coarse
// ones first, while the window is already open.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "vog/convert_points.h"
#include "vog/gaussians.h"
#include "vog/levels.h"
#include "vog/lod.h"
#include "vog/progress.h"
#include "vog/renderer.h"

namespace vog::viewer {

/// What a set of files holds, as the command line reads it: volumes, particles or a model.
struct Content {
    VolumeSet volumes;
    Points points;
    PointOptions point_options;  ///< of one Gaussian a particle
    Gaussians model;
    Hierarchy hierarchy;  ///< of the model, if its files have one
};
/// throws vog::Error
using ReadFiles = std::function<Content(const std::vector<std::string>& files)>;

/// One model of the data.
struct Level {
    std::string name;  ///< "blocks of 8 voxels", "best cut, 1.9 %", "model"
    std::shared_ptr<const Gaussians> model;
    std::shared_ptr<const Hierarchy> hierarchy;  ///< of the model
    std::string made_by{};  ///< the options of its conversion, where a file says so
    double share = 0;       ///< Gaussians per active voxel; 0: unknown
    /// Of V in the paper view, 256 pixels a side, against the voxels; NaN: not measured.
    double psnr_db = std::numeric_limits<double>::quiet_NaN();
};

struct Scene {
    std::string title;            ///< "smoke.vdb"
    std::string facts;            ///< "1,049,275 active voxels"
    std::string unit = "voxels";  ///< or "particles": what shares and errors are of
    Box box;
    std::shared_ptr<DepthRenderer> voxels;  ///< reference; null for models and particles
    std::vector<Level> levels;              ///< fewest Gaussians first
    int opened = 0;                         ///< rises with every set of files
};

/// Reads, converts and measures in a thread of its own; a new set of files ends the work on the
/// old.
class SceneLoader {
  public:
    explicit SceneLoader(ReadFiles read);
    ~SceneLoader();
    SceneLoader(const SceneLoader&) = delete;
    SceneLoader& operator=(const SceneLoader&) = delete;

    void open(const std::vector<std::string>& files);

    struct Status {
        bool busy = false;
        std::string doing;    ///< "converting: blocks of 4 voxels"
        double fraction = 0;  ///< of that
        std::string error;    ///< why the latest files could not be shown; told once
    };
    Status status();
    /// Whether there is something new since the last call; then it is in `scene`.
    bool take(Scene& scene);

  private:
    struct Cancelled {};
    void work(const std::vector<std::string>& files);
    void show(Scene scene);
    void show_volumes(VolumeSet set, Scene scene);
    void show_points(const Points& points, PointOptions options, Scene scene);
    void show_model(Gaussians model, Hierarchy hierarchy, Scene scene);
    void convert_levels(const Composite& data, Overlap overlap);
    void measure_levels();
    void add_level(Level level);
    void begin(const std::string& doing);
    Progress progress(double from = 0, double to = 1);
    void stop();

    ReadFiles read_;
    std::mutex mutex_;  ///< guards what follows
    Scene scene_;
    Status status_;
    bool changed_ = false, cancel_ = false;
    std::thread thread_;
};

}  // namespace vog::viewer
