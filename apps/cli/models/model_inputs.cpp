// model_inputs.cpp: models of files, and of volumes and particles by the default conversion.
#include "models/model_inputs.h"

#include <fmt/core.h>

#include <filesystem>

#include "conversion/volume_fields.h"
#include "vog/convert_fields.h"
#include "vog/error.h"
#include "vog/site.h"
#include "vog/text.h"

namespace vog::cli {

ModelInputs::ModelInputs(const ModelArguments& arguments, Stages& stages)
    : arguments_(arguments),
      stages_(stages),
      kind_(common_kind(arguments.inputs, arguments.volume.grid)) {
    const std::vector<std::string> models = models_of_one_site(arguments.inputs);
    if (!models.empty()) note_first_model(arguments.inputs.front(), models);
}

/// Volumes, or the levels of one mesh, converted by moments. Each level of detail is a conversion
/// of its own, about 4 dB better than coarsening the finest one (docs/web.md).
/// most     number of levels of detail at most
/// lattice  receives the map to the voxels of the volume or of the coarsest level; null: not wanted
std::vector<Gaussians> ModelInputs::convert_volumes(std::size_t most,
                                                    std::optional<Affine>* lattice) {
    const LoadedVolumes set = load_volumes(arguments_.inputs, arguments_.volume);
    notes_ = set.notes;
    print_notes(notes_);
    if (lattice) *lattice = inverse(set.volumes.front().world_from_index);
    const bool several = !set.is_mesh() && set.volumes.size() > 1;
    if (several && arguments_.budget)
        throw UsageError(
            "--budget is the size of one model: expected one input, or levels of one mesh");
    const Composite mesh = set.is_mesh() ? composite(set) : Composite{};
    if (set.is_mesh() && mesh.parts.empty())
        throw Error("--mask: no active voxel lies inside the masks");
    MomentOptions options;
    if (!arguments_.no_fields) options.own_field = own_name(set.volumes);
    if (several) {
        Gaussians sum;
        for (const Volume& volume : set.volumes) append(sum, convert_by_default(volume, options));
        return detail_levels(std::move(sum), most);
    }
    options.progress = stages_.progress();
    const auto convert = [&](std::size_t budget) {
        options.budget = budget;
        return set.is_mesh() ? convert_moments(mesh, options)
                             : convert_by_default(set.volumes.front(), options);
    };
    std::vector<Gaussians> models{convert(arguments_.budget)};
    for (const std::size_t budget : detail_budgets(models.front().size(), most))
        models.push_back(convert(budget));
    return models;
}

Gaussians ModelInputs::convert_particles() {
    PointOptions options = point_options(arguments_.points);
    options.budget = arguments_.budget;
    options.progress = stages_.progress();
    const Points points =
        load_points(arguments_.inputs, arguments_.points, arguments_.volume, notes_);
    Gaussians model = convert_points(points, options);
    print_notes(notes_);
    return model;
}

void ModelInputs::note_conversion(const Gaussians& model) const {
    note(fmt::format("{}: converted with the default options of vog convert: {} Gaussians",
                     arguments_.inputs.front(), count_text(model.size())));
}

InputModel ModelInputs::read(std::size_t n, bool with_hierarchy) {
    const std::string& file = arguments_.inputs[n];
    InputModel input{model_name(file), {}};
    if (kind_ == FileKind::model) {
        input.model = stages_.run("load", [&] {
            return load_model(file, with_hierarchy ? &input.hierarchy : nullptr,
                              arguments_.volume.values);
        });
        if (arguments_.no_fields) input.model.fields = input.hierarchy.nodes.fields = {};
        if (arguments_.budget && input.model.size() > arguments_.budget)
            input.model = coarsen(input.model, arguments_.budget), input.hierarchy = {};
        return input;
    }
    stages_.run("convert", [&] {
        input.model = kind_ == FileKind::volume
                          ? convert_volumes(1, &input.index_from_world).front()
                          : convert_particles();
    });
    note_conversion(input.model);
    return input;
}

std::vector<Gaussians> ModelInputs::levels(std::size_t n, std::size_t most) {
    if (kind_ != FileKind::volume) {
        Gaussians model = read(n, false).model;
        return stages_.run("levels", [&] { return detail_levels(std::move(model), most); });
    }
    std::vector<Gaussians> all =
        stages_.run("convert", [&] { return convert_volumes(most, nullptr); });
    note_conversion(all.front());
    return all;
}

Gaussians ModelInputs::sum() {
    Gaussians all;
    for (std::size_t n = 0; n < count(); ++n) append(all, read(n, false).model);
    if (count() > 1) note(fmt::format("{}: the sum of {} models", arguments_.output, count()));
    return all;
}

std::string model_name(const std::string& file) {
    if (const auto site = find_site(file))
        return read_site_info(site->folder).models[site->model].name;
    return printable(std::filesystem::path(file).stem().string());
}

}  // namespace vog::cli
