// rate_distortion.cpp: rows of models and of the volume's own voxels: write a file, read it back, measure.
#include "vog/rate_distortion.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <system_error>

#include "evaluate/rate/rate_errors.h"
#include "evaluate/rate/rate_report.h"
#include "evaluate/rate/volume_codings.h"
#include "vog/convert_fields.h"
#include "vog/convert_moments.h"
#include "vog/error.h"
#include "vog/text.h"
#include "vog/vogz.h"
#include "vog/vogz_fit.h"

namespace vog {

using namespace evaluation;

namespace fs = std::filesystem;

namespace {

constexpr double kFewest = 1.0 / 4096, kMost = 1.0 / 8;  // Gaussians per active voxel
/// Tolerances are 2^-n of the largest density: ZFP's errors are far below its tolerances, so that larger ones than all
/// densities are of use; 2^-60 is below every useful one.
constexpr int kFirstHalving = -3, kLastHalving = 60;

/// Distinct counts of Gaussians, spaced geometrically.
std::vector<std::size_t> model_sizes(std::uint64_t active_voxels, int count) {
    std::vector<std::size_t> sizes;
    for (int n = 0; n < count; ++n) {
        const double share = count == 1 ? 1 : static_cast<double>(n) / (count - 1);
        const double size =
            static_cast<double>(active_voxels) * kFewest * std::pow(kMost / kFewest, share);
        sizes.push_back(std::max<std::size_t>(8, static_cast<std::size_t>(std::lround(size))));
    }
    sizes.erase(std::unique(sizes.begin(), sizes.end()), sizes.end());
    return sizes;
}

double largest_density(const Volume& volume) {
    float largest = 0;
    for (const Leaf& leaf : volume.leaves)
        for (const float value : leaf.value) largest = std::max(largest, value);
    for (const Tile& tile : volume.tiles) largest = std::max(largest, tile.value);
    return largest;
}

/// "ZFP, no masks" -> "zfp-no-masks".
std::string file_stem(const std::string& text) {
    std::string stem;
    for (const char c : text) {
        if (std::isalnum(static_cast<unsigned char>(c)))
            stem += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        else if (!stem.empty() && stem.back() != '-')
            stem += '-';
    }
    return stem;
}

/// One run: its data, its rows and its files.
class RateRun {
  public:
    RateRun(const Volume& volume, fs::path folder, const RateDistortionOptions& options)
        : volume_(volume),
          folder_(std::move(folder)),
          options_(options),
          errors_(volume, options),
          largest_(largest_density(volume)) {
        results_.title = fs::path(volume.source).filename().string() + " " + volume.name;
        results_.active_voxels = active_voxels(volume);
        results_.width = options.width;
        results_.height = options.height;
        results_.max_loss_db = options.max_loss_db;
        results_.functions = errors_.functions();
    }

    RateDistortion run() {
        std::error_code code;
        fs::create_directories(folder_ / "files", code);
        if (!fs::is_directory(folder_ / "files"))
            throw Error(fmt::format("{}: cannot create this folder{}", (folder_ / "files").string(),
                                    code ? ": " + code.message() : ""));
        const std::vector<std::size_t> sizes =
            model_sizes(results_.active_voxels, options_.model_sizes);
        const std::vector<VolumeCoding> fixed = fixed_codings(largest_, results_.absent);
        const std::vector<GradedCodec> graded = graded_codecs(results_.absent);
        steps_ = static_cast<double>(sizes.size() + 1 + graded.size());
        for (const std::size_t size : sizes) {
            add_models(size);
            advance();
        }
        // Rows of models without values, then those with: rows of a series stand together.
        std::ranges::stable_sort(results_.rows, {}, &RateRow::series);
        for (const VolumeCoding& coding : fixed)
            add(coding, fmt::format("{}-{}", file_stem(coding.series), file_stem(coding.step)));
        advance();
        for (const GradedCodec& codec : graded) {
            add_tolerances(codec);
            advance();
        }
        write_rate_report(folder_, results_);
        return std::move(results_);
    }

  private:
    void advance() {
        ++done_;
        if (options_.progress) options_.progress(done_ / steps_);
    }

