// volume_conversion.cpp: load -> divide by labels -> convert -> fields -> save.
#include "conversion/volume_conversion.h"

#include <cmath>

#include "conversion/field_conversion.h"
#include "conversion/label_parts.h"
#include "files/outputs.h"
#include "options/field_options.h"
#include "vog/convert_moments.h"
#include "vog/error.h"
#include "vog/memory.h"
#include "vog/model_io.h"
#include "vog/periodic.h"

namespace vog::cli {

namespace {

/// Volumes of the levels without the voxels that finer levels hide.
Composite compose(const Levels& levels) {
    Composite data = composite(levels);
    if (data.parts.empty()) throw Error("--mask: no active voxel lies inside the masks");
    note(fmt::format("{} levels: {} voxels visible ({} of them partly), {} hidden by finer levels",
                     levels.volumes.size(), count_text(data.voxels), count_text(data.partly_hidden),
                     count_text(data.hidden)));
    return data;
}

/// The same of the error by value.
void note_missed_by_value(const std::string& input, double measured, double target) {
    note(
        fmt::format("{}: error by value {:.4g} in the worst view, above --error {}: the least of "
                    "all cuts that were tried",
                    input, measured, target));
}

/// Note where the default stopped before its error.
/// measured  "measured error 0.034"
void note_stopped(const std::string& input, const std::string& measured, double target) {
    note(fmt::format(
        "{}: {} in the worst view: the default stops at one Gaussian to {} voxels (at {} of small "
        "data) or at an error of {}, whichever is fewer; --error and --budget go on",
        input, measured, kVoxelsPerGaussian, count_text(kSmallCount), target));
}

class VolumeRun {
  public:
    VolumeRun(const ConvertArguments& arguments, const VolumeConversion& how, Stages& stages)
        : arguments_(arguments), how_(how), stages_(stages) {}

    nlohmann::ordered_json run() {
        load();
        choose_fields();
        stages_.run("convert", [&] { convert(); });
        if (!arguments_.no_fields && !own_alone_ && !carries_)
            stages_.run("fields", [&] { add_fields(); });
        print_notes(field_notes_);
        return written(joined());
    }

  private:
    bool is_mesh() const { return set_.is_mesh(); }
    std::vector<Volume>& volumes() { return is_mesh() ? mesh_.parts : set_.volumes; }

    void load() {
        set_ =
            stages_.run("load", [&] { return load_volumes(arguments_.inputs, arguments_.volume); });
        if (!arguments_.labels.empty())
            shares_ = stages_.run("labels", [&] { return divide_by_labels(arguments_, set_); });
        print_notes(set_.notes);
        how_.moments.periodic = period_of(arguments_, set_.volumes);
        if (is_mesh()) mesh_ = stages_.run("compose", [&] { return compose(set_); });
        Box box = mesh_.box;
        for (const Volume& volume : volumes()) {
            mass_ += mass(volume);
            if (!is_mesh()) box.include(world_box(volume));
        }
        how_.moments.origin = how_.paper.origin = model_origin(box);
    }

    void choose_fields() {
        const bool fits = how_.by_moments && !arguments_.no_fields && !arguments_.volume.ones;
        std::string& joint = arguments_.joint_field;
        if (!joint.empty() || (fits && arguments_.moments.spread == 1))
            joint = resolved_joint_field(joint, volumes());
        // Alone, the volumes' own values are summed with the cells.
        own_alone_ = fits && arguments_.fields.empty() && joint.empty();
        if (own_alone_) how_.moments.own_field = own_name(volumes());
        texts_ = field_texts(arguments_, own_name(volumes()));
        joint_field_ = joint_field_of(arguments_, texts_, volumes());
        // Adaptive cuts follow the fields, which must be read before.
        carries_ = !joint_field_.empty() || (how_.by_moments && !arguments_.no_fields &&
                                             !own_alone_ && !how_.moments.block_voxels);
    }

    void convert() {
        const auto make = [&](const auto& data, double data_mass) {
            MomentReport one;
            Gaussians part = how_.by_moments ? convert_moments(data, how_.moments, &one)
                                             : convert_paper(data, how_.paper);
            add(std::move(part), one, data_mass);
        };
        if (is_mesh()) return carries_ ? convert_for(volumes(), mass_) : make(mesh_, mass_);
        const std::size_t budget = how_.moments.budget;
        for (std::size_t n = 0; n < volumes().size(); ++n) {
            Volume& volume = volumes()[n];
            if (budget && !shares_.empty())
                how_.moments.budget =
                    static_cast<std::size_t>(std::ceil(double(budget) * shares_[n]));
            if (carries_)
                convert_for({&volume, 1}, mass(volume));
            else
                make(volume, mass(volume));
        }
    }

