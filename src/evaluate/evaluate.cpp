// evaluate.cpp: evaluation of conversions: reference images, then convert, render and compare row by row.
#include "vog/evaluate.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <system_error>

#include "data/field_arrays.h"
#include "evaluate/evaluated_volumes.h"
#include "evaluate/evaluation_json.h"
#include "evaluate/evaluation_report.h"
#include "evaluate/fields/field_comparison.h"
#include "evaluate/values/value_comparison.h"
#include "render/reference/reference.h"
#include "render/splat/splat.h"
#include "shade/named_extinction.h"
#include "vog/compare.h"
#include "vog/distributed.h"
#include "vog/error.h"
#include "vog/ply.h"

namespace vog {

using namespace evaluation;

namespace fs = std::filesystem;

namespace {

Timing timing_of(std::vector<double> ms) {
    std::sort(ms.begin(), ms.end());
    const std::size_t middle = ms.size() / 2;
    const double median = ms.size() % 2 ? ms[middle] : 0.5 * (ms[middle - 1] + ms[middle]);
    return {ms.front(), median, ms.back(), static_cast<int>(ms.size())};
}

/// throws vog::Error for a folder that cannot be created, such as the name of a file
void make_folder(const fs::path& folder) {
    std::error_code code;
    fs::create_directories(folder, code);
    if (!fs::is_directory(folder))
        throw Error(fmt::format("{}: cannot create this folder{}", folder.string(),
                                code ? ": " + code.message() : ""));
}

template <class Work>
double milliseconds(const Work& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
        .count();
}

/// Rows of an interrupted run with the same data and settings; none without options.resume.
/// throws vog::Error for results of other data or settings
std::vector<EvaluationRow> kept_rows(const fs::path& file, const Evaluation& now,
                                     const EvaluateOptions& options) {
    if (!options.resume || !fs::exists(file)) return {};
    Evaluation earlier = read_results(file);
    const auto settings = [](const Evaluation& e) {
        return fmt::format(
            "{} ({} active voxels, mass {:.9g}) at {}x{}, {}, extinction {}{}{}{}{}{}", e.title,
            e.active_voxels, e.mass, e.width, e.height, e.tf, e.extinction,
            e.fields.empty() ? "" : ", fields ", fmt::join(e.fields, ", "),
            e.functions.empty() ? "" : ", by value under ", fmt::join(e.functions, ", "),
            e.voxels ? ", voxels" : "");
    };
    if (settings(earlier) != settings(now))
        throw Error(fmt::format("{}: results of {}, expected {} (without resume they are replaced)",
                                file.string(), settings(earlier), settings(now)));
    if (earlier.views.size() != now.views.size())
        throw Error(
            fmt::format("{}: results of {} views, expected {} (without resume they are "
                        "replaced)",
                        file.string(), earlier.views.size(), now.views.size()));
    return std::move(earlier.rows);
}

/// Images of the voxels that every row is compared with, one per view.
struct References {
    std::vector<DepthImage> depth;
    std::vector<Image> shaded;
    std::vector<std::vector<FieldMaps>> field;  ///< [views][fields]
};

/// One evaluation: its references, its rows and its files.
class Run {
  public:
    /// levels: those whose volumes these are, or null: volumes that add up
    Run(std::span<const Volume> volumes, const Levels* levels, fs::path folder,
        const EvaluateOptions& options)
        : volumes_(volumes),
          levels_(levels),
          folder_(std::move(folder)),
          options_(options),
          tf_(load_transfer_function(options.tf)),
          evaluation_(begin_evaluation(volumes, options)) {
        if (levels) {
            mesh_ = composite(*levels);
            if (mesh_.parts.empty())
                throw Error(
                    fmt::format("{}: no visible voxel, expected active voxels inside the masks",
                                evaluation_.title));
            volumes_ = mesh_.parts;
            evaluation_.active_voxels = mesh_.voxels;
            evaluation_.mass = 0;
            for (const Volume& part : volumes_) evaluation_.mass += mass(part);
            box_ = mesh_.box;
        } else {
            box_ = box_of(volumes, collective_or_single(options.collective));
        }
        evaluation_.views = evaluation_views(box_);
        if (options.read_fields) {
            fields_ = FieldComparison(volumes_, options);
            evaluation_.fields = fields_.names();
        }
        if (options.voxels && ((!levels && volumes.size() != 1) || options.collective))
            throw Error(
                fmt::format("{}: the field error is of one volume or mesh by one process, expected "
                            "no volumes that add up, nor parts",
                            evaluation_.title));
        evaluation_.voxels = options.voxels;
        if (options.by_value) {
            by_value_.emplace(volumes_, box_, options);
            evaluation_.functions = by_value_->names();
        }
        steps_ = static_cast<double>(evaluation_.views.size() * (options.conversions.size() + 1));
    }

