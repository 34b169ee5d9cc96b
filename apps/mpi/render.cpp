// render.cpp: vog-mpi render: sort-last parallel rendering without an order: every rank renders its
// part, the images of T (or slabs of light, or moments of a field) are summed, and the root shades. A
// sequence is divided by pictures instead.
#include <fmt/core.h>

#include <memory>

#include "commands.h"
#include "inputs_part.h"
#include "rank_files.h"
#include "shared/render_run.h"
#include "vog/error.h"

namespace vog::mpi {

namespace {

using cli::Drawing;
using cli::DrawingArguments;
using cli::FileKind;
using cli::Size;

/// A draw function that sums the T of several drawings.
auto draw_sum(std::vector<Drawing> drawings) {
    return [drawings = std::move(drawings)](const Camera& camera, Size size,
                                            const Progress& progress, DepthImage& depth) {
        depth = DepthImage(size.width, size.height);
        DepthImage one;
        for (const Drawing& drawing : drawings) {
            drawing.draw(camera, size, progress, one);
            for (std::size_t n = 0; n < depth.depth.size(); ++n) depth.depth[n] += one.depth[n];
        }
    };
}

void load_volumes(const DrawingArguments& arguments, const Ranks& ranks, Drawing& drawing) {
    const VolumesPart part = read_volumes_part(arguments.inputs, arguments.volume, ranks);
    const bool linear = arguments.interpolation == "linear" && ranks.count() > 1;
    if (linear && arguments.step_voxels > 0)
        throw CLI::ValidationError(
            "--interpolation linear with --step above 0: samples begin where a ray enters the "
            "whole volume, of which a rank holds a part; expected --step 0 (exact, cell by cell), "
            "or one process (vog render)");
    if (part.is_mesh() && linear)
        throw Error(
            "--interpolation linear: at the edge of a part, levels of a mesh need values that "
            "other ranks hold; expected --interpolation constant, or one process (vog render)");
    std::vector<Drawing> drawings;
    for (const VolumeSet& set : part.sets) {
        if (set.volumes.empty()) continue;
        drawings.push_back(drawing);
        cli::draw_volumes(arguments, set, drawings.back());
    }
    drawing.draw = draw_sum(std::move(drawings));
    drawing.notes = part.notes;
    drawing.subject = subject_of(part.box, part.content);
    drawing.active_voxels = part.active_voxels;
    cli::set_primitives_text(drawing, part.is_mesh() ? part.volumes : 0);
}

void load_gaussians(const DrawingArguments& arguments, std::optional<double> extinction,
                    const Ranks& ranks, Drawing& drawing) {
    auto model = std::make_shared<Gaussians>(
        drawing.kind == FileKind::points
            ? read_particles_part(arguments.inputs, arguments.points, arguments.volume, ranks,
                                  drawing.notes)
            : read_models_part(arguments.inputs, ranks, arguments.volume.values));
    const std::uint64_t count = ranks.sum(model->size());
    const Subject subject = subject_of(*model, &ranks.collective());
    if (model->size() > 0)
        cli::draw_model(arguments, extinction, model, std::make_shared<Hierarchy>(), drawing);
    else
        drawing.draw = draw_sum({});
    drawing.subject = subject;
    drawing.gaussians = count;
    drawing.reports.reset();
    cli::set_primitives_text(drawing, 0);
}

Drawing load_part(const DrawingArguments& arguments, std::optional<double> extinction,
                  const CLI::App& command, const Ranks& ranks) {
    if (arguments.stop_transmittance > 0 && ranks.count() > 1)
        throw CLI::ValidationError(
            "--stop-transmittance: a rank does not know the transmittance in front of its part of "
            "a ray; expected one process (vog render)");
    Drawing drawing = cli::begin_drawing(arguments, command);
    if (drawing.kind == FileKind::volume)
        load_volumes(arguments, ranks, drawing);
    else
        load_gaussians(arguments, extinction, ranks, drawing);
    drawing.draw = [draw = std::move(drawing.draw), &ranks](const Camera& camera, Size size,
                                                            const Progress& progress,
                                                            DepthImage& depth) {
        draw(camera, size, progress, depth);
        ranks.sum_at_first(depth);
    };
    return drawing;
}

}  // namespace

void add_render(CLI::App& app, const Ranks& ranks) {
    auto arguments = std::make_shared<cli::RenderArguments>();
    arguments->threads = ranks.threads_per_rank();
    cli::RenderRanks hooks;
    hooks.load = [&ranks](const DrawingArguments& drawing, std::optional<double> extinction,
                          const CLI::App& command) {
        return load_part(drawing, extinction, command, ranks);
    };
    hooks.load_models = [&ranks](const std::vector<std::string>& files, const ValueRules& rules) {
        return read_models_part(files, ranks, rules);
    };
    hooks.load_volumes = [&ranks](const DrawingArguments& drawing,
                                  const cli::VolumeInputOptions& options, bool beside) {
        return read_divided_volumes(drawing.inputs, options, beside, ranks);
    };
    hooks.collective = ranks.collective();
    hooks.is_root = ranks.first();
    // Pictures of a sequence: each is rendered by one rank alone.
    hooks.assigned = [&ranks](const std::vector<std::string>& files) {
        return whole_files_of(files, ranks);
    };
    hooks.allgather = [&ranks](const std::string& text) { return ranks.gather(text); };
    cli::add_render(app, arguments, hooks);
}

}  // namespace vog::mpi
