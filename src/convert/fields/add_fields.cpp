// add_fields.cpp: fields of a finished model: joint moments of position and value over each Gaussian's part of the
// voxels, then the plane through them and what it leaves.
#include <fmt/ranges.h>

#include <algorithm>
#include <deque>
#include <optional>
#include <utility>

#include "compare/error_views.h"
#include "convert/fields/cell_fields.h"
#include "convert/fields/field_entries.h"
#include "convert/fields/joint/joint_steps.h"
#include "convert/fields/share_sums.h"
#include "core/paging.h"
#include "vog/convert_fields.h"
#include "vog/error.h"
#include "vog/text.h"

namespace vog {

using namespace joint;

namespace {

/// By the densities of the Gaussians.
void add_by_shares(const Gaussians& model, std::span<const Volume> levels,
                   std::span<const std::vector<VoxelField>> fields, const Layout& layout,
                   const FieldOptions& options, FieldEntries& entries) {
    const Progress& progress = options.progress;
    std::deque<SoftDivision> divisions;
    for (const Volume& volume : levels) divisions.emplace_back(model, volume, options.periodic);
    const SharedFields shared{model, levels, divisions, fields, layout};
    const SharePlanes found = find_planes(shared);
    if (progress) progress(0.5);
    const BigVector<double> residuals = find_residuals(shared, found.planes);
    for (std::size_t i = 0; i < model.size(); ++i) {
        keep_memory_at(i);
        entries.set(i, &found.planes[layout.parts.size() * i], &residuals[layout.residual_sums * i],
                    found.positions[i].mass);
    }
}

/// Fits the Gaussians to a field and sets all fields.
void add_fitted(Gaussians& model, std::span<const Volume> levels,
                std::span<const std::vector<VoxelField>> fields, const Layout& layout,
                const FieldOptions& options) {
    if (options.joint_steps < 1 || options.joint_steps > 1000)
        throw Error(fmt::format("{} joint steps, expected 1 to 1000", options.joint_steps));
    const JointSteps steps{find_joint_field(options.joint_field, field_names(fields)),
                           options.joint_steps,
                           {},
                           options.periodic};
    std::optional<comparison::ErrorViews> views;
    JointReport report;
    if (options.joint_report) {
        views.emplace(levels, model.box, options.periodic);
        report.error_before = views->relative_l2(model).worst;
    }
    FieldEntries entries(fields, layout, model.size());
    add_by_joint_steps(model, levels, fields, layout, steps, options.progress, entries);
    std::move(entries).move_to(model);
    const ScalarField* fitted = model.fields.find_scalar(fields[steps.field].front().name);
    model.content.by_value = fitted && fitted->is_measure;
    report.removed = remove_empty(model);
    if (!views) return;
    report.error_after = views->relative_l2(model).worst;
    *options.joint_report = report;
}

}  // namespace

std::size_t find_joint_field(const std::string& joint_field, std::span<const FieldName> fields) {
    const auto named = std::ranges::find(fields, joint_field, &FieldName::name);
    const auto found = named == fields.end() && joint_field == "volume"
                           ? std::ranges::find(fields, true, &FieldName::own)
                           : named;
    if (found != fields.end()) return static_cast<std::size_t>(found - fields.begin());
    std::vector<std::string> names;
    for (const FieldName& field : fields) names.push_back(printable(field.name));
    throw Error(fmt::format("no field '{}' to fit the Gaussians to (there are: {})",
                            printable(joint_field), fmt::join(names, ", ")));
}

std::vector<FieldName> field_names(std::span<const std::vector<VoxelField>> fields) {
    std::vector<FieldName> names;
    for (const std::vector<VoxelField>& field : fields) {
        const VoxelField& first = field.front();
        names.push_back({first.name, !first.is_vector() && first.component.front().leaf.empty() &&
                                         first.component.front().tile.empty()});
    }
    return names;
}

void add_fields(Gaussians& model, std::span<const Volume> levels,
                std::span<const std::vector<VoxelField>> fields, const FieldOptions& options) {
    for (const std::vector<VoxelField>& field : fields) {
        if (field.size() != levels.size())
            throw Error(fmt::format("field {}: {} volumes, expected {}",
                                    field.empty() ? "" : field.front().name, field.size(),
                                    levels.size()));
        if (model.fields.find_scalar(field.front().name) ||
            model.fields.find_vector(field.front().name))
            throw Error(fmt::format("{}: the model has a field '{}' already", model.source,
                                    field.front().name));
    }
    if (fields.empty() || model.size() == 0) return;
    const Layout layout(fields);
    if (!options.joint_field.empty()) {
        add_fitted(model, levels, fields, layout, options);
        if (options.progress) options.progress(1);
        return;
    }
    std::optional<FieldEntries> entries(std::in_place, fields, layout, model.size());
    const bool by_cells =
        options.cells && levels.size() == 1 &&
        add_by_cells(levels.front(), layout.components(levels.front(), fields, 0), layout,
                     {*options.cells, model.size(), options.periodic}, options.progress, *entries);
    if (!by_cells) {
        entries.emplace(fields, layout, model.size());
        add_by_shares(model, levels, fields, layout, options, *entries);
    }
    std::move(*entries).move_to(model);
    if (options.progress) options.progress(1);
}

}  // namespace vog