    Evaluation run() {
        const std::vector<EvaluationRow> kept =
            kept_rows(folder_ / "results.json", evaluation_, options_);
        if (is_root()) make_folder(folder_ / "pictures");
        render_references();
        for (const Conversion& conversion : options_.conversions) {
            const auto same = [&](const EvaluationRow& row) {
                return row.series == conversion.series && row.step == conversion.step;
            };
            const auto found = std::find_if(kept.begin(), kept.end(), same);
            // A model of this name may be another one.
            if (found == kept.end() || conversion.model) {
                evaluation_.rows.push_back(make_row(conversion));
                // Not after kept rows: the file has all of them, and would lose the others.
                if (is_root()) write_results(folder_ / "results.json", evaluation_);
            } else {
                evaluation_.rows.push_back(*found);
                advance(evaluation_.views.size());
            }
        }
        if (!is_root()) return evaluation_;
        write_results(folder_ / "results.json", evaluation_);
        write_markdown(folder_ / "results.md", evaluation_);
        write_report(folder_ / "index.html", evaluation_, folder_ / "pictures");
        return evaluation_;
    }

  private:
    bool is_root() const { return collective_or_single(options_.collective).is_root(); }

    /// Time of the slowest process, ms.
    template <class Work>
    double shared_ms(const Work& work) const {
        double ms = milliseconds(work);
        collective_or_single(options_.collective).max(std::span(&ms, 1));
        return ms;
    }

    /// Times options.repeats runs of `work`, after one warm-up.
    template <class Work>
    Timing time_repeated(const Work& work) const {
        work();
        std::vector<double> ms;
        for (int n = 0; n < options_.repeats; ++n) ms.push_back(shared_ms(work));
        return timing_of(std::move(ms));
    }

    /// Sums T over all processes.
    void sum_depth(DepthImage& depth) const {
        if (!collective_or_single(options_.collective).shared()) return;
        std::vector<double> sum(depth.depth.begin(), depth.depth.end());
        collective_or_single(options_.collective).sum(sum);
        std::ranges::transform(sum, depth.depth.begin(),
                               [](double t) { return static_cast<float>(t); });
    }

    void advance(std::size_t steps) {
        done_ += static_cast<double>(steps);
        if (options_.progress) options_.progress(done_ / steps_);
    }

    void render_references() {
        if (levels_) {
            const LevelGrids grids = level_grids(*levels_);
            evaluation_.reference_bytes = grids.memory_bytes();
            return render_references_of(grids);
        }
        std::vector<VoxelGrid> grids;
        for (const Volume& volume : volumes_) grids.push_back(voxel_grid(volume));
        for (const VoxelGrid& grid : grids) evaluation_.reference_bytes += grid.memory_bytes();
        allreduce_sum(collective_or_single(options_.collective), evaluation_.reference_bytes);
        render_references_of(grids);
    }

    template <class Grids>
    void render_references_of(const Grids& grids) {
        for (EvaluationView& view : evaluation_.views) {
            DepthImage depth;
            view.reference = time_repeated([&] {
                depth = render_reference(grids, view.camera, options_.width, options_.height);
            });
            sum_depth(depth);
            view.extinction =
                options_.extinction > 0
                    ? options_.extinction
                    : shading::auto_extinction_of(
                          depth, volumes_.empty() ? std::string{} : volumes_.front().source);
            const auto covered = std::count_if(depth.depth.begin(), depth.depth.end(),
                                               [](float t) { return t > 0; });
            view.covered = static_cast<double>(covered) / static_cast<double>(depth.depth.size());
            set_extinction(depth, view.extinction);
            references_.shaded.push_back(shade(depth, tf_));
            references_.depth.push_back(std::move(depth));
            references_.field.push_back(fields_.reference(view.camera));
            if (is_root() && keeps_picture(view.name))
                write_png(folder_ / "pictures" / picture_name(nullptr, view.name, false),
                          references_.shaded.back());
            advance(1);
        }
    }

