// convert_moments.cpp: the moment conversion: option checks, the choice of a cut, the model's
// description.
#include "vog/convert_moments.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <filesystem>
#include <span>
#include <string>

#include "convert/moments/moment_job.h"
#include "vog/error.h"

namespace vog {

using namespace moments;

namespace {

void check(const MomentOptions& options) {
    const auto refuse = [](const std::string& what) { throw Error("moments: " + what); };
    const int block = options.block_voxels;
    if (block && options.budget)
        refuse(fmt::format("block {} and budget {}, expected one of them", block, options.budget));
    if (block && !(block >= 1 && block <= 128 && std::has_single_bit(unsigned(block))))
        refuse(fmt::format("block {} voxels, expected a power of two from 1 to 128", block));
    if (!(options.error >= 0 && options.error < 1))
        refuse(fmt::format("error {}, expected in (0, 1)", options.error));
    if (options.soft_steps < -1 || options.soft_steps > 1000)
        refuse(fmt::format("{} soft steps, expected 0 to 1000", options.soft_steps));
    if (!(options.spread >= 0.5f && options.spread <= 2))
        refuse(fmt::format("spread {}, expected in [0.5, 2]", options.spread));
    if (!(options.refine_seconds >= 0 && options.refine_seconds <= 1e6))
        refuse(fmt::format("refine {} seconds, expected in [0, 1e6]", options.refine_seconds));
    if (options.collective &&
        (!block || options.soft_steps > 0 || options.refine_seconds > 0 || options.measure))
        refuse("several processes, expected a hard uniform cut that is not measured");
    if (!(options.mass_threshold >= 0 && options.mass_threshold < 1))
        refuse(fmt::format("mass threshold {}, expected in [0, 1)", options.mass_threshold));
}

/// The options as flags of `vog convert`, and the measured error.
std::string option_text(const MomentJob& job) {
    const MomentOptions& o = job.options;
    std::string text = o.block_voxels ? fmt::format("--block {}", o.block_voxels)
                       : o.budget     ? fmt::format("--budget {}", o.budget)
                       : o.error > 0  ? fmt::format("--error {}", o.error)
                                      : "";
    const auto add = [&](const std::string& option) { text += (text.empty() ? "" : " ") + option; };
    if (!job.overlaps()) add(fmt::format("--soft-steps {}", job.soft_steps()));
    add(fmt::format("--mass-threshold {}", o.mass_threshold));
    if (o.spread != 1) text += fmt::format(" --spread {}", o.spread);
    if (o.refine_seconds > 0) text += fmt::format(" --refine {}", o.refine_seconds);
    if (o.axis_aligned) text += " --axis-aligned";
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

std::uint64_t moments::MomentJob::voxels() const {
    std::uint64_t count = 0;
    for (const Volume& part : parts) count += active_voxels(part);
    return count;
}

int moments::MomentJob::soft_steps() const {
    if (options.soft_steps >= 0) return options.soft_steps;
    if (!options.block_voxels) return options.budget ? kSoftSteps : kSearchSoftSteps;
    if (options.collective) return 0;
    // The points of cells below 4 voxels cost five times as much: windows alone serve them.
    constexpr int kLeastBlock = 4;
    if (overlaps() && options.block_voxels < kLeastBlock) return 0;
    const double steps = std::floor(kVoxelSteps / std::max(1.0, static_cast<double>(voxels())));
    // Without overlapping cells some steps are needed against a grid of dots.
    return static_cast<int>(
        std::clamp<double>(steps, overlaps() ? 0 : kLeastSoftSteps, kSoftSteps));
}

namespace {

Gaussians run(MomentJob& job) {
    job.report = {};
    for (const Volume& part : job.parts) job.data_mass += mass(part) / job.unit_volume();
    job.collective().sum(job.data_mass);
    if (!(job.data_mass > 0 && std::isfinite(job.data_mass)))
        throw Error(fmt::format("{}: the mass is {}, expected a positive finite one",
                                job.volume().source.empty() ? "volume" : job.volume().source,
                                job.data_mass));
    job.clock.end_stage("check", 0.1);

    Gaussians model = job.options.block_voxels ? uniform_model(job) : adaptive_model(job);
    model.cutoff = kMomentCutoff;
    if (job.options.measure && job.report.measured_error < 0) {
        job.report_error(ErrorViews(job.parts, job.box).relative_l2(model));
        job.clock.end_stage("measure", 1);
    }
    model.box = job.box;
    check_density_range(model, job.volume().source.empty() ? "volume" : job.volume().source);
    model.source = source_text(job.parts);
    model.method = "moments";
    model.options = option_text(job);
    return model;
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
    Gaussians model = run(job);
    model.source_voxels = active_voxels(volume);
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
    Gaussians model = run(job);
    model.source_voxels = data.voxels;
    set_summary(model, job);
    return model;
}

}  // namespace vog
