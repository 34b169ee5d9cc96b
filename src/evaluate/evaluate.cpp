// evaluate.cpp: evaluation of conversions: reference images, then convert, render and compare row by row.
#include "vog/evaluate.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <system_error>

#include "data/fields/field_arrays.h"
#include "evaluate/evaluated_volumes.h"
#include "evaluate/evaluation_json.h"
#include "evaluate/evaluation_report.h"
#include "evaluate/fields/field_comparison.h"
#include "evaluate/values/value_comparison.h"
#include "shade/named_extinction.h"
#include "vog/compare.h"
#include "vog/convert_cells.h"
#include "vog/distributed.h"
#include "vog/error.h"
#include "vog/picture.h"
#include "vog/ply.h"

namespace vog {

using namespace evaluation;

namespace fs = std::filesystem;

namespace {

/// End of the scale of all difference maps, in units of 1/255: one scale, so that rows compare.
constexpr double kMapLimit = 20;

/// Whether pictures of a view are written.
bool keeps_picture(const std::string& view) { return view == "paper" || view == "inside"; }

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
            fmt::format("{}: results of {} views, expected {} (without resume they are replaced)",
                        file.string(), earlier.views.size(), now.views.size()));
    return std::move(earlier.rows);
}

/// Pictures of the voxels that every row is compared with, [views].
struct References {
    std::vector<DepthImage> depth;
    std::vector<Image> shaded;
};

/// One evaluation: its references, its rows and its files.
class Run {
  public:
    /// cells  in place of volumes, or without sources
    Run(const VolumeSet& data, const Scene& cells, fs::path folder, const EvaluateOptions& options)
        : data_(data),
          cells_(cells),
          volumes_(data.volumes),
          folder_(std::move(folder)),
          options_(options),
          processes_(collective_or_single(options.collective)),
          tf_(load_transfer_function(options.tf)),
          evaluation_(begin_evaluation(data.volumes, options)) {
        if (has_cells())
            take_cells();
        else if (data.is_mesh())
            take_visible();
        else
            box_ = box_of(volumes_, processes_);
        evaluation_.views = evaluation_views(box_);
        if (options.read_fields) {
            fields_ = FieldComparison(volumes_, box_, evaluation_.views, options);
            // Tiles are divided where a field varies.
            volumes_ = fields_.volumes();
            if (data.is_mesh()) {
                mesh_.parts.assign(volumes_.begin(), volumes_.end());
                volumes_ = mesh_.parts;
            }
        }
        if (has_cells()) fields_ = FieldComparison(cells_, evaluation_.views, options);
        evaluation_.fields = fields_.names();
        if (options.voxels && ((!data.is_mesh() && volumes_.size() != 1) || options.collective))
            throw Error(
                fmt::format("{}: the field error is of one volume or mesh by one process, expected "
                            "no volumes that add up, nor parts",
                            evaluation_.title));
        evaluation_.voxels = options.voxels;
        if (options.by_value) {
            if (data.is_mesh()) visible_.volumes = mesh_.parts;
            if (has_cells())
                by_value_.emplace(cells_, options);
            else
                by_value_.emplace(data.is_mesh() ? visible_ : data, box_, options);
            evaluation_.functions = by_value_->names();
        }
        steps_ = static_cast<double>(evaluation_.views.size() * (options.conversions.size() + 1));
    }

    Evaluation run() {
        const std::vector<EvaluationRow> kept =
            kept_rows(folder_ / "results.json", evaluation_, options_);
        if (is_root()) make_folder(folder_ / "pictures");
        draw_references();
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
        write_csv(folder_ / "results.csv", evaluation_);
        return evaluation_;
    }

  private:
    bool is_root() const { return processes_.is_root(); }

    bool has_cells() const { return !cells_.sources.empty(); }

    void take_cells() {
        const Gaussians& each = *cells_.model().model;
        cells_.subject = box_ = each.box;
        evaluation_.title = each.source;
        evaluation_.active_voxels = each.size();
        evaluation_.mass = mass(each);
    }

