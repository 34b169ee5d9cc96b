// convert_moments.cpp: the moment conversion: option checks, the choice of a cut, the model's
// description.
#include "vog/convert_moments.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "convert/fields/cell_fields.h"
#include "convert/moments/moment_job.h"
#include "core/parallel.h"
#include "vog/conversion_schema.h"
#include "vog/error.h"

namespace vog {

using namespace moments;

namespace {

void check(const MomentOptions& options) {
    const auto refuse = [](const std::string& what) { throw Error("moments: " + what); };
    const int block = options.block_voxels;
    if (block && options.budget)
        refuse(fmt::format("block {} and budget {}, expected one of them", block, options.budget));
    if (options.collective &&
        (!block || options.soft_steps > 0 || options.refine_seconds > 0 || options.measure))
        refuse("several processes, expected a hard uniform cut that is not measured");
    ConversionOptions values;
    values.moments = options, values.mass_threshold = options.mass_threshold;
    check_values(values);
}

/// The options as flags of `vog convert`, and the measured error.
std::string option_text(const MomentJob& job) {
    const MomentOptions& o = job.options;
    std::string text = o.block_voxels ? fmt::format("--block {}", o.block_voxels)
                       : o.budget     ? fmt::format("--budget {}", o.budget)
                       : o.error > 0  ? fmt::format("--error {}", o.error)
                                      : "";
    const auto add = [&](const std::string& option) { text += (text.empty() ? "" : " ") + option; };
    if (!job.overlaps()) add(fmt::format("--set soft-steps={}", job.soft_steps()));
    add(fmt::format("--set mass-threshold={}", o.mass_threshold));
    if (o.spread != 1) text += fmt::format(" --set spread={}", o.spread);
    if (o.refine_seconds > 0) text += fmt::format(" --refine {}", o.refine_seconds);
    if (o.axis_aligned) text += " --set axis-aligned=1";
    if (job.overlaps())
        text += job.soft_steps()
                    ? fmt::format(" (overlapping cells, {} soft steps)", job.soft_steps())
                    : " (overlapping cells)";
    if (job.report.measured_error >= 0)
        text += fmt::format(" (measured error {:.4g})", job.report.measured_error);
    return text;
}

/// "smoke.vdb density"; consecutive parts of the same name give it once.
std::string source_text(std::span<const Volume> parts) {
    std::string all, last;
    for (const Volume& part : parts) {
        std::string text = std::filesystem::path(part.source).filename().string();
        if (!part.name.empty()) text += (text.empty() ? "" : " ") + part.name;
        if (text != last) all += (all.empty() ? "" : " + ") + text;
        last = text;
    }
    return all;
}

}  // namespace

std::uint64_t moments::sample_count(std::span<const Volume> parts) {
    std::uint64_t voxels = 0, tiles = 0;
    for (const Volume& part : parts) {
        for (const Leaf& leaf : part.leaves)
            voxels += static_cast<std::uint64_t>(leaf.active_count());
        tiles += part.tiles.size();
    }
    return voxels + kLeafVoxels * tiles;
}

std::uint64_t moments::MomentJob::values() const {
    constexpr std::uint64_t kTileSamples = 1 << 16;
    std::uint64_t voxels = samples(), tiles = 0;
    for (const Volume& part : parts) tiles += part.tiles.size();
    voxels -= kLeafVoxels * tiles;
    return voxels + std::max(tiles, std::min(kLeafVoxels * tiles, kTileSamples));
}

int moments::MomentJob::soft_steps() const {
    if (options.soft_steps >= 0) return options.soft_steps;
    if (!options.block_voxels) return options.budget ? kSoftSteps : kSearchSoftSteps;
    if (options.collective) return 0;
    // The points of cells below 4 voxels cost five times as much: windows alone serve them.
    constexpr int kLeastBlock = 4;
    if (overlaps() && options.block_voxels < kLeastBlock) return 0;
    const double steps = std::floor(kVoxelSteps / std::max(1.0, static_cast<double>(samples())));
    // Without overlapping cells some steps are needed against a grid of dots.
    return static_cast<int>(
        std::clamp<double>(steps, overlaps() ? 0 : kLeastSoftSteps, kSoftSteps));
}

namespace {

const std::string& source_of(const MomentJob& job) {
    static const std::string none = "volume";
    return job.volume().source.empty() ? none : job.volume().source;
}

/// Sets the unit of masses, and the mass of the data in it.
/// returns  mean density of the voxels of leaves and tiles
double set_mass(MomentJob& job) {
    job.unit_volume = voxel_volume(job.volume());
    // Processes that share levels have different first parts.
    if (job.levels) job.collective().max(std::span(&job.unit_volume, 1));
    std::array<double, 2> sums{};  // mass, voxels
    for (const Volume& part : job.parts) {
        sums[0] += mass(part) / job.unit_volume;
        double voxels = static_cast<double>(kLeafVoxels) * static_cast<double>(part.leaves.size());
        for (const Tile& tile : part.tiles) voxels += std::pow(tile.edge, 3);
        sums[1] += voxels * voxel_volume(part) / job.unit_volume;
    }
    job.collective().sum(sums);
    job.data_mass = sums[0];
    if (!(job.data_mass > 0 && std::isfinite(job.data_mass)))
        throw Error(fmt::format("{}: the mass is {}, expected a positive finite one",
                                source_of(job), job.data_mass));
    return sums[0] / sums[1];
}

/// Copies of the parts with densities times 2^exponent.
std::vector<Volume> scaled(std::span<const Volume> parts, int exponent) {
    std::vector<Volume> copies(parts.begin(), parts.end());
    const auto scale = [&](float& value) {
        value = static_cast<float>(std::ldexp(double{value}, exponent));
    };
    for (Volume& part : copies) {
        for (Leaf& leaf : part.leaves) {
            check_interrupt();
            for (float& value : leaf.value) scale(value);
        }
        for (Tile& tile : part.tiles) scale(tile.value);
    }
    return copies;
}

/// Sets the model's densities times 2^exponent.
/// throws  vog::Error where one leaves the range of floats
void scale_densities(Gaussians& model, int exponent, const std::string& source) {
    for (std::size_t i = 0; i < model.size(); ++i) {
        const double density = std::ldexp(double{model.density[i]}, exponent);
        if (density > double{std::numeric_limits<float>::max()})
            throw Error(fmt::format(
                "{}: the Gaussian at {:.6g} {:.6g} {:.6g} would have the density {:.2g}, expected "
                "at most {:.2g}, the largest 32-bit float: other units of values, or larger cells",
                source, model.mean[i].x, model.mean[i].y, model.mean[i].z, density,
                std::numeric_limits<float>::max()));
        model.density[i] = static_cast<float>(density);
    }
}

/// throws  vog::Error where the data lie beyond the range of floats, the precision of models
void check_box(const MomentJob& job) {
    double farthest = 0;
    for (int axis = 0; axis < 3 && !job.box.empty(); ++axis)
        for (const double at : {job.box.lower[axis], job.box.upper[axis]})
            farthest = std::max(farthest, std::abs(at));
    if (farthest > double{std::numeric_limits<float>::max()})
        throw Error(
            fmt::format("{}: reaches {:.2g} world units from the origin, expected at most {:.2g}, "
                        "the largest 32-bit float: another unit of length",
                        source_of(job), farthest, std::numeric_limits<float>::max()));
}

Gaussians run(MomentJob& job) {
    job.report = {};
    check_box(job);
    const double mean_density = set_mass(job);
    // Sums of masses, their second moments and their squares would leave the range of floats. Powers
    // of two change no digit. A mean of 2^32 leaves 2^96 for the rest; most data are not copied.
    constexpr int kMostExponent = 32;
    const int exponent = std::ilogb(mean_density);
    std::vector<Volume> copies;
    if (std::abs(exponent) > kMostExponent) {
        copies = scaled(job.parts, -exponent);
        job.parts = copies;
        job.data_mass = std::ldexp(job.data_mass, -exponent);
    }
    job.clock.end_stage("check", 0.1);

    std::optional<joint::OwnCellFields> own;
    CellReceiver receiver;
    if (!job.options.own_field.empty() && job.has_fine_cells() && copies.empty()) {
        own.emplace(job.volume(), job.options.own_field, job.options.block_voxels,
                    job.shares_voxels());
        receiver = own->receiver();
        job.receiver = &receiver;
    }
    Gaussians model = job.options.block_voxels ? uniform_model(job) : adaptive_model(job);
    model.cutoff = kMomentCutoff;
    if (own) std::move(*own).move_to(model);
    if (job.has_uniform_cells())
        job.report.cells =
            UniformCells{job.options.block_voxels, job.shares_voxels(),
                         copies.empty() ? job.least_mass : std::ldexp(job.least_mass, exponent)};
    if (job.options.measure && job.report.measured_error < 0) {
        const ErrorViews views(job.parts, job.box, job.options.periodic);
        job.report_error(views.relative_l2(model), views.interpolation(job.parts), views);
        job.clock.end_stage("measure", 1);
    }
    model.box = job.box;
    if (!copies.empty()) scale_densities(model, exponent, source_of(job));
    check_density_range(model, source_of(job));
    model.source = source_text(job.parts);
    model.method = "moments";
    model.options = option_text(job);
    return model;
}

/// Adds MomentOptions::own_field to a model that has not got it with its cells.
void add_own_field(Gaussians& model, MomentJob& job, std::span<const Volume> parts) {
    const std::string& name = job.options.own_field;
    if (name.empty() || !model.fields.empty()) return;
    std::vector<std::vector<VoxelField>> fields(1);
    for (const Volume& part : parts) fields.front().push_back(measure_field(part, name));
    FieldOptions options;
    options.cells = job.report.cells;
    options.periodic = job.options.periodic;
    add_fields(model, parts, fields, options);
    job.clock.end_stage("fields", 1);
}

/// Sets Gaussians::summary from the counts of all processes, each of which may hold a part.
void set_summary(Gaussians& model, const MomentJob& job) {
    // Counts are exact in doubles.
    std::array<double, 2> counts{static_cast<double>(model.size()),
                                 static_cast<double>(model.source_voxels)};
    job.collective().sum(counts);
    model.summary =
        summary_text(static_cast<std::uint64_t>(counts[0]), static_cast<std::uint64_t>(counts[1]),
                     job.report, "active voxels");
}

}  // namespace

MomentOptions moment_lod(int lod) {
    if (lod < 1 || lod > 5) throw Error(fmt::format("level of detail {}, expected 1 to 5", lod));
    MomentOptions options;
    options.block_voxels = 1 << lod;
    return options;
}

Gaussians convert_moments(const Volume& volume, const MomentOptions& options,
                          MomentReport* report) {
    check(options);
    validate(volume);
    MomentReport unwanted;
    MomentJob job{{&volume, 1}, world_box(volume), false, options, report ? *report : unwanted};
    job.most_cells = active_voxels(volume);
    Gaussians model = run(job);
    model.content = content_of({&volume, 1}, job.box);
    add_own_field(model, job, {&volume, 1});
    model.source_voxels = job.most_cells;
    set_summary(model, job);
    return model;
}

Gaussians convert_moments(const Composite& data, const MomentOptions& options,
                          MomentReport* report) {
    check(options);
    if (data.parts.empty())
        throw Error("moments: no voxel is left, expected one or more within the masks");
    for (const Volume& part : data.parts) validate(part);
    MomentReport unwanted;
    MomentJob job{data.parts, data.box, true, options, report ? *report : unwanted};
    if (data.voxels > 0) job.most_cells = data.voxels;
    Gaussians model = run(job);
    model.content = data.content;
    add_own_field(model, job, data.parts);
    model.source_voxels = data.voxels;
    set_summary(model, job);
    return model;
}

}  // namespace vog
