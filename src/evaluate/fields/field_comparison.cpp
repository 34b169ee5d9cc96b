// field_comparison.cpp: errors of maps of fields, row by row.
#include "evaluate/fields/field_comparison.h"

#include <utility>

#include "evaluate/evaluated_volumes.h"
#include "vog/compare_maps.h"
#include "vog/convert_fields.h"
#include "vog/error.h"
#include "vog/picture.h"

namespace vog::evaluation {

FieldComparison::FieldComparison(std::span<const Volume> volumes, const Box& box,
                                 std::span<const EvaluationView> views,
                                 const EvaluateOptions& options)
    : width_(options.width), height_(options.height) {
    VolumeSet set;
    set.volumes.assign(volumes.begin(), volumes.end());
    fields_ = options.read_fields(set.volumes);
    volumes_ = std::make_shared<const VolumeSet>(std::move(set));
    for (const EvaluationView& view : views) views_.push_back(view.camera);
    for (const std::vector<VoxelField>& field : fields_) {
        if (field.size() != volumes.size())
            throw Error("evaluate: a field of another number of volumes, expected one for each");
        const std::string& name = names_.emplace_back(field.front().name);
        VoxelSource source{volumes_, {}};
        source.fields.push_back({name, "", field.front().is_vector(), field});
        reference_.push_back(maps_of(scene_in(box, std::move(source)), name));
    }
}

FieldComparison::FieldComparison(const Scene& cells, std::span<const EvaluationView> views,
                                 const EvaluateOptions& options)
    : names_(options.cell_fields), width_(options.width), height_(options.height) {
    for (const EvaluationView& view : views) views_.push_back(view.camera);
    for (const std::string& name : names_) reference_.push_back(maps_of(cells, name));
}

std::vector<FieldMaps> FieldComparison::maps_of(Scene scene, const std::string& field) const {
    PictureRequest request;
    request.show = Show::mean, request.field = field;
    request.width = width_, request.height = height_;
    PictureRenderer renderer(std::move(scene));
    ResolvedPicture picture = resolve(request, renderer.scene());
    std::vector<FieldMaps> maps;
    for (const Camera& view : views_) {
        picture.request.camera = view;
        Sums sums;
        renderer.draw(picture, sums);
        maps.push_back({width_, height_, std::move(sums.column), std::move(sums.mean),
                        std::move(sums.deviation)});
    }
    return maps;
}

Gaussians FieldComparison::convert(std::size_t volume, const MomentOptions& moments) const {
    std::vector<std::vector<VoxelField>> own;
    for (const std::vector<VoxelField>& field : fields_) own.push_back({field[volume]});
    return convert_for_field(volumes_->volumes[volume], own, moments, {});
}

Gaussians FieldComparison::convert(const Composite& mesh, const MomentOptions& moments) const {
    return convert_for_field(mesh, fields_, moments, {});
}

void FieldComparison::compare(const Gaussians& model, EvaluationRow& row, bool made_here) const {
    if (empty()) return;
    Gaussians with_fields = model;
    if (!made_here && volumes_) {
        with_fields.fields = {};
        add_fields(with_fields, volumes_->volumes, fields_);
    }
    for (std::size_t f = 0; f < names_.size(); ++f) {
        const std::vector<FieldMaps> maps = maps_of(scene_in(model.box, with_fields), names_[f]);
        for (std::size_t view = 0; view < row.views.size(); ++view) {
            const FieldDifference difference = vog::compare(reference_[f][view], maps[view]);
            row.views[view].fields.push_back(
                {difference.mean_l2, difference.deviation_l2, difference.missing});
        }
    }
}

}  // namespace vog::evaluation
