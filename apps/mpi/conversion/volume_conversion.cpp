// volume_conversion.cpp: distributed conversion, one part of the data a rank, to one model.
//
// Uniform hard cells and the paper's method treat one cell or one leaf at a time, so parts aligned to
// cells or leaves give the Gaussians of a single process; only the threshold for dropped cells is
// global, from histograms of mass summed over the ranks. An adaptive cut is not local: each part is
// cut by itself with a share of the budget (docs/scaling.md has the loss), and --error searches the
// smallest total budget whose global error is low enough.
#include "conversion/volume_conversion.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "conversion/whole_error.h"
#include "fields/part_fields.h"
#include "inputs_part.h"
#include "vog/budget_search.h"
#include "vog/distributed.h"
#include "vog/error.h"
#include "vog/periodic.h"

namespace vog::mpi {

namespace {

using cli::ConvertArguments;
using cli::MomentTotals;
using cli::VolumeConversion;

/// Whether cells are uniform and hard: then the union of the parts' models is the model of a single
/// process.
bool uniform(const VolumeConversion& conversion) {
    return conversion.by_moments && conversion.moments.block_voxels &&
           conversion.moments.soft_steps == 0;
}

/// throws cli::UsageError for options that only a single process supports
void check(const VolumeConversion& conversion, const Ranks& ranks) {
    const auto refuse = [](const std::string& option, const std::string& why) {
        throw cli::UsageError(
            fmt::format("{}: {}; expected one process (vog convert)", option, why));
    };
    // Uniform cells are one collective conversion, of one rank, too.
    const bool uniform_cells =
        conversion.moments.block_voxels && conversion.moments.soft_steps <= 0;
    if (conversion.by_moments && conversion.moments.refine_seconds > 0 &&
        (ranks.count() > 1 || uniform_cells))
        refuse("--refine", "ranks would stop at different times");
    if (ranks.count() == 1) return;
    const auto ranks_count = static_cast<std::size_t>(ranks.count());
    if (conversion.by_moments && conversion.moments.budget &&
        conversion.moments.budget < ranks_count)
        throw cli::UsageError(
            fmt::format("--budget {}: expected at least one Gaussian per rank, {}",
                        conversion.moments.budget, ranks_count));
    if (conversion.by_moments) return;
    if (conversion.paper.strategy == Strategy::variance_clusters)
        refuse("--set strategy=variance", "its threshold depends on the values of all leaves");
    if (conversion.paper.strategy == Strategy::leaf_clusters)
        refuse("--set strategy=neighbours", "clusters go across parts");
}

/// Edge of the aligned cubes that no part divides, voxels: one Gaussian never spans two of them.
int align_voxels(const VolumeConversion& conversion) {
    if (conversion.by_moments) return std::max(kLeafEdge, conversion.moments.block_voxels);
    if (conversion.paper.strategy != Strategy::tree_mirror) return kLeafEdge;
    const int depth = conversion.paper.tree_depth;
    return depth == 1 ? 4096 : depth == 2 ? 128 : kLeafEdge;
}

/// This rank's part of one input, or of all levels of a mesh.
struct InputPart {
    std::vector<Volume> volumes;  ///< densities add up; of a mesh: without voxels hidden by finer
    Box box;                      ///< of this part, world units
    std::uint64_t voxels = 0;     ///< active
};

/// This rank's part of every level without the voxels that finer levels hide.
InputPart composed(const std::vector<VolumeSet>& sets) {
    InputPart part;
    for (const VolumeSet& one : sets) {
        Composite all = composite(one);
        // The finer levels only mask here: their visible voxels belong to other parts.
        Levels over = one;
        over.volumes.pop_back();
        if (!over.masks.empty()) over.masks.pop_back();
        std::erase_if(all.parts, [](const Volume& volume) { return mass(volume) == 0; });
        part.voxels += all.voxels;
        if (!over.volumes.empty()) part.voxels -= composite(over).voxels;
        std::ranges::move(all.parts, std::back_inserter(part.volumes));
    }
    return part;
}

std::vector<InputPart> input_parts(VolumesPart& from) {
    if (from.is_mesh()) return {composed(from.sets)};
    std::vector<InputPart> parts(from.volumes);
    for (std::size_t n = 0; n < from.sources.size(); ++n) {
        InputPart& part = parts[from.sources[n]];
        part.volumes.push_back(std::move(from.sets.front().volumes[n]));
        part.voxels = active_voxels(part.volumes.front());
    }
    return parts;
}

/// throws vog::Error, on all ranks, for an input without mass: as convert_moments does for one
/// process, which a rank cannot know from its part
void require_mass(const std::vector<InputPart>& parts, const Ranks& ranks) {
    std::vector<double> masses;
    for (const InputPart& part : parts) {
        masses.push_back(0);
        for (const Volume& volume : part.volumes) masses.back() += mass(volume);
    }
    ranks.sum(masses);
    for (std::size_t n = 0; n < masses.size(); ++n)
        if (!(masses[n] > 0))
            throw Error(
                fmt::format("volume {} of {}: the mass is {}, expected a positive finite one",
                            n + 1, masses.size(), masses[n]));
}

/// Converter of this rank's parts, with totals over all ranks.
class PartConversion {
  public:
    /// carried  [inputs] fields that adaptive cuts follow; empty: none
    PartConversion(const VolumeConversion& conversion, const VolumesPart& from,
                   std::vector<std::vector<CarriedField>> carried, const Ranks& ranks)
        : conversion_(conversion),
          from_(from),
          carried_(std::move(carried)),
          ranks_(ranks),
          collective_(uniform(conversion) && !from.by_files) {}