    /// The visible voxels of a mesh, which are converted in place of its levels.
    void take_visible() {
        mesh_ = composite(data_);
        if (mesh_.parts.empty())
            throw Error(fmt::format("{}: no visible voxel, expected active voxels inside the masks",
                                    evaluation_.title));
        volumes_ = mesh_.parts;
        box_ = mesh_.box;
        evaluation_.active_voxels = mesh_.voxels;
        evaluation_.mass = 0;
        for (const Volume& part : volumes_) evaluation_.mass += mass(part);
    }

    /// Time of the slowest process, ms.
    template <class Work>
    double shared_ms(const Work& work) const {
        double ms = milliseconds(work);
        processes_.max(std::span(&ms, 1));
        return ms;
    }

    /// Draws T at extinction 1 from a view: options.repeats times after one that does not count.
    /// aabb_sigma  as Conversion has it
    DepthImage timed_depth(PictureRenderer& renderer, const EvaluationView& view, double aabb_sigma,
                           Timing& timing) const {
        PictureRequest request;
        request.camera = view.camera;
        request.width = options_.width, request.height = options_.height;
        request.options.aabb_sigma = aabb_sigma;
        const ResolvedPicture picture = resolve(request, renderer.scene());
        Sums sums;
        std::vector<double> ms;
        for (int n = 0; n <= options_.repeats; ++n)
            ms.push_back(shared_ms([&] { renderer.draw(picture, sums); }));
        ms.erase(ms.begin());
        timing = timing_of(std::move(ms));
        DepthImage depth;
        depth.width = sums.width, depth.height = sums.height;
        depth.depth = std::move(sums.column);
        return depth;
    }

    void advance(std::size_t steps) {
        done_ += static_cast<double>(steps);
        if (options_.progress) options_.progress(done_ / steps_);
    }

