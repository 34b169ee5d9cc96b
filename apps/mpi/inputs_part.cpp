// inputs_part.cpp: partitioned reading of volumes, particles and models.
#include "inputs_part.h"

#include <fmt/format.h>

#include <limits>
#include <numeric>

#include "rank_files.h"
#include "terminal/terminal.h"
#include "vog/distributed.h"
#include "vog/error.h"
#include "vog/model_io.h"
#include "vog/scan_io.h"

namespace vog::mpi {

namespace {

VolumePart this_part(const Ranks& ranks, int align_voxels) {
    return {ranks.rank(), ranks.count(), align_voxels};
}

void read_mesh(std::span<const LevelSource> sources, const LevelOptions& options,
               const VolumePart& part, bool by_arrangement, ValueNotes& notes, bool beside,
               VolumesPart& result) {
    std::vector<VolumeReader> volumes, masks;
    for (const auto& [file, grid, mask] : sources)
        volumes.emplace_back(
            file, VdbOptions{grid, options.level_set_to_fog, false, options.values, options.ones});
    if (by_arrangement) {
        const Arrangement arrangement = arrangement_of(volumes);
        cli::require_mesh(arrangement);
        result.notes.push_back(arrangement.text);
    }
    for (const auto& [file, grid, mask] : sources) {
        if (!mask.empty()) masks.emplace_back(file, VdbOptions{mask, false, true, options.values});
    }
    for (const VolumeReader& volume : volumes) {
        result.box.include(volume.world_box());
        result.active_voxels += volume.active_voxels();
    }
    std::vector<Levels> around;
    for (Levels& levels :
         read_level_parts(volumes, masks, part, &notes, beside ? &around : nullptr))
        result.sets.push_back({std::move(levels), Overlap::hide});
    for (Levels& levels : around) result.beside.push_back({std::move(levels), Overlap::hide});
    // Every rank has counted the whole, and the counts are summed later: the root's is kept.
    if (part.index > 0) result.active_voxels = 0;
}

void read_sums(std::span<const LevelSource> sources, const LevelOptions& options,
               const Ranks& ranks, int align_voxels, ValueNotes& notes, bool beside,
               VolumesPart& result) {
    std::vector<std::string> files;
    for (const LevelSource& source : sources) files.push_back(source.file.string());
    const auto shares = shares_of(files, ranks);
    result.sets.emplace_back();
    if (beside) result.beside.emplace_back();
    for (std::size_t n = 0; n < sources.size(); ++n) {
        if (!shares[n]) continue;
        VolumeReader reader(sources[n].file, {sources[n].grid, options.level_set_to_fog, false,
                                              options.values, options.ones});
        VolumePart part = *shares[n];
        part.align_voxels = align_voxels;
        result.sets.front().volumes.push_back(reader.read(part, &notes));
        if (beside)
            result.beside.front().volumes.push_back(
                part.whole() ? Volume{} : read_beside(reader, result.sets.front().volumes.back()));
        result.sources.push_back(n);
        result.by_files |= part.whole() && ranks.count() > 1;
        result.box.include(reader.world_box());
        result.active_voxels += active_voxels(result.sets.front().volumes.back());
    }
}

/// throws vog::Error, on every rank, where models of different ranks have different cutoffs
void require_one_cutoff(const Gaussians& model, const Ranks& ranks) {
    const bool any = !model.source.empty() || model.size() > 0;
    const double cutoff = model.cutoff;
    constexpr double kNone = std::numeric_limits<double>::infinity();
    const double smallest = ranks.min(any ? cutoff : kNone);
    const double largest = ranks.max(any ? cutoff : -kNone);
    if (smallest < largest)
        throw Error(
            fmt::format("cutoffs from {} to {}: models with different kernels cannot be one model",
                        smallest, largest));
}

}  // namespace

VolumesPart read_volumes_part(const std::vector<std::string>& files,
                              const cli::VolumeInputOptions& options, const Ranks& ranks,
                              int align_voxels, bool beside) {
    const bool whole = are_many(files.size(), ranks) &&
                       cli::combination_of(files.size(), options).overlap == Overlap::add;
    const SameFiles same(files, ranks, !whole);
    const std::vector<std::filesystem::path> paths(files.begin(), files.end());
    const LevelOptions level_options = cli::level_options(options);
    VolumesPart part;
    const std::vector<LevelSource> sources = level_sources(paths, level_options, &part.notes);
    part.volumes = sources.size();
    const cli::Combination combination = cli::combination_of(sources.size(), options);
    part.overlap = combination.overlap;
    if (!combination.text.empty()) part.notes.push_back(combination.text);
    ValueNotes notes;
    if (part.is_mesh())
        read_mesh(sources, level_options, this_part(ranks, align_voxels),
                  combination.by_arrangement, notes, beside, part);
    else
        read_sums(sources, level_options, ranks, align_voxels, notes, beside, part);
    same.check_unchanged();
    part.box = ranks.box_union(part.box);
    std::vector<const Volume*> volumes;
    for (const VolumeSet& set : part.sets)
        for (const Volume& volume : set.volumes) volumes.push_back(&volume);
    part.content = content_of(volumes, part.box, &ranks.collective());
    part.active_voxels = ranks.sum(part.active_voxels);
    for (std::uint64_t* count :
         {&notes.clipped_negative, &notes.skipped_nonfinite, &notes.inactive_nonfinite})
        *count = ranks.sum(*count);
    notes.first_skipped.reset();  // the first of this rank alone
    constexpr double kNone = -std::numeric_limits<double>::infinity();
    if (const double most = ranks.max(notes.background.value_or(kNone)); most > kNone)
        notes.background = most;
    if (const std::string text = values_text(notes, "voxels"); !text.empty())
        part.notes.push_back(text);
    for (const std::filesystem::path& file : paths)
        if (const std::string text = ranks.first() ? volume_note(file) : ""; !text.empty())
            part.notes.push_back(text);
    for (const std::string& text : part.notes)
        if (ranks.first()) cli::note(text);
    return part;
}

cli::DividedVolumes read_divided_volumes(const std::vector<std::string>& files,
                                         const cli::VolumeInputOptions& options, bool beside,
                                         const Ranks& ranks) {
    cli::DividedVolumes read;
    try {
        try {
            VolumesPart part = read_volumes_part(files, options, ranks, kLeafEdge, beside);
            ranks.agree();
            read = {part.is_mesh(),         std::move(part.sets),
                    std::move(part.beside), part.volumes,
                    part.active_voxels,     subject_of(part.box, part.content),
                    std::move(part.notes),  nullptr};
        } catch (const Error& error) {
            ranks.agree({1, cli::failure_text(error)});
        }
    } catch (const Ended&) {
        read.failure = std::current_exception();
    }
    return read;
}

Gaussians read_particles_part(const std::vector<std::string>& files,
                              const cli::PointInputOptions& options,
                              const cli::VolumeInputOptions& volume, const Ranks& ranks,
                              std::vector<std::string>& notes) {
    PointOptions point_options = cli::point_options(options);
    point_options.collective = &ranks.collective();
    const SameFiles same(files, ranks);
    const Points points = cli::load_points(files, options, volume, notes);
    same.check_unchanged();
    const Gaussians all = convert_points(points, point_options);
    if (ranks.first()) cli::print_notes(notes);
    const auto begin_of = [&](int rank) {
        return all.size() * static_cast<std::size_t>(rank) /
               static_cast<std::size_t>(ranks.count());
    };
    std::vector<std::size_t> mine(begin_of(ranks.rank() + 1) - begin_of(ranks.rank()));
    std::iota(mine.begin(), mine.end(), begin_of(ranks.rank()));
    Gaussians part = select(all, mine);
    part.box = view_box(all);
    return part;
}

void note_left_out(const ValueNotes& notes, const std::vector<std::string>& files,
                   const Ranks& ranks) {
    ValueNotes all;
    all.skipped_nonfinite = ranks.sum(notes.skipped_nonfinite);
    if (const std::string text = values_text(all, files.front()); !text.empty() && ranks.first())
        cli::note(text);
}

Gaussians read_models_part(const std::vector<std::string>& inputs, const Ranks& ranks,
                           const ValueRules& rules) {
    Gaussians model;
    const std::vector<std::string> files = cli::model_files(inputs);
    const SameFiles same(files, ranks, !are_many(files.size(), ranks));
    const auto shares = shares_of(files, ranks);
    ValueNotes notes;
    for (std::size_t n = 0; n < files.size(); ++n)
        if (shares[n])
            append(model, read_model(files[n], ModelPart{shares[n]->index, shares[n]->count}, rules,
                                     &notes));
    same.check_unchanged();
    note_left_out(notes, files, ranks);
    require_one_cutoff(model, ranks);
    model.box = ranks.box_union(model.box);
    if (model.box.empty()) model.box = ranks.box_union(model.size() ? view_box(model) : Box{});
    return model;
}

}  // namespace vog::mpi