    /// One model per input, of this rank's part of it; may be empty.
    /// budget  Gaussians of all ranks and inputs; 0: the one of the options
    std::vector<Gaussians> convert(const std::vector<InputPart>& parts, std::size_t budget = 0) {
        budget_ = budget ? budget : conversion_.moments.budget;
        mass_ = 0;
        totals_ = {};
        cells_.clear();
        std::vector<Gaussians> models;
        for (const InputPart& part : parts) models.push_back(convert(part));
        return models;
    }
    /// This rank's part of every input in the smallest model whose error, over all ranks, is at most
    /// the requested one.
    /// interpolation  as find_budget has it
    std::vector<Gaussians> search(const std::vector<InputPart>& parts, const WholeError& error,
                                  RelativeError& interpolation) {
        ErrorSearch search;
        search.finest = from_.active_voxels;
        search.few = default_count(search.finest);
        search.beyond_few = conversion_.moments.error > 0;
        search.target = search.beyond_few ? conversion_.moments.error : kDefaultError;
        std::vector<Gaussians> tried, best;
        MomentTotals totals;  // of the best: each conversion overwrites totals_
        search.error_of_budget = [&](std::size_t budget) {
            tried = convert(parts, budget);
            return error.of(tried);
        };
        search.keep = [&] { best = std::move(tried), totals = totals_; };
        search.error_of_voxels = [&] { return search.error_of_budget(search.finest); };
        find_budget(search, interpolation);
        totals_ = totals;
        return best;
    }
    /// MomentReport::cells of the last conversion, by input.
    const std::vector<std::optional<UniformCells>>& cells() const { return cells_; }
    /// Mass of the data of the last conversion: all ranks, all inputs.
    double data_mass() const {
        double sum = mass_;
        ranks_.sum(std::span(&sum, 1));
        return sum;
    }
    /// Totals of the last conversion: all ranks, all inputs.
    MomentTotals totals() const {
        MomentTotals all = totals_;
        double sums[3] = {all.sums.mass_ratio, all.sums.dropped_mass_share,
                          double(all.sums.dropped_cells)};
        ranks_.sum(sums);
        all.sums.mass_ratio = sums[0];
        all.sums.dropped_mass_share = sums[1];
        all.sums.dropped_cells = static_cast<std::size_t>(sums[2]);
        return all;
    }