    /// A model of at most `size` Gaussians, without values and with them: one precision, that of its pictures of T.
    void add_models(std::size_t size) {
        MomentOptions moments;
        moments.budget = size;
        moments.own_field = volume_.name.empty() ? "density" : volume_.name;
        const Gaussians model = convert_moments(volume_, moments);
        const VogzBound bound{options_.max_loss_db, [&](const Camera& camera, int pixels) {
                                  return errors_.data(camera, pixels);
                              }};
        const VogzPrecision precision = fit_vogz(model, bound).precision;

        Gaussians bare = model;
        bare.fields = {};
        RateRow row = row_of_model("model", bare, precision);
        const Gaussians read = read_vogz(folder_ / row.file);
        row.psnr_v_db = errors_.psnr_v(read);
        row.voxels = errors_.voxels(voxelize(read, volume_.world_from_index).volume);
        row.mass_ratio = mass(read) / mass(volume_);

        RateRow with = row_of_model("model with values", model, precision);
        const Gaussians read_with = read_vogz(folder_ / with.file);
        with.psnr_v_db = errors_.psnr_v(read_with);
        with.psnr_rgb_db = errors_.psnr_rgb(read_with);
        with.voxels = row.voxels;  // of the same Gaussians
        with.mass_ratio = mass(read_with) / mass(volume_);
        results_.rows.push_back(std::move(row));
        results_.rows.push_back(std::move(with));
    }

    RateRow row_of_model(const std::string& series, const Gaussians& model,
                         const VogzPrecision& precision) {
        RateRow row;
        row.series = series;
        row.file = fmt::format("files/{}-{}.vogz", file_stem(series), model.size());
        const VogzReport report = write_vogz(folder_ / row.file, model, {}, {precision});
        row.gaussians = report.gaussians;
        row.step = count_text(row.gaussians) + " Gaussians";
        for (const auto& [name, bytes] : report.fields) row.side_bytes += bytes;
        row.bytes = report.bytes;
        return row;
    }

    /// Halves a codec's tolerance.
    void add_tolerances(const GradedCodec& codec) {
        const std::string stem = file_stem(codec.series);
        int rows = 0;
        for (int n = kFirstHalving; n <= kLastHalving && rows < options_.tolerances; ++n) {
            const double mean =
                add(codec.at(std::ldexp(largest_, -n)),
                    fmt::format("{}-{}", stem, n - kFirstHalving), rows ? 0 : kLeastRateDb);
            if (rows == 0 && mean < kLeastRateDb) continue;
            ++rows;
            if (rows > 1) rows -= drop_equal();
            if (mean >= kMostRateDb) return;
        }
    }

    /// Drops the last row but one where the last one is no better and no smaller: one bit a voxel, the least of FpN, serves
    /// several wide tolerances, of which the narrowest stays.
    /// returns  the number of rows dropped, 0 or 1
    int drop_equal() {
        const RateRow &before = results_.rows.rbegin()[1], &last = results_.rows.back();
        if (before.bytes != last.bytes || before.psnr_v_db != last.psnr_v_db) return 0;
        fs::remove(folder_ / before.file);
        results_.rows.erase(results_.rows.end() - 2);
        return 1;
    }

    /// Adds a row where its PSNR of V is at least `least_db` in the mean, else removes its file.
    /// returns  PSNR of V, mean of the views, dB
    double add(const VolumeCoding& coding, const std::string& stem, double least_db = 0) {
        RateRow row;
        row.series = coding.series;
        row.step = coding.step;
        row.tolerance = coding.tolerance;
        row.file = fmt::format("files/{}{}", stem, coding.extension);
        const fs::path file = folder_ / row.file;
        row.side_bytes = coding.write(volume_, file);
        row.bytes = fs::file_size(file);
        const Volume read = coding.read(file);
        row.psnr_v_db = errors_.psnr_v(read);
        const double mean = *rate_figure(row, RateFigure::v_mean);
        if (mean < least_db) {
            fs::remove(file);
            return mean;
        }
        errors_.measure(read, row.psnr_v_db, row);
        results_.rows.push_back(std::move(row));
        return mean;
    }

    const Volume& volume_;
    fs::path folder_;
    const RateDistortionOptions& options_;
    RateErrors errors_;
    RateDistortion results_;
    double largest_, done_ = 0, steps_ = 1;
};

}  // namespace

RateDistortion rate_distortion(const Volume& volume, const fs::path& folder,
                               const RateDistortionOptions& options) {
    for (const auto& [name, count] :
         {std::pair{"model sizes", options.model_sizes}, {"tolerances", options.tolerances}})
        if (count < 1 || count > 100)
            throw Error(fmt::format("{} {}, expected 1 to 100", count, name));
    if (!(options.extinction >= 0))
        throw Error(fmt::format("extinction {}, expected a number above 0, or 0: auto",
                                options.extinction));
    if (options.width < 1 || options.height < 1)
        throw Error(
            fmt::format("{}x{} pixels, expected at least one", options.width, options.height));
    validate(volume);
    if (volume.empty())
        throw Error(fmt::format("{}: no active voxel, expected at least one", volume.source));
    return RateRun(volume, folder, options).run();
}

}  // namespace vog