    static bool keeps_picture(const std::string& view) {
        return std::find(std::begin(kPictureViews), std::end(kPictureViews), view) !=
               std::end(kPictureViews);
    }

    /// Budget of a conversion: the count of Gaussians of the row it names; 0: none.
    std::size_t budget_of(const Conversion& conversion) const {
        if (conversion.budget_series.empty()) return 0;
        for (const EvaluationRow& row : evaluation_.rows)
            if (row.series == conversion.budget_series && row.step == conversion.budget_step)
                return row.gaussians;
        throw Error(fmt::format(
            "evaluate: the budget of row {} {} is the count of row {} {}, expected that row before "
            "it",
            conversion.series, conversion.step, conversion.budget_series, conversion.budget_step));
    }

    /// Converts all volumes to one model; several volumes share the budget by active voxels.
    Gaussians converted(const Conversion& conversion, std::size_t budget) const {
        if (conversion.model) return *conversion.model;
        if (levels_ && conversion.convert_levels) return conversion.convert_levels(mesh_, budget);
        std::uint64_t all_voxels = 0;
        for (const Volume& volume : volumes_) all_voxels += active_voxels(volume);
        Gaussians model;
        for (const Volume& volume : volumes_) {
            const double share = static_cast<double>(active_voxels(volume)) /
                                 static_cast<double>(std::max<std::uint64_t>(all_voxels, 1));
            const auto part_budget = static_cast<std::size_t>(static_cast<double>(budget) * share);
            Gaussians part = conversion.convert(volume, part_budget);
            if (model.size() == 0)
                model = std::move(part);
            else
                append(model, part);
        }
        return model;
    }

    /// Converts, up to three times while it takes less than a second, for a median time.
    Gaussians convert(const Conversion& conversion, Timing& timing) const {
        constexpr double kQuickMs = 1000;
        constexpr std::size_t kRuns = 3;
        const std::size_t budget = budget_of(conversion);
        Gaussians model;
        std::vector<double> ms;
        do ms.push_back(shared_ms([&] { model = converted(conversion, budget); }));
        while (!conversion.model && ms.size() < kRuns && ms.back() < kQuickMs);
        timing = conversion.model ? Timing{} : timing_of(std::move(ms));
        model.box = box_;
        return model;
    }

    EvaluationRow make_row(const Conversion& conversion) {
        EvaluationRow row;
        row.series = conversion.series;
        row.step = conversion.step;
        row.label = conversion.label;
        row.aabb_sigma = conversion.aabb_sigma;
        const Gaussians model = convert(conversion, row.convert);
        row.options = fmt::format("--method {} {}", model.method, model.options);
        row.gaussians = model.size();
        allreduce_sum(collective_or_single(options_.collective), row.gaussians);
        double rotated = model.axis_aligned() ? 0 : 1;  // an empty part is axis-aligned
        collective_or_single(options_.collective).max(std::span(&rotated, 1));
        Gaussians about;  // header of the whole model
        about.cutoff = model.cutoff, about.origin = model.origin, about.box = model.box,
        about.source = model.source;
        about.method = model.method, about.options = model.options;
        about.summary = model.summary, about.source_voxels = model.source_voxels;
        about.fields = empty_fields(model.fields);
        if (collective_or_single(options_.collective).shared())
            about.source_voxels = evaluation_.active_voxels;
        row.bytes = ply_header(about, row.gaussians, rotated > 0).size() +
                    row.gaussians * ply_row_floats(rotated > 0, about.fields) * sizeof(float);
        double model_mass = mass(model);
        collective_or_single(options_.collective).sum(model_mass);
        row.mass_ratio = evaluation_.mass > 0 ? model_mass / evaluation_.mass : 1;

        SplatOptions splat;
        splat.aabb_sigma = conversion.aabb_sigma;
        SplatRenderer renderer(model, splat);
        DepthImage depth;
        for (std::size_t n = 0; n < evaluation_.views.size(); ++n) {
            const Timing timing = time_repeated([&] {
                renderer.render(evaluation_.views[n].camera, options_.width, options_.height,
                                depth);
            });
            sum_depth(depth);
            if (is_root()) {
                row.views.push_back(compare_view(row, n, depth));
                row.views.back().render = timing;
            }
            advance(1);
        }
        // Boxes are of T.
        if (conversion.aabb_sigma == 0) fields_.compare(model, evaluation_, references_.field, row);
        if (conversion.aabb_sigma == 0 && by_value_) row.values = by_value_->compare(model);
        if (conversion.aabb_sigma == 0 && options_.voxels)
            row.voxels =
                levels_ ? voxel_error(volumes_, model)
                        : voxel_error(volumes_.front(),
                                      voxelize(model, volumes_.front().world_from_index).volume);
        return row;
    }