    /// By convert_for_field, with the fields that are carried.
    void convert_for(std::span<Volume> levels, double data_mass) {
        MomentReport one;
        JointReport joint;
        add(convert_for_field_of(
                texts_, levels, is_mesh() ? &mesh_ : nullptr, how_.moments,
                {{}, joint_field_, arguments_.joint_steps, &joint, how_.moments.periodic}, one,
                field_notes_),
            one, data_mass);
        const std::string& source = parts_.back().source;
        if (how_.moments.error > 0 && joint.value_error > how_.moments.error)
            note_missed_by_value(source, joint.value_error, how_.moments.error);
        else if (one.stopped_by_count && joint.value_error >= 0)
            note_stopped(source, fmt::format("error by value {:.4g}", joint.value_error),
                         kDefaultValueError);
        add_joint(joint_, joint);
    }

    void add(Gaussians part, const MomentReport& one, double part_mass) {
        const MomentOptions& moments = how_.moments;
        totals_.add(one, part_mass);
        if (!one.view_note.empty())
            view_notes_.push_back(fmt::format("{}: {}", part.source, one.view_note));
        if (one.stopped_by_count && one.measured_error >= 0)
            note_stopped(part.source, fmt::format("measured error {:.4g}", one.measured_error),
                         kDefaultError);
        if (joint_field_.empty() && moments.error > 0 && one.measured_error > moments.error &&
            !one.as_near_as_interpolation() && !moments.block_voxels && !moments.budget)
            note_missed(part.source, one.measured_error, moments.error);
        parts_.push_back(std::move(part));
        cells_.push_back(one.cells);
    }

    void add_fields() {
        const std::span<Volume> all = volumes();
        for (std::size_t n = 0; n < parts_.size(); ++n)
            add_fields_of(texts_, {.cells = cells_[n], .periodic = how_.moments.periodic},
                          is_mesh() ? all : all.subspan(n, 1), parts_[n], field_notes_);
    }

    /// The parts as one model, with what it says of itself.
    Gaussians joined() {
        Gaussians model = std::move(parts_.front());
        for (std::size_t n = 1; n < parts_.size(); ++n) append(model, parts_[n]);
        if (model.size() == 0)
            throw Error(
                fmt::format("{}: no Gaussian: no group of voxels has a mean density above --set "
                            "opacity-threshold={}",
                            arguments_.inputs.front(), how_.paper.opacity_threshold));
        if (how_.moments.periodic) add_periodic_images(model, *how_.moments.periodic);
        if (how_.by_moments)
            model.summary = summary_text(model, totals_.report(mass_), "active voxels");
        if (arguments_.volume.ones) model.options = "--measure volume " + model.options;
        if (arguments_.joint_field.empty()) return model;
        model.options += " --for " + arguments_.joint_field;
        if (arguments_.joint_steps != kJointSteps)
            model.options += fmt::format(" --set joint-steps={}", arguments_.joint_steps);
        model.summary += ", " + joint_text(arguments_.joint_field, joint_);
        return model;
    }

    nlohmann::ordered_json written(Gaussians model) {
        const Hierarchy hierarchy =
            hierarchy_of(model, arguments_, inverse(volumes().front().world_from_index), stages_);
        stages_.run("save", [&] { write_model(arguments_.output, model, hierarchy); });
        Converted made = converted(model, hierarchy, arguments_.output);
        made.joint = joint_;
        print_notes(view_notes_);
        for (const auto* notes : {&set_.notes, &field_notes_, &view_notes_})
            made.notes.insert(made.notes.end(), notes->begin(), notes->end());
        return report(arguments_, FileKind::volume, made, mass_, totals_, stages_);
    }

    ConvertArguments arguments_;
    VolumeConversion how_;
    Stages& stages_;
    LoadedVolumes set_;
    std::vector<double> shares_;  ///< of the budget, one a label
    Composite mesh_;              ///< of levels
    double mass_ = 0;             ///< of the volumes
    FieldTexts texts_;
    std::string joint_field_;  ///< of --for
    bool own_alone_ = false, carries_ = false;
    std::vector<Gaussians> parts_;                    ///< one a volume; of a mesh one
    std::vector<std::optional<UniformCells>> cells_;  ///< of each part
    MomentTotals totals_;
    JointReport joint_;
    std::vector<std::string> field_notes_, view_notes_;
};

}  // namespace

nlohmann::ordered_json convert_volumes(const ConvertArguments& arguments,
                                       const VolumeConversion& how, Stages& stages) {
    return VolumeRun(arguments, how, stages).run();
}

}  // namespace vog::cli