    void draw_references() {
        PictureRenderer renderer(
            has_cells() ? cells_
                        : scene_in(box_, VoxelSource{borrowed(data_), {}}, options_.collective));
        for (EvaluationView& view : evaluation_.views) {
            DepthImage depth = timed_depth(renderer, view, 0, view.reference);
            view.extinction =
                options_.extinction > 0
                    ? options_.extinction
                    : shading::auto_extinction_of(
                          depth, volumes_.empty() ? cells_.name : volumes_.front().source);
            const auto covered = std::ranges::count_if(depth.depth, [](float t) { return t > 0; });
            view.covered = static_cast<double>(covered) / static_cast<double>(depth.depth.size());
            set_extinction(depth, view.extinction);
            references_.shaded.push_back(shade(depth, tf_));
            references_.depth.push_back(std::move(depth));
            if (is_root() && keeps_picture(view.name))
                write_png(folder_ / "pictures" / fmt::format("reference-{}.png", view.name),
                          references_.shaded.back());
            advance(1);
        }
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
        if (has_cells()) {
            const MomentOptions moments = conversion.moments(budget);
            CellOptions chosen;
            chosen.budget = moments.budget, chosen.error = moments.error;
            return convert_cells(*cells_.model().cells->cells, chosen);
        }
        if (data_.is_mesh() && conversion.moments)
            return fields_.empty() ? convert_moments(mesh_, conversion.moments(budget))
                                   : fields_.convert(mesh_, conversion.moments(budget));
        std::uint64_t all_voxels = 0;
        for (const Volume& volume : volumes_) all_voxels += active_voxels(volume);
        Gaussians model;
        for (const Volume& volume : volumes_) {
            const double share = static_cast<double>(active_voxels(volume)) /
                                 static_cast<double>(std::max<std::uint64_t>(all_voxels, 1));
            const auto part_budget = static_cast<std::size_t>(static_cast<double>(budget) * share);
            Gaussians part =
                conversion.moments && !fields_.empty()
                    ? fields_.convert(static_cast<std::size_t>(&volume - volumes_.data()),
                                      conversion.moments(part_budget))
                    : conversion.convert(volume, part_budget);
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
        describe(model, conversion, row);
        PictureRenderer renderer(scene_in(box_, model, options_.collective));
        for (std::size_t n = 0; n < evaluation_.views.size(); ++n) {
            Timing timing;
            DepthImage depth =
                timed_depth(renderer, evaluation_.views[n], conversion.aabb_sigma, timing);
            if (is_root()) {
                row.views.push_back(compare_view(row, n, depth));
                row.views.back().render = timing;
            }
            advance(1);
        }
        if (conversion.aabb_sigma > 0) return row;  // boxes are of T
        fields_.compare(model, row, conversion.moments && !fields_.empty());
        if (by_value_) row.values = by_value_->compare(model);
        if (options_.voxels)
            row.voxels =
                data_.is_mesh()
                    ? voxel_error(volumes_, model)
                    : voxel_error(volumes_.front(),
                                  voxelize(model, volumes_.front().world_from_index).volume);
        return row;
    }

    /// Counts, bytes and mass of a model, of which each process has a part.
    void describe(const Gaussians& model, const Conversion& conversion, EvaluationRow& row) const {
        row.gaussians = model.size();
        allreduce_sum(processes_, row.gaussians);
        double rotated = model.axis_aligned() ? 0 : 1;  // an empty part is axis-aligned
        processes_.max(std::span(&rotated, 1));
        Gaussians about;  // header of the whole model
        about.cutoff = model.cutoff, about.origin = model.origin, about.box = model.box,
        about.source = model.source;
        about.method = model.method, about.options = model.options;
        about.summary = model.summary, about.source_voxels = model.source_voxels;
        // Rows made here are of T; fields are added to measure them.
        if (conversion.model) about.fields = empty_fields(model.fields);
        if (processes_.shared()) about.source_voxels = evaluation_.active_voxels;
        row.bytes = ply_header(about, row.gaussians, rotated > 0).size() +
                    row.gaussians * ply_row_floats(rotated > 0, about.fields) * sizeof(float);
        double model_mass = mass(model);
        processes_.sum(model_mass);
        row.mass_ratio = evaluation_.mass > 0 ? model_mass / evaluation_.mass : 1;
    }

    /// Metrics of one row from one view; writes the pictures of the views `paper` and `inside`.
    ViewResult compare_view(const EvaluationRow& row, std::size_t n, DepthImage& depth) const {
        const EvaluationView& view = evaluation_.views[n];
        set_extinction(depth, view.extinction);
        const Image shaded = shade(depth, tf_);
        const DepthDifference difference = compare(references_.depth[n], depth);
        if (keeps_picture(view.name)) {
            const auto file = [&](const char* kind) {
                return folder_ / "pictures" /
                       fmt::format("{}-{}-{}{}.png", row.series, row.step, view.name, kind);
            };
            write_png(file(""), shaded);
            write_png(file("-difference"),
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

    const VolumeSet& data_;
    Scene cells_;
    std::span<const Volume> volumes_;  ///< what is converted; of a mesh, the parts of mesh_
    Composite mesh_;
    VolumeSet visible_;  ///< these for pictures by value
    fs::path folder_;
    const EvaluateOptions& options_;
    const Collective& processes_;
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

Evaluation evaluate(const VolumeSet& data, const fs::path& folder, const EvaluateOptions& options) {
    check(options);
    if (data.volumes.empty()) throw Error("evaluate: no volume, expected at least one");
    validate(data);
    const bool may_be_empty = data.is_mesh() || collective_or_single(options.collective).shared();
    for (const Volume& volume : data.volumes)
        if (volume.empty() && !may_be_empty)
            throw Error(fmt::format("{}: no active voxel, expected at least one", volume.source));
    return Run(data, {}, folder, options).run();
}

Evaluation evaluate(const Scene& cells, const fs::path& folder, const EvaluateOptions& options) {
    check(options);
    if (options.voxels || options.read_fields || options.collective)
        throw Error("evaluate: cells have no field error on voxels, fields of voxels or ranks");
    for (const Conversion& one : options.conversions)
        if (!one.model && (!one.moments || one.aabb_sigma > 0))
            throw Error(fmt::format("evaluate: row {} {} converts voxels; use cell_conversions",
                                    one.series, one.step));
    return Run({}, cells, folder, options).run();
}

}  // namespace vog
