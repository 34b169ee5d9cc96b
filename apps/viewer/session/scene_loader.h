// scene_loader.h: Loads files and converts them to levels of detail in a background thread, coarse
// levels first, while the window is already open.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "session/background_renderer.h"
#include "vog/convert_moments.h"
#include "vog/convert_points.h"
#include "vog/gaussians.h"
#include "vog/levels.h"
#include "vog/lod.h"
#include "vog/progress.h"
#include "vog/renderer.h"
#include "vog/site.h"

namespace vog::viewer {

/// Fields at the voxels of volumes, by name: [fields][volumes]; one without values is the volumes' own. Tiles inside
/// which a field varies are divided.
using ReadFields = std::function<std::vector<std::vector<VoxelField>>(std::span<Volume> volumes)>;

/// Data of a set of files, as the command line reads them: volumes, particles or a model.
struct Content {
    VolumeSet volumes;
    ReadFields read_fields;  ///< of the volumes, or of the parts of a mesh; empty: none
    Points points;
    PointOptions point_options;  ///< for the conversion to one Gaussian a particle
    Gaussians model;
    Hierarchy hierarchy;           ///< of the model; empty if its files have none
    std::optional<SitePath> site;  ///< model of a site, which is read as views need it
};
/// throws vog::Error
using ReadFiles = std::function<Content(const std::vector<std::string>& files)>;

/// One level of detail: a model of the data.
struct Level {
    std::string name;  ///< "blocks of 8 voxels", "best cut, 1.9 %", "model"
    std::shared_ptr<const Gaussians> model;
    std::shared_ptr<const Hierarchy> hierarchy;  ///< of the model
    std::shared_ptr<SiteCut>
        site{};             ///< what views draw in place of `model`, its coarsest part; null: none
    std::string made_by{};  ///< options of its conversion, if the file has them
    double share = 0;       ///< Gaussians per active voxel or particle; 0: unknown
    /// PSNR of V in the paper view at 256x256 pixels, against the voxels; NaN: not measured.
    double psnr_db = std::numeric_limits<double>::quiet_NaN();

    /// Gaussians of the whole model.
    std::size_t size() const { return site ? site->info().gaussians : model->size(); }
};

/// Level of a model of a site, its coarsest part in memory.
/// throws  vog::Error as SiteCut
Level level_of(const SitePath& site);

struct Scene {
    std::string title;            ///< "smoke.vdb"
    std::string facts;            ///< "1,049,275 active voxels"
    std::string unit = "voxels";  ///< or "particles": denominator of Level::share
    Subject subject;
    std::shared_ptr<const VoxelData> voxels;  ///< for the reference; null for models and particles
    std::vector<Level> levels;                ///< fewest Gaussians first
    int opened = 0;                           ///< count of sets of files opened so far
};

/// Reads, converts and measures in a thread of its own. Opening other files ends the current work.
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
        double fraction = 0;  ///< finished part of `doing`, [0, 1]
        std::string error;    ///< message, if the files could not be loaded; returned once
    };
    Status status();
    /// Copies the scene if it has changed since the last call. returns true if so
    bool take(Scene& scene);

  private:
    struct Cancelled {};
    void work(const std::vector<std::string>& files);
    void show(Scene scene);
    void show_volumes(VolumeSet set, const ReadFields& read_fields, Scene scene);
    void show_points(const Points& points, PointOptions options, Scene scene);
    void show_model(Gaussians model, Hierarchy hierarchy, Scene scene);
    void show_site(const SitePath& site, Scene scene);
    void convert_levels(const Composite& data, const VoxelData& voxels, Overlap overlap);
    Gaussians converted(const Composite& data, const VoxelData& voxels, std::size_t part,
                        bool is_mesh, MomentOptions options);
    void measure_levels();
    void add_level(Level level);
    void begin(const std::string& doing);
    Progress progress(double from = 0, double to = 1);
    void stop();

    ReadFiles read_;
    std::mutex mutex_;  ///< guards the members below
    Scene scene_;
    Status status_;
    bool changed_ = false, cancel_ = false;
    std::thread thread_;
};

}  // namespace vog::viewer