  private:
    Gaussians convert(const InputPart& part) {
        double part_mass = 0;
        for (const Volume& volume : part.volumes) part_mass += mass(volume);
        mass_ += part_mass;
        cells_.emplace_back();
        if (!conversion_.by_moments) return by_paper(part);
        if (collective_) return uniform_cells(part, part_mass);
        if (part_mass == 0) return {};
        MomentReport report;
        MomentOptions options = conversion_.moments;
        if (!options.block_voxels) options.budget = budget_of(part);
        if (!carried_.empty()) options.carried_fields = carried_[cells_.size() - 1];
        options.measure = false;  // the whole model is measured at the end
        Gaussians model = by_moments(part, options, &report);
        totals_.add(report, part_mass);
        cells_.back() = report.cells;
        return model;
    }
    Gaussians by_paper(const InputPart& part) const {
        Gaussians model;
        for (const Volume& volume : part.volumes)
            if (!volume.empty()) append(model, convert_paper(volume, conversion_.paper));
        return model;
    }
    Gaussians by_moments(const InputPart& part, const MomentOptions& options,
                         MomentReport* report) const {
        if (!from_.is_mesh()) return convert_moments(part.volumes.front(), options, report);
        Composite data{part.volumes, from_.box, from_.content, part.voxels};
        // A rank without voxels still takes part in the collective sums.
        if (data.parts.empty()) data.parts.emplace_back();
        return convert_moments(data, options, report);
    }
    Gaussians uniform_cells(const InputPart& part, double part_mass) {
        MomentOptions options = conversion_.moments;
        options.measure = false;  // the whole model is measured at the end
        options.collective = &ranks_.collective();
        MomentReport report;
        Gaussians model = by_moments(part, options, &report);
        ranks_.sum(std::span(&part_mass, 1));
        // The report is global on every rank already, so the root alone adds it.
        if (ranks_.first()) totals_.add(report, part_mass);
        cells_.back() = report.cells;
        return model;
    }
    /// Share of the budget in proportion to the part's active voxels, at least 1. Each voxel has a Gaussian where the whole
    /// has one for each.
    std::size_t budget_of(const InputPart& part) const {
        if (ranks_.count() == 1) return budget_;
        if (budget_ >= from_.active_voxels) return std::max<std::uint64_t>(part.voxels, 1);
        // One Gaussian a rank is set aside, so that the shares never sum to more than the budget.
        const double divided =
            std::max(0.0, static_cast<double>(budget_) - static_cast<double>(ranks_.count()));
        const double share =
            static_cast<double>(part.voxels) / static_cast<double>(from_.active_voxels);
        return 1 + static_cast<std::size_t>(std::floor(divided * std::min(share, 1.0)));
    }