    /// Metrics of one row from one view; writes the pictures of the views of kPictureViews.
    ViewResult compare_view(const EvaluationRow& row, std::size_t n, DepthImage& depth) const {
        const EvaluationView& view = evaluation_.views[n];
        set_extinction(depth, view.extinction);
        const Image shaded = shade(depth, tf_);
        const DepthDifference difference = compare(references_.depth[n], depth);
        if (keeps_picture(view.name)) {
            const fs::path pictures = folder_ / "pictures";
            write_png(pictures / picture_name(&row, view.name, false), shaded);
            write_png(pictures / picture_name(&row, view.name, true),
                      difference_map(references_.depth[n], depth, {kMapLimit, false}));
        }
        ViewResult result;
        result.view = view.name;
        result.psnr_v_db = difference.grey.psnr_db;
        // Empty pixels have almost no error: the sum of squares is that of the covered pixels.
        result.psnr_v_covered_db = result.psnr_v_db + 10 * std::log10(view.covered);
        result.psnr_rgb_db = compare(references_.shaded[n], shaded).psnr_db;
        result.ssim = difference.grey.ssim;
        result.relative_l2 = difference.relative_l2;
        result.bias = difference.bias;
        result.largest_dt = difference.largest_dt;
        result.off_by_1 = difference.grey.share_off_1;
        result.off_by_4 = difference.grey.share_off_4;
        return result;
    }

    std::span<const Volume> volumes_;  ///< what is converted; of levels, the parts of mesh_
    const Levels* levels_;
    Composite mesh_;
    fs::path folder_;
    const EvaluateOptions& options_;
    TransferFunction tf_;
    Evaluation evaluation_;
    Box box_;
    References references_;
    FieldComparison fields_;
    std::optional<ValueComparison> by_value_;
    double done_ = 0, steps_ = 1;
};

void check(const EvaluateOptions& options) {
    if (options.repeats < 1)
        throw Error(fmt::format("evaluate: {} repeats, expected at least 1", options.repeats));
    if (!(options.extinction >= 0))
        throw Error(fmt::format("evaluate: extinction {}, expected a number above 0, or 0: auto",
                                options.extinction));
    if ((options.read_fields || options.by_value) &&
        collective_or_single(options.collective).shared())
        throw Error("evaluate: fields or pictures by value by several processes, expected one");
}

}  // namespace

Evaluation evaluate(std::span<const Volume> volumes, const fs::path& folder,
                    const EvaluateOptions& options) {
    check(options);
    if (volumes.empty()) throw Error("evaluate: no volume, expected at least one");
    for (const Volume& volume : volumes) {
        validate(volume);
        if (volume.empty() && !collective_or_single(options.collective).shared())
            throw Error(fmt::format("{}: no active voxel, expected at least one", volume.source));
    }
    return Run(volumes, nullptr, folder, options).run();
}

Evaluation evaluate(const Levels& levels, const fs::path& folder, const EvaluateOptions& options) {
    check(options);
    validate(levels);
    return Run(levels.volumes, &levels, folder, options).run();
}

}  // namespace vog
