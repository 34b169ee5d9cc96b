// vog/rate_distortion.h: bytes against error: models in compact files beside the volume's own voxels, by OpenVDB, NanoVDB,
// ZFP and SZ3. Every row is a file on disk; its errors are those of what is read back from it, from the same views by
// the same renderers. docs/evaluation.md, "Bytes and error"
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "vog/progress.h"
#include "vog/volume.h"
#include "vog/voxelize.h"

namespace vog {

/// Options of rate_distortion.
struct RateDistortionOptions {
    int width = 512, height = 512;  ///< size of the pictures, pixels, >= 1
    double extinction = 0;          ///< factor on density, > 0; 0: auto_extinction by view
    /// Number of model sizes, [1, 100]: counts of Gaussians spaced geometrically from 1/4096 to 1/8 of the active voxels.
    int model_sizes = 10;
    /// Most tolerances of each codec that has one, [1, 100], each half of the one before: from the first that reaches
    /// kLeastRateDb to the first that reaches kMostRateDb.
    int tolerances = 10;
    double max_loss_db = 0.1;  ///< loss of PSNR of V by a model's compact file, as VogzBound, > 0
    /// Further transfer functions of values: names or JSON files.
    std::vector<std::string> value_functions{};
    Progress progress{};  ///< called with the finished fraction; empty: not
};
/// PSNR of V, mean of the views, dB: the range of tolerances.
inline constexpr double kLeastRateDb = 35, kMostRateDb = 58;

/// One file.
struct RateRow {
    std::string
        series;  ///< "model", "model with values", "vdb", "NanoVDB", "NanoVDB FpN", "ZFP and masks", ...
    std::string step;         ///< "2,990 Gaussians", "half, zip", "tolerance 0.0056"
    std::string file;         ///< its name in the folder: "files/zfp-and-masks-3.zfp"
    std::uint64_t bytes = 0;  ///< size of the file
    /// Bytes of it for values of a model, or for origins and masks of leaves where they stand apart.
    std::uint64_t side_bytes = 0;
    std::uint64_t gaussians = 0;  ///< number in a model; 0: voxels
    double tolerance = 0;         ///< in the unit of density; 0: none is chosen
    double mass_ratio = 1;        ///< mass of what is read / mass of the data
    std::vector<double>
        psnr_v_db;  ///< [kValueViews] PSNR of V, dB; infinity: no 8-bit value differs
    /// [functions][kValueViews] PSNR of RGB of pictures by value, dB. Empty: a model without values.
    std::vector<std::vector<double>> psnr_rgb_db;
    VoxelError voxels;  ///< against the volume; a model as `vog voxelize --like` has it
};

/// Results: rows of a series stand together.
struct RateDistortion {
    std::string title;                   ///< file and grid: "smoke.vdb density"
    std::uint64_t active_voxels = 0;     ///< a tile counts edge^3
    int width = 512, height = 512;       ///< pixels
    double max_loss_db = 0.1;            ///< as in the options
    std::vector<std::string> functions;  ///< transfer functions of the pictures by value
    std::vector<std::string> absent;  ///< codings without rows, and why: "SZ3: not in this build"
    std::vector<RateRow> rows;
};

/// Figures by which rows compare; larger is better.
enum class RateFigure {
    v_mean,    ///< PSNR of V, mean of the views
    v_worst,   ///< the least of the views
    v_axes,    ///< mean of the six views along axes
    v_paper,   ///< view `paper`
    rgb_mean,  ///< PSNR of RGB under one transfer function, mean of the views
    rgb_worst,
    voxels,  ///< VoxelError::psnr_db
};
/// Figure of a row, dB; none for pictures by value of a model without values.
/// function  index of the transfer function, for rgb_mean and rgb_worst
std::optional<double> rate_figure(const RateRow& row, RateFigure figure, std::size_t function = 0);

/// Bytes at which a series reaches a figure: between two rows of models or of a codec with tolerances by the logarithm of
/// bytes, linear in dB; else the least row that reaches it. Below the least row of a series its bytes.
/// returns  none where no row reaches it
std::optional<double> bytes_at(const RateDistortion& results, const std::string& series,
                               RateFigure figure, double decibels, std::size_t function = 0);
/// Distinct series in order of their first rows.
std::vector<std::string> rate_series(const RateDistortion& results);
/// Whether a series is of models.
bool is_model_series(const std::string& series);

/// Writes and measures every row; writes into `folder`, made if absent:
///   files/                 every row's file
///   rate_distortion.json, .csv, .md   the results; tables
///   V.svg, ramp.svg, ..., voxels.svg  plots of error over bytes
/// volume   with active voxels and a density above 0
/// throws   vog::Error for options out of range, an empty volume, one without a density above 0, a loss bound that
///          cannot be met, or files that cannot be written
/// cost     for each row seven pictures of T and of each transfer function; models are also turned back into voxels
RateDistortion rate_distortion(const Volume& volume, const std::filesystem::path& folder,
                               const RateDistortionOptions& options = {});

}  // namespace vog
