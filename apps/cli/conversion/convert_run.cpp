// convert_run.cpp: options, notes and the report of a conversion.
#include "conversion/convert_run.h"

#include <fmt/ranges.h>

#include <filesystem>

#include "conversion/field_conversion.h"
#include "files/outputs.h"
#include "vog/distributed.h"
#include "vog/error.h"
#include "vog/memory.h"
#include "vog/model_io.h"
#include "vog/periodic.h"

namespace vog::cli {

namespace {

/// Stage times as text: "octree 98 ms, search 1200 ms".
std::string times_text(const std::vector<std::pair<std::string, double>>& stage_ms) {
    std::string text;
    for (const auto& [name, ms] : stage_ms)
        text += fmt::format("{}{} {:.3g} ms", text.empty() ? "" : ", ", name, ms);
    return text;
}

double share_of_voxels(const Converted& made) {
    return made.source_voxels
               ? static_cast<double>(made.gaussians) / static_cast<double>(made.source_voxels)
               : 0;
}

}  // namespace

MomentOptions moment_options(const ConvertArguments& arguments) {
    if (arguments.moments.budget && arguments.inputs.size() > 1 && arguments.volume.sum)
        throw UsageError(
            "--budget is the size of one model: expected one input, or levels of one mesh");
    return vog::moment_options(arguments);
}

std::optional<Box> period_of(const ConvertArguments& arguments, std::span<const Volume> volumes,
                             const Collective* collective) {
    std::optional<Box> period = period_of(arguments.points);
    if (period && period->empty()) period = domain_box(volumes, collective);
    if (period && period->empty())
        throw Error(fmt::format(
            "{}: the coarsest cells do not fill a box, so its active voxels do not state the "
            "domain, expected --periodic EDGE, --periodic X,Y,Z or --periodic x0,y0,z0,x1,y1,z1",
            arguments.inputs.front()));
    return period;
}

Hierarchy hierarchy_of(Gaussians& model, const ConvertArguments& arguments,
                       const std::optional<Affine>& index_from_world, Stages& stages) {
    // Readers of compact files build it (docs/compact.md).
    if (arguments.no_hierarchy || extension_of(arguments.output) == ".vogz") return {};
    return stages.run("hierarchy", [&] { return build_hierarchy(model, {index_from_world}); });
}

void note_missed(const std::string& input, double measured, double target) {
    note(fmt::format(
        "{}: measured error {:.4g} in the worst view, above --error {}: even the finest cut is "
        "smoother than the voxels; --error {:.2g} needs far fewer Gaussians",
        input, measured, target, 1.25 * measured));
}

bool is_model_output(const std::string& output) {
    return extension_of(output) == ".ply" || extension_of(output) == ".vogz";
}

Converted converted(const Gaussians& model, const Hierarchy& hierarchy, const std::string& output) {
    return {model.method,
            model.options,
            model.summary,
            model.size(),
            model.source_voxels,
            hierarchy.size(),
            std::filesystem::file_size(output),
            mass_without_images(model),
            model.fields.names(),
            {}};
}

nlohmann::ordered_json report(const ConvertArguments& arguments, FileKind kind,
                              const Converted& made, double volume_mass,
                              const MomentTotals& moments, const Stages& stages) {
    const double mass_ratio = volume_mass > 0 ? made.mass / volume_mass : 1;
    const bool by_moments = arguments.method == "moments";
    const MomentReport figures = moments.report(volume_mass);
    const double share = share_of_voxels(made);
    if (!arguments.json) {
        print_line(fmt::format("{}: {} Gaussians, {:.3g} % of {} {}, {}, mass ratio {:.5f}",
                               arguments.output, count_text(made.gaussians), 100 * share,
                               count_text(made.source_voxels),
                               kind == FileKind::points ? "particles" : "active voxels",
                               bytes_text(made.bytes), mass_ratio) +
                   (made.fields.empty()
                        ? std::string()
                        : fmt::format(", fields {}", fmt::join(made.fields, ", "))));
        // The file's summary repeats the counts; here what the first line lacks.
        const std::string details = by_moments ? detail_text(figures) : "";
        if (!details.empty()) print_line(details);
        if (!arguments.joint_field.empty())
            print_line(joint_text(arguments.joint_field, made.joint));
        if (by_moments) print_line(times_text(figures.stage_ms));
        return {};
    }
    nlohmann::ordered_json json = {
        {"output", arguments.output},
        {"method", made.method},
        {"options", made.options},
        {"gaussians", made.gaussians},
        {kind == FileKind::points ? "particles" : "active_voxels", made.source_voxels},
        {"share", share},
        {"nodes", made.nodes},
        {"bytes", made.bytes},
        {"mass_ratio", mass_ratio}};
    if (!made.fields.empty()) json["fields"] = made.fields;
    if (by_moments) {
        json["mass_ratio_before_threshold"] = figures.mass_ratio;
        json["dropped_mass_share"] = figures.dropped_mass_share;
        json["dropped_cells"] = figures.dropped_cells;
        if (figures.measured_error >= 0) {
            json["measured_error"] = figures.measured_error;
            json["mean_error"] = figures.mean_error;
            if (figures.interpolation_error >= 0) {
                json["interpolation_error"] = figures.interpolation_error;
                json["mean_interpolation_error"] = figures.mean_interpolation_error;
                json["as_near_as_interpolation"] = figures.as_near_as_interpolation();
            }
            json["stopped_by_count"] = figures.stopped_by_count;
            for (const auto& [name, error] : figures.field_errors)
                json["field_errors"][name] = error;
        }
        for (const auto& [name, ms] : figures.stage_ms) json["convert_ms"][name] = ms;
    }
    if (!arguments.joint_field.empty()) {
        json["joint"] = {{"field", arguments.joint_field},
                         {"error_before", made.joint.error_before},
                         {"error_after", made.joint.error_after},
                         {"removed", made.joint.removed}};
        if (made.joint.value_error >= 0) json["joint"]["value_error"] = made.joint.value_error;
    }
    for (const auto& [name, ms] : stages.times()) json["ms"][name] = ms;
    json["peak_memory"] = peak_memory();
    if (!made.notes.empty()) json["notes"] = made.notes;
    return json;
}

}  // namespace vog::cli
