// vog/evaluate.h: the paper's evaluation (its tables 1 to 4 and both figures) for any volume.
// Models are made in many ways, rendered from seven views and held against the voxels themselves;
// the results are written as JSON, Markdown and one HTML page. Protocol: docs/evaluation.md.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "vog/camera.h"
#include "vog/gaussians.h"
#include "vog/levels.h"
#include "vog/progress.h"
#include "vog/shade.h"
#include "vog/volume.h"

namespace vog {

struct Collective;

/// One way to make a model: one row of the results.
struct Conversion {
    std::string series;     ///< rows drawn as one line: "mean", "mass"
    std::string step;       ///< place in the series, part of the row's name: "lod1", "sigma3"
    std::string label;      ///< "dense 2³, smart grouping"
    double aabb_sigma = 0;  ///< SplatOptions::aabb_sigma
    /// budget: Gaussians of the row named below, shared among volumes by their active voxels; else
    /// 0
    std::function<Gaussians(const Volume&, std::size_t budget)> convert;
    std::string budget_series{}, budget_step{};  ///< an earlier row
    /// Levels of a mesh as one model; none: each of their parts by `convert`
    std::function<Gaussians(const Composite&, std::size_t budget)> convert_levels{};
};

/// The paper's rows, with its amplitude (mean) and with the amplitude that conserves mass: levels
/// of detail 1 to 5, and level 3 with bounding boxes of 1, 2 and 3 sigma.
std::vector<Conversion> paper_conversions();
/// Moments: uniform cells of 2, 4, 8 and 16 voxels, the adaptive cut at the count of each of them
/// and at those of the paper's levels 1 and 5, and what `vog convert` does unasked.
std::vector<Conversion> moment_conversions();
/// Both.
std::vector<Conversion> all_conversions();

/// Milliseconds of repeated runs.
struct Timing {
    double min_ms = 0, median_ms = 0, max_ms = 0;
    int runs = 0;
};

struct EvaluationView {
    std::string name;  ///< "paper", "around 1" ... "around 5", "inside"
    Camera camera;
    double extinction = 1;  ///< of this view, for the reference and every model
    double covered = 0;     ///< share of pixels whose T is above 0 in the reference
    Timing reference;       ///< the voxels themselves, by the reference renderer
};

/// `paper`, five more around the data, and one from inside it. Extinction and timing are not set.
std::vector<EvaluationView> evaluation_views(const Box& box);

/// One model in one view, against the reference.
struct ViewResult {
    std::string view;
    double psnr_v_covered_db = 0;  ///< of V; the same error over the covered pixels alone
    double psnr_v_db = 0, psnr_rgb_db = 0, ssim = 0, relative_l2 = 0, bias = 1, largest_dt = 0;
    double off_by_1 = 0, off_by_4 = 0;  ///< shares of pixels
    Timing render;                      ///< of T, shading and loading apart
};

struct EvaluationRow {
    std::string series, step, label;
    std::string options;  ///< of the conversion, as flags
    double aabb_sigma = 0;
    std::uint64_t gaussians = 0, bytes = 0;  ///< bytes: of the PLY file
    double mass_ratio = 1;                   ///< mass of the model / of the volume
    Timing convert;
    std::vector<ViewResult> views;  ///< in the order of Evaluation::views
};

/// Mean and worst of a figure over the views of a row.
struct Spread {
    double mean = 0, worst = 0;
};
/// worst is the least where `more_is_better`, else the largest
Spread spread(const EvaluationRow& row, double ViewResult::*figure, bool more_is_better);

/// Everything the reports are made of.
struct Evaluation {
    std::string title;                  ///< source and grid of every volume
    std::uint64_t active_voxels = 0;    ///< tiles by the voxels they stand for; of levels: seen
    std::uint64_t bounding_voxels = 0;  ///< of the boxes around the active voxels
    std::uint64_t leaves = 0, dense_leaves = 0, tiles = 0;
    std::uint64_t reference_bytes = 0;  ///< of the NanoVDB grids
    double mass = 0;
    int width = 512, height = 512;
    std::string tf, extinction;  ///< transfer function; "auto" or a number
    std::string machine;         ///< processor
    int threads = 1;
    std::vector<EvaluationView> views;
    std::vector<EvaluationRow> rows;
};

struct EvaluateOptions {
    int width = 512, height = 512;  ///< pixels
    int repeats = 5;                ///< timed renders a view, after one that does not count
    double extinction = 0;          ///< 0: for each view the auto_extinction of its reference
    std::string tf = "inferno";     ///< of the RGB figures and the pictures: a name or a JSON file
    std::vector<Conversion> conversions = all_conversions();
    /// Processes that each hold a part of the volumes; the root compares and writes. Only for
    /// conversions that are collective too, and not for levels.
    const Collective* collective = nullptr;
    bool resume = false;  ///< keep the rows of folder/results.json, if it is there
    Progress progress{};
};

/// Evaluates `volumes` together (T adds) and writes into `folder`, made if absent:
///   results.json   after every row, so that an interrupted evaluation can be resumed
///   pictures/      each row seen from `paper` and `inside`, and its difference map
///   results.md, index.html
/// throws   vog::Error for volumes that are empty, a file that cannot be written, results to resume
///          that are of other data or settings
/// cost     conversions * views * (repeats + 1) renders
Evaluation evaluate(std::span<const Volume> volumes, const std::filesystem::path& folder,
                    const EvaluateOptions& options = {});
/// The same for levels of a mesh: the reference counts each piece of a ray in the finest level
/// that is there, the conversions take what finer levels leave.
Evaluation evaluate(const Levels& levels, const std::filesystem::path& folder,
                    const EvaluateOptions& options = {});

}  // namespace vog
