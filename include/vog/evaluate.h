// vog/evaluate.h: evaluation of conversions: the paper's tables 1 to 4 and both figures for any
// volume. Each conversion makes a model, a row of the results; it is rendered from seven views and
// compared with exact integration of the voxels (Renderer::reference). Results: JSON, CSV and pictures;
// plots and a page of them: `python -m vog.report FOLDER`. Protocol: docs/evaluation.md.
// T: optical depth; V = 1 - exp(-T), compared as 8-bit grey; RGB: T shaded by the transfer
// function. All are at the extinction (factor on density) of the view.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vog/camera.h"
#include "vog/convert_moments.h"
#include "vog/gaussians.h"
#include "vog/levels.h"
#include "vog/progress.h"
#include "vog/shade.h"
#include "vog/volume.h"
#include "vog/voxel_field.h"
#include "vog/voxelize.h"

namespace vog {

struct Collective;
struct Scene;

/// Conversion to evaluate; it makes one row of the results.
struct Conversion {
    std::string series;     ///< name of the rows that a plot joins by a line: "mean", "mass"
    std::string step;       ///< name of the row in its series: "lod1", "sigma3"
    std::string label;      ///< description of the row: "dense 2³, smart grouping"
    double aabb_sigma = 0;  ///< half edge of the paper's boxes, in its radii, > 0; 0: no boxes
    /// Converts one volume; the models of several volumes are joined.
    /// budget  most Gaussians, > 0: this volume's share, by active voxels, of the count of the row
    ///         named below; 0 where no row is named
    std::function<Gaussians(const Volume&, std::size_t budget)> convert;
    /// Series and step of an earlier row whose count of Gaussians is the budget. Empty: no budget.
    std::string budget_series{}, budget_step{};
    /// Options of convert_moments, for the levels of a mesh and for cuts that follow the fields of an evaluation. Empty: `convert`
    /// for each volume or part.
    std::function<MomentOptions(std::size_t budget)> moments{};
    /// Finished model of the data, in place of a conversion. Null: `convert`.
    std::shared_ptr<const Gaussians> model{};
};

/// Conversions of the paper's tables, series "mean" (its amplitude, the mean density of a group)
/// and "mass" (the amplitude that conserves mass): levels of detail 1 to 5, and level 3 with
/// bounding boxes of 1, 2 and 3 sigma.
std::vector<Conversion> paper_conversions();
/// Conversions by moments: uniform cells of 2, 4, 8 and 16 voxels; the adaptive cut with as many
/// Gaussians as each of these and as the paper's levels 1 and 5; the default of `vog convert`.
std::vector<Conversion> moment_conversions();
/// paper_conversions, then moment_conversions.
std::vector<Conversion> all_conversions();
/// Conversions of a mesh of cells: series "adaptive" of one Gaussian to 4, 16, 64 and 256 cells, and the default of vog.convert.
/// cells  number of cells, > 0
std::vector<Conversion> cell_conversions(std::size_t cells);
/// Row of a finished model: series "model".
/// name  step of the row, part of names of pictures: "smoke.ply"
Conversion model_row(const std::string& name, Gaussians model);

/// Wall-clock times of repeated runs.
struct Timing {
    double min_ms = 0, median_ms = 0, max_ms = 0;  ///< over the runs, milliseconds
    int runs = 0;                                  ///< runs counted
};

/// View of the data, with its reference.
struct EvaluationView {
    std::string name;       ///< "paper", "around 1" ... "around 5", "inside"
    Camera camera;          ///< world units
    double extinction = 1;  ///< factor on density in the reference and in every row, > 0
    double covered = 0;     ///< share of pixels with T > 0 in the reference, [0, 1]
    Timing reference;       ///< renders of the voxels by the reference renderer
};

/// Views of a box: `paper`, five more around it, one from inside. Sets only names and cameras.
std::vector<EvaluationView> evaluation_views(const Box& box);

/// Difference of the maps of a row's field from the reference's in one view. Definitions: FieldDifference
/// (vog/compare_maps.h).
struct FieldResult {
    double mean_l2 = 0,    ///< relative L2 of the mean, weighted by the column
        deviation_l2 = 0,  ///< L2 of the deviation over the field's root mean square
        missing = 0;       ///< share of the weight where the row's picture has no column, [0, 1]
};

/// Views of volume pictures, three bounding radii from the centre.
inline constexpr const char* kValueViews[] = {"paper", "+x", "-x", "+y", "-y", "+z", "-z"};
/// Difference of a row's volume picture (docs/volume_rendering.md) from the voxels', over black, in one view.
struct ValueResult {
    double psnr_rgb_db = 0,  ///< PSNR of RGB over all pixels, dB; infinity: no 8-bit value differs
        ssim = 0;            ///< structural similarity of the luma, [-1, 1]; NaN below 11 pixels
};

/// Difference of a row's picture from the reference in one view. Definitions: vog/compare.h.
struct ViewResult {
    std::string view;  ///< EvaluationView::name
    /// PSNR of V over the covered pixels (T > 0 in the reference), dB, without the background:
    /// psnr_v_db + 10 log10(EvaluationView::covered).
    double psnr_v_covered_db = 0;
    double psnr_v_db = 0,  ///< PSNR of V over all pixels, dB; infinity: no 8-bit value differs
        psnr_rgb_db = 0,   ///< PSNR of RGB over all pixels, dB, likewise
        ssim = 0,          ///< structural similarity of V, [-1, 1]; 1: equal
        relative_l2 = 0,   ///< |T - T_ref|₂ / |T_ref|₂, >= 0
        bias = 1,          ///< mean T / mean T_ref, >= 0
        largest_dt = 0;    ///< T - T_ref of largest magnitude, with its sign
    double off_by_1 = 0,   ///< share of pixels whose V is off by more than 1 of 255, [0, 1]
        off_by_4 = 0;      ///< share of pixels whose V is off by more than 4 of 255, [0, 1]
    Timing render;         ///< renders of T, without shading and loading
    std::vector<FieldResult> fields{};  ///< [Evaluation::fields]; empty for rows with boxes
};

/// Results of one conversion.
struct EvaluationRow {
    std::string series, step, label;  ///< names as in Conversion
    std::string options;              ///< flags of `vog convert` for this model: "--method ..."
    double aabb_sigma = 0;            ///< as in Conversion
    std::uint64_t gaussians = 0,      ///< Gaussians in the model
        bytes = 0;                    ///< size of the model's PLY file, bytes
    double mass_ratio = 1;            ///< mass of the model / mass of the data
    Timing convert;                 ///< conversions: up to 3 runs, one if it takes a second or more
    std::vector<ViewResult> views;  ///< in the order of Evaluation::views
    /// [Evaluation::functions][kValueViews] of volume pictures; empty: none, or a row with boxes.
    std::vector<std::vector<ValueResult>> values{};
    /// Field error: the model on the volume's own lattice (vog/voxelize.h) against the volume. None: not requested, or a
    /// row with boxes, which are of pictures.
    std::optional<VoxelError> voxels{};
};

/// Mean and worst value of a figure over the views of a row, in the figure's unit.
struct Spread {
    double mean = 0, worst = 0;
};
/// Computes mean and worst over the views of a row; both 0 for a row without views.
/// figure          member of ViewResult: &ViewResult::psnr_v_db
/// more_is_better  worst is the least value; else the largest
Spread spread(const EvaluationRow& row, double ViewResult::*figure, bool more_is_better);

/// The same of a figure of field number `field`, the largest value being the worst.
/// figure  member of FieldResult: &FieldResult::mean_l2
Spread spread(const EvaluationRow& row, std::size_t field, double FieldResult::*figure);
/// The same for volume pictures under function number `function`; the least value is the worst.
/// figure  member of ValueResult: &ValueResult::psnr_rgb_db
Spread spread(const EvaluationRow& row, std::size_t function, double ValueResult::*figure);

/// Results of an evaluation, the content of results.json. Counts are sums over all volumes.
struct Evaluation {
    std::string title;                  ///< file and grid of every volume: "smoke.vdb density"
    std::uint64_t active_voxels = 0;    ///< a tile counts edge^3; levels: at least partly visible
    std::uint64_t bounding_voxels = 0;  ///< voxels of the smallest box around the active ones
    std::uint64_t leaves = 0,           ///< leaves of 8^3 voxels
        dense_leaves = 0,               ///< leaves with all 512 voxels active
        tiles = 0;                      ///< constant tiles of any size
    double mass = 0;                    ///< density times world volume, at extinction 1
    int width = 512, height = 512;      ///< size of the pictures, pixels
    std::string tf,                     ///< transfer function: a name or a JSON file
        extinction;                     ///< "auto" (by view) or a number
    std::string machine;                ///< name of the processor
    int threads = 1;                    ///< threads of conversions and renders
    std::vector<std::string> fields{};  ///< names of the fields whose maps are compared
    std::vector<std::string> functions{};  ///< transfer functions of the volume pictures
    bool voxels = false;                   ///< whether rows have EvaluationRow::voxels
    std::vector<EvaluationView> views;     ///< views with their references
    std::vector<EvaluationRow> rows;       ///< one for each conversion, in their order
};

/// Options of evaluate.
struct EvaluateOptions {
    int width = 512, height = 512;  ///< size of the pictures, pixels, >= 1
    int repeats = 5;                ///< timed renders of each view, >= 1, after one untimed
    double extinction = 0;          ///< factor on density, > 0; 0: auto_extinction by view
    std::string tf = "inferno";     ///< transfer function of RGB: a name or a JSON file
    std::vector<Conversion> conversions = all_conversions();  ///< rows of the results
    /// Processes that each hold a part of the volumes (vog/distributed.h); the root compares and
    /// writes. Needs conversions that are collective too; not for levels. Null: one process.
    const Collective* collective = nullptr;
    /// Reads fields at the voxels of volumes, whose tiles it may divide: [fields][volumes]. Their maps of mean
    /// and deviation are compared too, of vectors those of the component along the view. Empty: no fields.
    /// Not for several processes.
    std::function<std::vector<std::vector<VoxelField>>(std::vector<Volume>&)> read_fields{};
    /// Names of fields of cells whose maps are compared.
    std::vector<std::string> cell_fields{};
    /// Compare pictures by the volumes' own values too, from kValueViews, under a ramp, three narrow bands and an
    /// opaque step over values from 0, signed ones from their 0.1st percentile, to the 99.9th. Not for several processes.
    bool by_value = false;
    /// Further transfer functions of values for them: names or JSON files.
    std::vector<std::string> value_functions{};
    /// Measure the field error of each row, EvaluationRow::voxels. For one volume, not for levels and several processes.
    bool voxels = false;
    bool resume = false;  ///< keep the rows of an earlier folder/results.json
    Progress progress{};  ///< called with the finished fraction; empty: not
};

/// Evaluates conversions of volumes, whose T and mass add up, or of the levels of a mesh, and writes into `folder`, made if
/// absent:
///   results.json   after every row, so that an interrupted evaluation can be resumed
///   pictures/      pictures of each row in the views `paper` and `inside`, and difference maps
///   results.csv    at the end: a line for each row
/// Each piece of a ray through a mesh counts in the finest level that covers it; conversions get the parts of each level
/// that no finer level hides.
/// throws   vog::Error for options out of range, no volume or an empty one, a file that cannot be
///          written, earlier results of other data or settings
/// cost     conversions * views * (repeats + 1) renders
Evaluation evaluate(const VolumeSet& data, const std::filesystem::path& folder,
                    const EvaluateOptions& options = {});
/// The same for conversions of cells, compared with exact chords of rays through the cells. In the results `active_voxels` counts
/// the cells with mass, and `bounding_voxels` is 0.
/// cells    scene_of (vog/convert_cells.h)
/// options  conversions with a model, or with `moments` of a budget, an error or neither: cell_conversions
/// throws   vog::Error as above, and for options that only voxels have
Evaluation evaluate(const Scene& cells, const std::filesystem::path& folder,
                    const EvaluateOptions& options);

}  // namespace vog