    const VolumeConversion& conversion_;
    const VolumesPart& from_;
    const std::vector<std::vector<CarriedField>> carried_;
    const Ranks& ranks_;
    bool collective_ = false;  ///< every input is one collective conversion of all ranks
    std::size_t budget_ = 0;
    double mass_ = 0;
    MomentTotals totals_;
    std::vector<std::optional<UniformCells>> cells_;
};

/// The text of the lowest rank that has one.
std::string first_text(const Ranks& ranks, const std::string& text) {
    for (const std::string& one : ranks.gather(text))
        if (!one.empty()) return one;
    return {};
}

/// Options of the whole model as flags: a part's, with the budget or the error of the whole in
/// place of the part's own budget, wherever that stands among them.
std::string whole_options(std::string part_options, const VolumeConversion& conversion,
                          const Ranks& ranks) {
    if (!conversion.by_moments || uniform(conversion)) return part_options;
    const std::string flag = "--budget ";
    const std::size_t at = part_options.find(flag);
    if (!conversion.moments.block_voxels && at != std::string::npos) {
        const std::size_t end =
            std::min(part_options.find(' ', at + flag.size()), part_options.size());
        part_options.replace(
            at, end - at,
            conversion.moments.budget      ? fmt::format("--budget {}", conversion.moments.budget)
            : conversion.moments.error > 0 ? fmt::format("--error {}", conversion.moments.error)
                                           : "");
        if (at == 0 && part_options.starts_with(' ')) part_options.erase(0, 1);
    }
    return ranks.count() == 1 ? part_options
                              : fmt::format("{} (in {} parts)", part_options, ranks.count());
}

/// Content of an input that is divided among the ranks.
Content content_of_all(const std::vector<Volume>& volumes, const Ranks& ranks) {
    Box box;
    std::vector<const Volume*> pointers;
    for (const Volume& volume : volumes) {
        if (!volume.empty()) box.include(world_box(volume));
        pointers.push_back(&volume);
    }
    return content_of(pointers, ranks.box_union(box), &ranks.collective());
}

/// The header of the file: source, options and counts of the whole of each input, joined.
Gaussians description_of(const std::vector<InputPart>& parts, const std::vector<Gaussians>& models,
                         const VolumesPart& from, const VolumeConversion& conversion,
                         const Ranks& ranks) {
    Gaussians all;
    for (std::size_t n = 0; n < parts.size(); ++n) {
        Gaussians one;
        one.source = first_text(ranks, models[n].source);
        one.method = conversion.by_moments ? "moments" : "paper";
        one.options = whole_options(first_text(ranks, models[n].options), conversion, ranks);
        one.cutoff =
            static_cast<float>(ranks.max(models[n].source.empty() ? 0.0 : models[n].cutoff));
        one.source_voxels = ranks.sum(parts[n].voxels);
        one.content = from.is_mesh() ? from.content : content_of_all(parts[n].volumes, ranks);
        append(all, one);
    }
    all.box = from.box;
    all.origin = model_origin(from.box);
    return all;
}

/// Reference images of the volumes of all inputs, to measure models against.
WholeError error_of(const std::vector<InputPart>& parts, const Box& box,
                    const std::optional<Box>& period, const Ranks& ranks) {
    std::vector<Volume> volumes;
    for (const InputPart& part : parts)
        volumes.insert(volumes.end(), part.volumes.begin(), part.volumes.end());
    return {std::move(volumes), box, period, ranks};
}

/// Uniform cells are hard unless soft steps are given: overlapping cells, the default of vog
/// convert, need voxels of other parts.
VolumeConversion hard_by_default(VolumeConversion options, const Ranks& ranks) {
    MomentOptions& moments = options.moments;
    if (!options.by_moments || !moments.block_voxels || moments.soft_steps >= 0) return options;
    moments.soft_steps = 0;
    if (ranks.first())
        cli::note(
            "uniform cells are hard (as vog convert --set soft-steps=0): overlapping cells need "
            "voxels of other parts; --set soft-steps=N softens each part by itself");
    return options;
}

/// Map to the voxels of the volume, of a mesh's finest level, the same on every rank.
std::optional<Affine> lattice_of(const VolumesPart& from, const Ranks& ranks) {
    std::optional<Affine> own;
    double edge = std::numeric_limits<double>::infinity();  // of a voxel
    if (!from.sets.empty() && !from.sets.front().volumes.empty()) {
        const std::vector<Volume>& volumes = from.sets.front().volumes;
        const Affine& world = (from.is_mesh() ? volumes.back() : volumes.front()).world_from_index;
        own = inverse(world);
        edge = length(world.linear.column(0));
    }
    const double finest = ranks.min(edge);
    const double first = ranks.min(own && edge == finest ? ranks.rank() : ranks.count());
    const bool chosen = first == ranks.rank();
    double numbers[12] = {};
    Affine lattice = own.value_or(Affine{});
    const auto each = [&](const auto& visit) {
        for (int axis = 0; axis < 3; ++axis) {
            for (int column = 0; column < 3; ++column)
                visit(numbers[4 * axis + column], lattice.linear(axis, column));
            visit(numbers[4 * axis + 3], lattice.translation[axis]);
        }
    };
    if (chosen) each([](double& number, double entry) { number = entry; });
    ranks.sum(numbers);
    if (first == ranks.count()) return {};
    each([](double number, double& entry) { entry = number; });
    return lattice;
}

/// Periodic box of --periodic, the same on every rank.
std::optional<Box> common_period(const ConvertArguments& arguments, const VolumesPart& from,
                                 const Ranks& ranks) {
    if (!arguments.points.periodic) return {};
    // This rank's parts of the levels of a mesh, or of the first volume.
    std::vector<Volume> volumes;
    for (std::size_t n = 0; n < from.sets.size(); ++n)
        if (from.is_mesh())
            volumes.push_back(from.sets[n].volumes.back());
        else if (!from.sources.empty() && from.sources.front() == 0)
            volumes.push_back(from.sets[n].volumes.front());
    return cli::period_of(arguments, volumes, &ranks.collective());
}

}  // namespace

ConvertedVolumes convert_parts(const ConvertArguments& arguments, const VolumeConversion& given,
                               cli::Stages& stages, const Ranks& ranks) {
    check(given, ranks);
    VolumeConversion options = hard_by_default(given, ranks);
    VolumesPart from = stages.run("load", [&] {
        return read_volumes_part(arguments.inputs, arguments.volume, ranks, align_voxels(options));
    });
    options.moments.origin = options.paper.origin = model_origin(from.box);
    const std::optional<Box> period = common_period(arguments, from, ranks);
    options.moments.periodic = period;
    ConvertedVolumes made;
    made.index_from_world = lattice_of(from, ranks);
    std::vector<InputPart> parts = stages.run("compose", [&] { return input_parts(from); });
    if (options.by_moments) require_mass(parts, ranks);
    // Hidden voxels of levels do not count, as in a single process.
    from.active_voxels = 0;
    for (const InputPart& part : parts) from.active_voxels += part.voxels;
    from.active_voxels = ranks.sum(from.active_voxels);
    SharedModel& model = made.model;
    const MomentOptions& moments = options.moments;
    std::vector<std::vector<Volume>*> volumes;
    for (InputPart& part : parts) volumes.push_back(&part.volumes);
    std::optional<PartFields> fields;
    const auto read_fields = [&] {
        fields.emplace(
            stages.run("load fields", [&] { return read_part_fields(arguments, volumes, ranks); }));
        if (ranks.first()) cli::print_notes(fields->notes);
        from.notes.insert(from.notes.end(), fields->notes.begin(), fields->notes.end());
    };
    // Adaptive cuts follow the fields. Uniform cells come first: reading divides tiles.
    if (!arguments.no_fields && options.by_moments && !moments.block_voxels) read_fields();
    PartConversion conversion(
        options, from, fields ? fields->carried : std::vector<std::vector<CarriedField>>{}, ranks);
    const bool searches = options.by_moments && !moments.block_voxels && !moments.budget;
    std::optional<WholeError> error;
    if (searches || (options.by_moments && moments.measure))
        stages.run("reference", [&] { error.emplace(error_of(parts, from.box, period, ranks)); });
    RelativeError interpolation = error ? error->interpolation() : RelativeError{};
    stages.run("convert", [&] {
        model.inputs =
            searches ? conversion.search(parts, *error, interpolation) : conversion.convert(parts);
        ranks.agree();
    });
    model.description = description_of(parts, model.inputs, from, options, ranks);
    MomentTotals totals = conversion.totals();
    const double data_mass = conversion.data_mass();
    if (error) {
        const RelativeError whole = stages.run("measure", [&] { return error->of(model.inputs); });
        totals.sums.measured_error = whole.worst, totals.sums.mean_error = whole.mean;
        totals.sums.interpolation_error = interpolation.worst;
        totals.sums.mean_interpolation_error = interpolation.mean;
        const double beyond =
            error_beyond_interpolation(whole, interpolation, kDefaultError, from.active_voxels);
        totals.sums.stopped_by_count = searches && moments.error == 0 && beyond > kDefaultError &&
                                       default_count(from.active_voxels) < from.active_voxels;
    }
    if (!arguments.no_fields && !fields) read_fields();
    if (fields)
        stages.run("fields", [&] {
            add_part_fields(*fields, conversion.cells(), volumes, period, model);
            ranks.agree();
        });
    if (period) {
        for (Gaussians& part : model.inputs) add_periodic_images(part, *period);
        add_periodic_images(model.description, *period);
    }
    std::uint64_t count = 0;
    for (const Gaussians& part : model.inputs) count += part.size();
    count = ranks.sum(count);
    if (arguments.volume.ones)
        model.description.options = "--measure volume " + model.description.options;
    if (options.by_moments)
        model.description.summary = summary_text(count, model.description.source_voxels,
                                                 totals.report(data_mass), "active voxels");
    made.totals = totals;
    made.data_mass = data_mass;
    made.notes = std::move(from.notes);
    return made;
}

}  // namespace vog::mpi
