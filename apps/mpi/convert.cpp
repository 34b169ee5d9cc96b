// convert.cpp: vog-mpi convert: every rank converts its part, one file comes out.
//
// Uniform cuts and the paper's conversion look at one cell or one leaf at a time, so parts that are
// aligned to those are converted as the whole is; the one thing that is the whole's, the mass below
// which cells are dropped, comes from summed histograms. The cut of a budget does look further:
// each part is cut for itself, with a share of it (docs/scaling.md says what that costs), and an
// error is reached by the smallest budget whose error, of all parts together, is low enough.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "commands.h"
#include "inputs_part.h"
#include "model_file.h"
#include "shares.h"
#include "vog/distributed.h"
#include "vog/error.h"
#include "whole_error.h"

namespace vog::mpi {

namespace {

using cli::ConvertArguments;
using cli::MomentTotals;
using cli::VolumeConversion;

/// Hard cells of one size: the whole's model in parts.
bool uniform(const VolumeConversion& asked) {
    return asked.by_moments && asked.moments.block_voxels && asked.moments.soft_steps <= 0;
}

void check(const VolumeConversion& asked, const Ranks& ranks) {
    if (ranks.count() == 1) return;
    const auto refuse = [](const std::string& what, const std::string& why) {
        throw CLI::ValidationError(
            fmt::format("{}: {}; expected one process (vog convert)", what, why));
    };
    if (asked.by_moments && asked.moments.refine_seconds > 0)
        refuse("--refine", "ranks would stop at different times");
    const auto ranks_count = static_cast<std::size_t>(ranks.count());
    if (asked.by_moments && asked.moments.budget && asked.moments.budget < ranks_count)
        throw CLI::ValidationError(fmt::format("--budget {}: expected one Gaussian a rank at least",
                                               asked.moments.budget));
    if (asked.by_moments) return;
    if (asked.paper.strategy == Strategy::variance_clusters)
        refuse("--strategy variance", "its threshold is of the values of all leaves");
    if (asked.paper.strategy == Strategy::leaf_clusters)
        refuse("--strategy neighbours", "clusters go across parts");
}

/// Edge of the cubes that one Gaussian may be of.
int align_voxels(const VolumeConversion& asked) {
    if (asked.by_moments) return std::max(kLeafEdge, asked.moments.block_voxels);
    if (asked.paper.strategy != Strategy::tree_mirror) return kLeafEdge;
    return asked.paper.tree_depth == 1 ? 4096 : asked.paper.tree_depth == 2 ? 128 : kLeafEdge;
}

/// One input, or all levels of a mesh, as far as they are here.
struct InputPart {
    std::vector<Volume> volumes;  ///< that add up; a mesh: without what finer levels hide
    Box box;                      ///< of what is here
    std::uint64_t voxels = 0;
};

/// What is left of this rank's part of each level.
InputPart composed(const std::vector<VolumeSet>& sets) {
    InputPart part;
    for (const VolumeSet& one : sets) {
        Composite all = composite(one);
        // The levels over it only hide: what is seen of them is others'.
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

/// The conversion of one run of the command.
class PartConversion {
  public:
    PartConversion(const VolumeConversion& asked, const VolumesPart& from, const Ranks& ranks)
        : asked_(asked), from_(from), ranks_(ranks), together_(uniform(asked) && !from.by_files) {}

    /// Of every input the part, which may be empty.
    /// budget  of Gaussians in all; 0: as asked
    std::vector<Gaussians> convert(const std::vector<InputPart>& parts, std::size_t budget = 0) {
        budget_ = budget ? budget : asked_.moments.budget;
        mass_ = 0;
        totals_ = {};
        std::vector<Gaussians> models;
        for (const InputPart& part : parts) models.push_back(convert(part));
        return models;
    }
    /// This rank's part of every input in the smallest model whose error, of all ranks together, is
    /// at most the one asked for.
    std::vector<Gaussians> search(const std::vector<InputPart>& parts, const WholeError& error) {
        const std::size_t finest = from_.active_voxels;
        std::vector<Gaussians> best;
        MomentTotals totals;  // of the best: each conversion overwrites totals_
        smallest_budget(asked_.moments.error, finest, [&](std::size_t budget) {
            std::vector<Gaussians> models = convert(parts, budget);
            const double measured = error.of(models);
            if (measured <= asked_.moments.error || budget >= finest) {
                best = std::move(models);
                totals = totals_;
            }
            return measured;
        });
        totals_ = totals;
        return best;
    }
    /// Of all ranks and inputs, of the last conversion.
    double data_mass() const {
        double sum = mass_;
        ranks_.sum(std::span(&sum, 1));
        return sum;
    }
    MomentTotals totals() const {
        MomentTotals all = totals_;
        double sums[3] = {all.cells_mass, all.dropped_mass, double(all.dropped_cells)};
        ranks_.sum(sums);
        all.cells_mass = sums[0];
        all.dropped_mass = sums[1];
        all.dropped_cells = static_cast<std::size_t>(sums[2]);
        return all;
    }

  private:
    Gaussians convert(const InputPart& part) {
        double part_mass = 0;
        for (const Volume& volume : part.volumes) part_mass += mass(volume);
        mass_ += part_mass;
        if (!asked_.by_moments) return by_paper(part);
        if (together_) return uniform_cells(part, part_mass);
        if (part_mass == 0) return {};
        MomentReport report;
        MomentOptions options = asked_.moments;
        if (!options.block_voxels) options.budget = budget_of(part);
        options.measure = false;  // all together are, at the end
        Gaussians model = by_moments(part, options, &report);
        totals_.add(report, part_mass);
        return model;
    }
    Gaussians by_paper(const InputPart& part) const {
        Gaussians model;
        for (const Volume& volume : part.volumes)
            if (!volume.empty()) append(model, convert_paper(volume, asked_.paper));
        return model;
    }
    Gaussians by_moments(const InputPart& part, const MomentOptions& options,
                         MomentReport* report) const {
        if (!from_.is_mesh()) return convert_moments(part.volumes.front(), options, report);
        Composite data{part.volumes, from_.box, part.voxels};
        if (data.parts.empty()) data.parts.emplace_back();  // has a part in sums all the same
        return convert_moments(data, options, report);
    }
    Gaussians uniform_cells(const InputPart& part, double part_mass) {
        MomentOptions options = asked_.moments;
        options.measure = false;  // below, for all
        options.collective = &ranks_.collective();
        MomentReport report;
        Gaussians model = by_moments(part, options, &report);
        ranks_.sum(std::span(&part_mass, 1));
        // The report is of all: counted once.
        if (ranks_.first()) totals_.add(report, part_mass);
        return model;
    }
    /// By active voxels, at least one.
    std::size_t budget_of(const InputPart& part) const {
        if (ranks_.count() == 1) return budget_;
        const double free =
            std::max(0.0, static_cast<double>(budget_) - static_cast<double>(ranks_.count()));
        const double share =
            static_cast<double>(part.voxels) / static_cast<double>(from_.active_voxels);
        return 1 + static_cast<std::size_t>(std::floor(free * std::min(share, 1.0)));
    }

    const VolumeConversion& asked_;
    const VolumesPart& from_;
    const Ranks& ranks_;
    bool together_ = false;
    std::size_t budget_ = 0;
    double mass_ = 0;
    MomentTotals totals_;
};

/// The first text that is not empty, by ranks.
std::string any(const Ranks& ranks, const std::string& text) {
    for (const std::string& one : ranks.gather(text))
        if (!one.empty()) return one;
    return {};
}

/// The flags asked for, where a part's own say its share and its error.
std::string whole_options(const std::string& of_part, const VolumeConversion& asked,
                          const Ranks& ranks) {
    if (!asked.by_moments || uniform(asked)) return of_part;
    std::string text = of_part.substr(0, of_part.find(" (measured"));
    if (!asked.moments.block_voxels) {
        // A part has a budget of its own.
        const std::size_t second = text.find(' ', text.find(' ') + 1);
        text = (asked.moments.budget ? fmt::format("--budget {}", asked.moments.budget)
                                     : fmt::format("--error {}", asked.moments.error)) +
               text.substr(second);
    }
    return ranks.count() == 1 ? text : fmt::format("{} (in {} parts)", text, ranks.count());
}

/// What the header says of all inputs.
Gaussians description_of(const std::vector<InputPart>& parts, const std::vector<Gaussians>& models,
                         const VolumesPart& from, const VolumeConversion& asked,
                         const Ranks& ranks) {
    Gaussians all;
    for (std::size_t n = 0; n < parts.size(); ++n) {
        Gaussians one;
        one.source = any(ranks, models[n].source);
        one.method = asked.by_moments ? "moments" : "paper";
        one.options = whole_options(any(ranks, models[n].options), asked, ranks);
        one.cutoff =
            static_cast<float>(ranks.largest(models[n].source.empty() ? 0.0 : models[n].cutoff));
        one.source_voxels = ranks.sum(parts[n].voxels);
        append(all, one);
    }
    all.box = from.box;
    return all;
}

/// Volumes of all inputs, for their error.
WholeError error_of(const std::vector<InputPart>& parts, const Box& box, const Ranks& ranks) {
    std::vector<Volume> volumes;
    for (const InputPart& part : parts)
        volumes.insert(volumes.end(), part.volumes.begin(), part.volumes.end());
    return {volumes, box, ranks};
}

nlohmann::ordered_json convert_volumes(const ConvertArguments& arguments,
                                       const VolumeConversion& asked, cli::Stages& stages,
                                       bool split, const Ranks& ranks) {
    check(asked, ranks);
    VolumesPart from = stages.run("load", [&] {
        return read_volumes_part(arguments.inputs, arguments.volume, ranks, align_voxels(asked));
    });
    const std::vector<InputPart> parts = stages.run("compose", [&] { return input_parts(from); });
    // Of levels those that are seen count, as of one process.
    from.active_voxels = 0;
    for (const InputPart& part : parts) from.active_voxels += part.voxels;
    from.active_voxels = ranks.sum(from.active_voxels);
    PartConversion conversion(asked, from, ranks);
    SharedModel model;
    const MomentOptions& moments = asked.moments;
    const bool searches = asked.by_moments && !moments.block_voxels && !moments.budget;
    std::optional<WholeError> error;
    if (searches || (asked.by_moments && moments.measure))
        stages.run("reference", [&] { error.emplace(error_of(parts, from.box, ranks)); });
    stages.run("convert", [&] {
        model.inputs = searches ? conversion.search(parts, *error) : conversion.convert(parts);
        ranks.agree();
    });
    model.description = description_of(parts, model.inputs, from, asked, ranks);
    MomentTotals totals = conversion.totals();
    const double data_mass = conversion.data_mass();
    if (error) totals.worst_error = stages.run("measure", [&] { return error->of(model.inputs); });
    std::uint64_t count = 0;
    for (const Gaussians& part : model.inputs) count += part.size();
    count = ranks.sum(count);
    if (asked.by_moments)
        model.description.summary = summary_text(count, model.description.source_voxels,
                                                 totals.report(data_mass), "active voxels");
    if (ranks.first() && !arguments.no_hierarchy)
        cli::note("no hierarchy: parts of a model have none, --no-hierarchy is what is made");
    const cli::Converted made = stages.run("save", [&] {
        return split ? write_split(arguments.output, model, ranks)
                     : write_model(arguments.output, model, ranks);
    });
    if (!ranks.first()) return {};
    return cli::report(arguments, cli::FileKind::volume, made, data_mass, totals, stages);
}

}  // namespace

void add_convert(CLI::App& app, const Ranks& ranks) {
    auto arguments = std::make_shared<ConvertArguments>();
    arguments->threads = ranks.fair_threads();
    auto split = std::make_shared<bool>(false);
    cli::ConvertTogether others;
    others.collective = &ranks.collective();
    others.writes = ranks.first();
    others.volumes = [split, &ranks](const ConvertArguments& asked,
                                     const VolumeConversion& conversion, cli::Stages& stages) {
        return convert_volumes(asked, conversion, stages, *split, ranks);
    };
    others.mine = [&ranks](const std::vector<std::string>& files) {
        return whole_files_of(files, ranks);
    };
    others.gather = [&ranks](const std::string& text) { return ranks.gather(text); };
    CLI::App* command = cli::add_convert(app, arguments, others);
    command->add_flag("--split", *split,
                      "Of volumes: one PLY for each rank, model.0.ply and so on beside model.ply, "
                      "and model.json, which names them, for model.ply");
}

}  // namespace vog::mpi
