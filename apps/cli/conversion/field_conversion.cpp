// field_conversion.cpp: --field and --for of vog convert.
#include "conversion/field_conversion.h"

#include <fmt/core.h>

#include <algorithm>

#include "vog/error.h"

namespace vog::cli {

void add_joint(JointReport& all, const JointReport& one) {
    all.error_before = std::max(all.error_before, one.error_before);
    all.error_after = std::max(all.error_after, one.error_after);
    all.value_error = std::max(all.value_error, one.value_error);
    all.removed += one.removed;
}

std::string joint_text(const std::string& field, const JointReport& report) {
    std::string text = fmt::format("fitted to {}: measured error {:.4g} before, {:.4g} after",
                                   field, report.error_before, report.error_after);
    if (report.value_error >= 0) text += fmt::format("; error by value {:.4g}", report.value_error);
    if (report.removed)
        text += fmt::format(", {} Gaussians without voxels removed", report.removed);
    return text;
}

FieldTexts field_texts(const ConvertArguments& arguments, const std::string& own) {
    FieldTexts texts{arguments.fields, arguments.volume.grid, arguments.inputs,
                     arguments.volume.ones, own};
    if (!arguments.labels.empty()) texts.labels = arguments.fields.back();
    return texts;
}

std::string joint_field_of(const ConvertArguments& arguments, const FieldTexts& texts,
                           std::span<const Volume> volumes) {
    if (arguments.no_fields) return {};
    const std::vector<FieldName> names = names_of(texts, volumes);
    if (arguments.joint_field.empty()) return {};
    try {
        return names[find_joint_field(arguments.joint_field, names)].name;
    } catch (const Error& error) {
        throw Error(fmt::format("{}: {}", arguments.inputs.front(), error.what()));
    }
}

void add_fields_of(const FieldTexts& texts, const FieldOptions& options, std::span<Volume> volumes,
                   Gaussians& model, std::vector<std::string>& notes) {
    if (model.size() == 0) return;
    const auto fields = read_volume_fields(texts, volumes, notes);
    add_fields(model, volumes, fields, options);
}

Gaussians convert_for_field_of(const FieldTexts& texts, std::span<Volume> levels,
                               const Composite* mesh, const MomentOptions& moments,
                               const FieldOptions& options, MomentReport& report,
                               std::vector<std::string>& notes) {
    const auto fields = read_volume_fields(texts, levels, notes);
    return mesh ? convert_for_field(*mesh, fields, moments, options, &report)
                : convert_for_field(levels.front(), fields, moments, options, &report);
}

}  // namespace vog::cli
