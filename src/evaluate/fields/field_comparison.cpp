// field_comparison.cpp: errors of maps of fields, row by row.
#include "evaluate/fields/field_comparison.h"

#include "render/reference/reference.h"
#include "render/splat/fields/field_splat.h"
#include "vog/compare_maps.h"
#include "vog/convert_fields.h"
#include "vog/error.h"

namespace vog::evaluation {

FieldComparison::FieldComparison(std::span<const Volume> volumes, const EvaluateOptions& options)
    : volumes_(volumes.begin(), volumes.end()),
      fields_(options.read_fields(volumes_)),
      width_(options.width),
      height_(options.height) {
    for (const std::vector<VoxelField>& field : fields_)
        if (field.size() != volumes_.size())
            throw Error("evaluate: a field of another number of volumes, expected one for each");
}

std::vector<std::string> FieldComparison::names() const {
    std::vector<std::string> names;
    for (const std::vector<VoxelField>& field : fields_) names.push_back(field.front().name);
    return names;
}

std::vector<FieldMaps> FieldComparison::reference(const Camera& camera) const {
    std::vector<FieldMaps> maps;
    for (const std::vector<VoxelField>& field : fields_)
        maps.push_back(render_field_reference(
            volumes_, field, field.front().is_vector() ? FieldPart::view : FieldPart::value, camera,
            width_, height_));
    return maps;
}

void FieldComparison::compare(const Gaussians& model, const Evaluation& evaluation,
                              std::span<const std::vector<FieldMaps>> reference,
                              EvaluationRow& row) const {
    if (fields_.empty()) return;
    Gaussians with_fields = model;
    with_fields.fields = {};
    add_fields(with_fields, volumes_, fields_);
    for (std::size_t view = 0; view < row.views.size(); ++view)
        for (std::size_t f = 0; f < fields_.size(); ++f) {
            const FieldChoice choice = field_choice(fields_[f].front().name, with_fields.fields);
            const FieldMaps maps = render_field_splat(
                with_fields, choice, evaluation.views[view].camera, width_, height_);
            const FieldDifference difference = vog::compare(reference[view][f], maps);
            row.views[view].fields.push_back(
                {difference.mean_l2, difference.deviation_l2, difference.missing});
        }
}

}  // namespace vog::evaluation
