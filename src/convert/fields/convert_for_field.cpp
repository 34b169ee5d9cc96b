// convert_for_field.cpp: models with fields, whose cuts follow them; models for pictures of a field by value, whose errors
// choose their number and refine them.
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>

#include "compare/error_views.h"
#include "compare/values/field_error.h"
#include "compare/values/value_views.h"
#include "convert/fields/joint/value_rounds.h"
#include "convert/moments/error_search.h"
#include "convert/moments/moment_job.h"
#include "vog/convert_fields.h"
#include "vog/distributed.h"
#include "vog/error.h"
#include "vog/text.h"

namespace vog {

using namespace joint;

namespace {

/// What is converted, and for what.
struct ForField {
    std::function<Gaussians(const MomentOptions&, MomentReport*)> convert;  ///< without fields
    Box box;
    FittedData data;
    MomentOptions moments;
    const FieldOptions& options;

    bool has_error() const { return moments.error > 0 && !moments.budget && !moments.block_voxels; }
    /// Whether the error by value chooses the number of Gaussians though none is stated.
    bool is_default_image() const {
        const VoxelField& field = data.fields[data.field].front();
        return data.levels.front().is_image && field_names(data.fields)[data.field].own &&
               field.lower < field.upper && moments.error == 0 && !moments.budget &&
               !moments.block_voxels;
    }
    bool is_judged() const {
        return !options.joint_field.empty() &&
               (has_error() || moments.refine_seconds > 0 || is_default_image());
    }
};

/// Progress of a part of the call, its fractions from `first` to `last` of the whole.
Progress progress_part(const Progress& whole, double first, double last) {
    if (!whole) return {};
    return [=](double fraction) { whole(first + fraction * (last - first)); };
}

/// A model with its fields, and the errors of T before and after it got them.
struct Fitted {
    Gaussians model;
    MomentReport report;
    JointReport joint;
};

Fitted fitted(const ForField& job, const MomentOptions& moments,
              const comparison::ErrorViews& depths) {
    Fitted made;
    made.model = job.convert(moments, &made.report);
    made.joint.error_before = depths.relative_l2(made.model).worst;
    FieldOptions options = job.options;
    options.joint_report = nullptr, options.progress = {};
    const std::size_t count = made.model.size();
    add_fields(made.model, job.data.levels, job.data.fields, options);
    made.joint.removed = count - made.model.size();
    return made;
}

/// The smallest model whose error by value is low enough; where none is, that of the least error.
Fitted search(const ForField& job, MomentOptions moments, const comparison::ErrorViews& depths,
              const comparison::ValueViews& values) {
    const double target = std::exchange(moments.error, 0);
    if (moments.soft_steps < 0) moments.soft_steps = kSearchSoftSteps;
    const Progress progress = std::exchange(moments.progress, {});
    Fitted best;
    double best_error = std::numeric_limits<double>::infinity(), left = 1;
    const std::uint64_t finest = vog::moments::sample_count(job.data.levels);
    smallest_budget(target, finest, [&](std::size_t budget) {
        moments.budget = budget;
        Fitted made = fitted(job, moments, depths);
        // Flags of the whole call, in place of this try's budget.
        std::string& flags = made.model.options;
        flags.replace(0, flags.find(" --"), fmt::format("--error {}", target));
        const double error = values.relative_l2(made.model).worst;
        if (error <= target || error < best_error) best = std::move(made), best_error = error;
        constexpr double kLeft = 0.85;  // of the work after a try, which are up to a dozen
        left *= kLeft;
        if (progress) progress(1 - left);
        return error;
    });
    return best;
}

/// The model of the default of dense images, in few tries.
Fitted usual(const ForField& job, MomentOptions moments, const comparison::ErrorViews& depths,
             const comparison::ValueViews& values) {
    constexpr int kTries = 4;
    constexpr double kNear = 1.1;  // ratio to the error
    if (moments.soft_steps < 0) moments.soft_steps = kSearchSoftSteps;
    const Progress progress = std::exchange(moments.progress, {});
    const std::size_t voxels = vog::moments::sample_count(job.data.levels);
    const auto most = static_cast<double>(default_count(voxels));
    double count = std::min(double{kLeastOfImage}, most);
    for (int n = 1;; ++n) {
        moments.budget = static_cast<std::size_t>(count);
        Fitted made = fitted(job, moments, depths);
        const double ratio = values.relative_l2(made.model).worst / kDefaultValueError;
        if (progress) progress(static_cast<double>(n) / kTries);
        if (ratio <= kNear || count >= most || n == kTries) {
            made.report.stopped_by_count =
                ratio > kNear && count >= most && most < static_cast<double>(voxels);
            return made;
        }
        count = std::min(count * std::pow(ratio, 1 / -vog::moments::kErrorPower), most);
    }
}

/// The model, by the error of pictures by value.
Fitted judged(const ForField& job) {
    using Clock = std::chrono::steady_clock;
    const std::vector<VoxelField>& field = job.data.fields[job.data.field];
    if (field.front().is_vector())
        throw Error(fmt::format(
            "field {}: a vector, expected a scalar one for an error or refinement by value",
            printable(field.front().name)));
    const Progress& whole = job.moments.progress;
    const double converted = job.moments.refine_seconds > 0 ? 0.3 : 0.95;
    const comparison::ErrorViews depths(job.data.levels, job.box, job.options.periodic);
    const comparison::ValueViews values(job.data.levels, field, depths);
    MomentOptions moments = job.moments;
    moments.progress = progress_part(whole, 0, converted);
    const double seconds = std::exchange(moments.refine_seconds, 0);
    Fitted made = job.has_error()          ? search(job, moments, depths, values)
                  : job.is_default_image() ? usual(job, moments, depths, values)
                                           : fitted(job, moments, depths);
    if (seconds > 0) {
        const auto start = Clock::now();
        const Progress progress = progress_part(whole, converted, 1);
        const std::size_t count = made.model.size();
        refine_by_value(made.model, job.data, values, job.has_error() ? job.moments.error : 0, [&] {
            const double passed = std::chrono::duration<double>(Clock::now() - start).count();
            if (progress) progress(std::min(1.0, passed / seconds));
            return passed < seconds;
        });
        made.joint.removed += count - made.model.size();
        made.model.options += fmt::format(" --refine {}", seconds);
    }
    made.joint.error_after = depths.relative_l2(made.model).worst;
    made.joint.value_error = values.relative_l2(made.model).worst;
    if (whole) whole(1);
    return made;
}

/// Errors of the fields beside T's. Images of a periodic box are added later.
void add_field_errors(const ForField& job, const Gaussians& model, MomentReport& report) {
    if (job.options.periodic) return;
    const std::vector<FieldName> names = field_names(job.data.fields);
    const std::vector<Camera> views = error_views(job.data.levels, job.box);
    for (std::size_t f = 0; f < names.size(); ++f)
        if (!names[f].own)
            report.field_errors.emplace_back(
                names[f].name,
                comparison::field_error(job.data.levels, job.data.fields[f], model, views));
}

Gaussians run(const ForField& job, MomentReport* report) {
    MomentReport unwanted;
    MomentReport& of_cells = report ? *report : unwanted;
    if (job.is_judged()) {
        Fitted made = judged(job);
        of_cells = std::move(made.report);
        if (job.options.joint_report) *job.options.joint_report = made.joint;
        if (report) add_field_errors(job, made.model, *report);
        return std::move(made.model);
    }
    constexpr double kConverted = 0.6;
    MomentOptions moments = job.moments;
    moments.progress = progress_part(job.moments.progress, 0, kConverted);
    Gaussians model = job.convert(moments, &of_cells);
    FieldOptions options = job.options;
    if (options.joint_field.empty()) options.cells = of_cells.cells;
    options.progress = progress_part(job.moments.progress, kConverted, 1);
    add_fields(model, job.data.levels, job.data.fields, options);
    if (report && (report->measured_error >= 0 || !options.joint_field.empty()))
        add_field_errors(job, model, *report);
    return model;
}

FittedData fitted_data(std::span<const Volume> levels,
                       std::span<const std::vector<VoxelField>> fields,
                       const FieldOptions& options) {
    const std::string& name = options.joint_field;
    return {levels, fields, name.empty() ? 0 : find_joint_field(name, field_names(fields)),
            options.periodic};
}

/// Options of a conversion whose adaptive cut follows the fields.
MomentOptions carrying(MomentOptions moments, const FittedData& data) {
    if (!moments.block_voxels) moments.carried_fields = carried_fields(data.levels, data.fields);
    return moments;
}

}  // namespace

Gaussians convert_for_field(const Volume& volume, std::span<const std::vector<VoxelField>> fields,
                            const MomentOptions& moments, const FieldOptions& options,
                            MomentReport* report) {
    const auto convert = [&](const MomentOptions& with, MomentReport* of) {
        return convert_moments(volume, with, of);
    };
    const FittedData data = fitted_data({&volume, 1}, fields, options);
    return run({convert, world_box(volume), data, carrying(moments, data), options}, report);
}

std::string resolved_joint_field(const std::string& joint_field, std::span<const Volume> volumes) {
    if (!joint_field.empty()) return joint_field == "none" ? "" : joint_field;
    const bool images = !volumes.empty() && std::ranges::all_of(volumes, &Volume::is_image);
    return images ? "volume" : "";
}

Gaussians convert_by_default(const Volume& volume, MomentOptions moments) {
    const std::string joint_field = resolved_joint_field({}, {&volume, 1});
    if (joint_field.empty() || moments.own_field.empty()) return convert_moments(volume, moments);
    const std::vector<VoxelField> own{measure_field(volume, moments.own_field)};
    moments.own_field.clear();
    return convert_for_field(volume, {&own, 1}, moments, {.joint_field = joint_field});
}

Gaussians convert_for_field(const Composite& mesh, std::span<const std::vector<VoxelField>> fields,
                            const MomentOptions& moments, const FieldOptions& options,
                            MomentReport* report) {
    const auto convert = [&](const MomentOptions& with, MomentReport* of) {
        return convert_moments(mesh, with, of);
    };
    const FittedData data = fitted_data(mesh.parts, fields, options);
    return run({convert, mesh.box, data, carrying(moments, data), options}, report);
}

}  // namespace vog
