// convert_points.cpp: particles to Gaussians: one Gaussian each, or cells with the moments of
// several; the paper's particles.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <numeric>

#include "compare/error_views.h"
#include "convert/moments/error_search.h"
#include "convert/moments/mass_threshold.h"
#include "convert/moments/stage_clock.h"
#include "convert/particles/moment_tree.h"
#include "convert/particles/nearest_neighbours.h"
#include "convert/particles/particle_fields.h"
#include "convert/particles/particle_radii.h"
#include "core/paging.h"
#include "core/parallel.h"
#include "vog/conversion_schema.h"
#include "vog/distributed.h"
#include "vog/error.h"
#include "vog/periodic.h"
#include "vog/units.h"

namespace vog {

using namespace comparison;
using namespace moments;
using namespace particles;

namespace {

/// Name for error messages.
std::string name_of(const Points& points) {
    return points.source.empty() ? "points" : points.source;
}

/// Input, options and report of one conversion.
struct PointJob {
    const Points& points;
    const PointOptions& options;
    MomentReport& report;
    BigVector<float> values;   ///< [N] mass of each particle
    BigVector<double> radius;  ///< [N] standard deviations, world units
    double total = 0;          ///< sum of the values
    Vec3d origin{};            ///< of the model
    PointGrid grid{};          ///< for cuts and adaptive radii only
    StageClock clock{report, options.progress};
    std::vector<ParticleValues> fields = particle_values(points, options.fields);
    SmoothingRadius smoothing = chosen_smoothing(points, options);

    /// Whether Gaussians stand for cells of several particles.
    bool cuts() const { return options.block_voxels || options.budget || options.error > 0; }
};

void check(const PointOptions& options) {
    if ((options.block_voxels != 0) + (options.budget != 0) + (options.error != 0) > 1)
        throw Error("particles: two of block, budget and error, expected one of them or none");
    ConversionOptions values;
    values.particles = options, values.mass_threshold = options.mass_threshold;
    values.moments.block_voxels = options.block_voxels, values.moments.error = options.error;
    check_values(values);
}

/// Periodic box: the one of the options, or of the file. None: open.
std::optional<Box> period_of(const Points& points, const PointOptions& options) {
    if (!options.periodic || !options.periodic->empty()) return options.periodic;
    if (points.box.empty())
        throw Error(
            fmt::format("{}: the file states no periodic box, expected --periodic EDGE, --periodic "
                        "X,Y,Z or --periodic x0,y0,z0,x1,y1,z1",
                        name_of(points)));
    return points.box;
}

/// The named values as masses: none negative, at least one positive.
BigVector<float> masses(const Points& points, const std::string& name) {
    BigVector<float> values = point_values(points, name);
    bool any = false;
    for (std::size_t n = 0; n < values.size(); ++n) {
        if (values[n] < 0)
            throw Error(
                fmt::format("{}: '{}' of particle {} is {}, expected 0 or more (--clip-negative "
                            "sets negative ones to 0)",
                            name_of(points), name, n, values[n]));
        any |= values[n] > 0;
        keep_memory_at(n);
    }
    if (!any) throw Error(fmt::format("{}: '{}' is 0 for all particles", name_of(points), name));
    return values;
}

/// Box of the particles, which frames views; empty if it has no extent.
Box view_box_of(const Points& points) {
    const Box box = bounds(points);
    return box.radius() > 0 ? box : Box{};
}

/// Origin of the model of particles that are Gaussians of at least this standard deviation.
Vec3d origin_of(const Points& points, double radius) {
    const Vec3d reach{radius, radius, radius};
    const Box box = bounds(points);
    return model_origin({box.lower - reach, box.upper + reach});
}

/// Particles with mass.
BigVector<std::uint32_t> with_mass(const BigVector<float>& values) {
    BigVector<std::uint32_t> kept;
    kept.reserve(values.size());
    for (std::size_t n = 0; n < values.size(); ++n) {
        if (values[n] > 0) kept.push_back(static_cast<std::uint32_t>(n));
        keep_memory_at(n);
    }
    return kept;
}

/// Members of Gaussians that are a particle each.
Members one_each(BigVector<std::uint32_t> particles) {
    Members members{std::move(particles), {}};
    members.end.resize(members.particle.size());
    std::iota(members.end.begin(), members.end.end(), std::uint32_t{1});
    return members;
}

/// One isotropic Gaussian for each particle with mass, without fields.
Gaussians all_particles(const PointJob& job) {
    const BigVector<std::uint32_t> kept = with_mass(job.values);
    Gaussians model;
    model.cutoff = job.smoothing.name.empty() ? kMomentCutoff : kSplineCutoff;
    // From a Gaussian of kMomentCutoff to one of the model's, of the same mass and variance.
    const double wider = std::sqrt(variance_within(kMomentCutoff) / variance_within(model.cutoff));
    const double denser =
        mass_within(kMomentCutoff) / mass_within(model.cutoff) / (wider * wider * wider);
    model.box = view_box_of(job.points);
    model.origin = job.origin;
    resize(model, kept.size(), true);
    const MomentFrame frame = moment_frame({}, true, 1);
    vog::parallel_for(std::size_t{0}, kept.size(), [&](std::size_t i) {
        const std::size_t n = kept[i];
        const double variance = job.radius[n] * job.radius[n];
        set_gaussian(model, i,
                     {double{job.values[n]},
                      job.points.position[n] - model.origin,
                      {variance, 0, 0, variance, 0, variance}},
                     frame);
        model.scale[i] = static_cast<float>(wider) * model.scale[i];
        model.density[i] *= static_cast<float>(denser);
    });
    return model;
}

/// Particles with mass in the grid's order; lengths in its voxels, masses in `mass_unit`.
BigVector<Particle> grid_particles(const PointJob& job, double mass_unit) {
    const PointGrid& grid = job.grid;
    BigVector<Particle> particles;
    particles.reserve(grid.size());
    for (std::size_t n = 0; n < grid.size(); ++n) {
        keep_memory();
        const std::uint32_t from = grid.index[n];
        if (!(job.values[from] > 0)) continue;
        const double radius = job.radius[from] / grid.voxel_size;
        const auto variance = static_cast<float>(radius * radius);
        particles.push_back({grid.place(job.points, n),
                             static_cast<float>(job.values[from] / mass_unit),
                             {variance, 0, 0, variance, 0, variance},
                             from});
    }
    return particles;
}

/// Moments of the particles in each cube of block_voxels: those whose Morton keys share the higher
/// bits.
/// particles  those of grid_particles
/// ends       receives for each cell the index behind its last particle there
BigVector<Moments> uniform_cells(const PointJob& job, const BigVector<Particle>& particles,
                                 BigVector<std::uint32_t>& ends) {
    const PointGrid& grid = job.grid;
    const int level =
        kKeyBits - grid.root_log2 + std::countr_zero(unsigned(job.options.block_voxels));
    const auto cell_of = [&](std::size_t n) {
        return 3 * level >= 64 ? 0 : grid.key[n] >> (3 * level);
    };
    BigVector<Moments> cells;
    std::vector<Moments> inside;
    std::size_t particle = 0;
    for (std::size_t n = 0; n < grid.size(); ++n) {
        keep_memory();
        if (job.values[grid.index[n]] > 0)
            inside.push_back(particle_moments(particles[particle++]));
        if (n + 1 < grid.size() && cell_of(n + 1) == cell_of(n)) continue;
        if (inside.empty()) continue;
        cells.push_back(joined_moments(inside));
        ends.push_back(static_cast<std::uint32_t>(particle));
        inside.clear();
    }
    return cells;
}

/// Model and the particles of its Gaussians, which only fields need.
struct CutModel {
    Gaussians model;
    Members members;
};

/// Particles of the kept cells.
/// ends  of all cells in `particles`
Members members_of(const BigVector<Particle>& particles, const BigVector<std::uint32_t>& ends,
                   const BigVector<std::uint32_t>& kept) {
    Members members;
    for (const std::uint32_t cell : kept) {
        for (std::size_t n = cell ? ends[cell - 1] : 0; n < ends[cell]; ++n)
            members.particle.push_back(particles[n].index);
        members.end.push_back(static_cast<std::uint32_t>(members.particle.size()));
        keep_memory();
    }
    return members;
}

/// Gaussians of the cells above the mass threshold; records the dropped mass in job.report.
/// ends  of the cells in `particles`
CutModel thresholded_gaussians(PointJob& job, const BigVector<Moments>& cells,
                               const BigVector<Particle>& particles,
                               const BigVector<std::uint32_t>& ends, double mass_unit) {
    MassThreshold threshold;
    for (std::size_t n = 0; n < cells.size(); ++n) {
        threshold.add(static_cast<float>(cells[n].mass));
        keep_memory_at(n);
    }
    const float least = threshold.least_mass(job.options.mass_threshold);
    threshold.write_to(job.report, job.total / mass_unit);
    BigVector<std::uint32_t> kept;
    for (std::size_t n = 0; n < cells.size(); ++n) {
        if (static_cast<float>(cells[n].mass) >= least)
            kept.push_back(static_cast<std::uint32_t>(n));
        keep_memory_at(n);
    }

    const double edge = job.grid.voxel_size;
    const Affine world_from_grid{{{Vec3d{edge, 0, 0}, {0, edge, 0}, {0, 0, edge}}},
                                 job.grid.origin - job.origin};
    MomentFrame frame = moment_frame(world_from_grid, job.options.axis_aligned, 1);
    frame.voxel_volume = mass_unit;  // cells hold masses, not densities
    Gaussians model;
    model.cutoff = kMomentCutoff;
    model.box = view_box_of(job.points);
    model.origin = job.origin;
    resize(model, kept.size(), job.options.axis_aligned);
    vog::parallel_for(std::size_t{0}, kept.size(),
                      [&](std::size_t i) { set_gaussian(model, i, cells[kept[i]], frame); });
    if (job.fields.empty()) return {std::move(model), {}};
    return {std::move(model), members_of(particles, ends, kept)};
}

/// Model of cells: of one size, a budget or an error.
CutModel cut_model(PointJob& job) {
    const PointOptions& options = job.options;
    const double mass_unit = job.total / static_cast<double>(job.points.size());
    BigVector<std::uint32_t> ends;
    if (options.block_voxels) {
        const BigVector<Particle> particles = grid_particles(job, mass_unit);
        const BigVector<Moments> cells = uniform_cells(job, particles, ends);
        return thresholded_gaussians(job, cells, particles, ends, mass_unit);
    }
    const PointTree tree = point_tree(grid_particles(job, mass_unit));
    job.clock.end_stage("tree", 0.6);
    const auto model_of_budget = [&](std::size_t budget) {
        const BigVector<Moments> cells = best_cut(tree, budget, &ends);
        return thresholded_gaussians(job, cells, tree.particles, ends, mass_unit);
    };
    if (options.budget) return model_of_budget(options.budget);

    const ErrorViews views(all_particles(job));
    job.clock.end_stage("reference", 0.7);
    const std::size_t finest = tree.particles.size();
    CutModel best;
    MomentReport report;  // for `best`: each try overwrites job.report
    const auto error_of_budget = [&](std::size_t budget) {
        CutModel tried = model_of_budget(budget);
        const RelativeError error = views.relative_l2(tried.model);
        job.report.measured_error = error.worst, job.report.mean_error = error.mean;
        job.report.view_note = views.note();
        if (job.report.measured_error <= options.error || budget >= finest) {
            best = std::move(tried);
            report = job.report;
        }
        return job.report.measured_error;
    };
    smallest_budget(options.error, finest, error_of_budget, {});
    job.report = report;
    return best;
}

/// The options as flags of `vog convert`, and the measured error.
std::string option_text(const PointJob& job) {
    const PointOptions& o = job.options;
    std::string text = fmt::format("--value {}", o.value);
    text += o.radius > 0 ? fmt::format(" --radius {}", o.radius)
            : !job.smoothing.name.empty()
                ? " --radius " + job.smoothing.name
                : fmt::format(" --radius adaptive --neighbours {}", o.neighbours);
    if (o.block_voxels) text += fmt::format(" --block {}", o.block_voxels);
    if (o.budget) text += fmt::format(" --budget {}", o.budget);
    if (o.error > 0) text += fmt::format(" --error {}", o.error);
    if (job.cuts() && o.mass_threshold > 0)
        text += fmt::format(" --set mass-threshold={}", o.mass_threshold);
    if (job.cuts() && o.axis_aligned) text += " --set axis-aligned=1";
    if (job.report.measured_error >= 0)
        text += fmt::format(" (measured error {:.4g})", job.report.measured_error);
    return text;
}

/// Sets source, count, content and units of particles.
void describe(Gaussians& model, const Points& points, const std::string& value) {
    const std::string& length = points.length_unit;
    model.content.units = {length, unit_product(point_value_unit(points, value), length, -3)};
    model.content.hull = subject_of(model).content.hull;
    model.source_voxels = points.size();
    model.source = std::filesystem::path(points.source).filename().string();
    model.source += (model.source.empty() ? "" : " ") + value;
}

}  // namespace

SmoothingRadius chosen_smoothing(const Points& points, const PointOptions& options) {
    if (options.radius > 0) return {};
    if (options.smoothing == kAutoSmoothing) return smoothing_radius(points);
    const SmoothingRadius known = smoothing_radius(points);
    if (known.name == options.smoothing) return known;
    if (!options.smoothing.empty()) (void)point_values(points, options.smoothing);
    return {options.smoothing, 1};
}

Gaussians convert_points(const Points& given, const PointOptions& options, MomentReport* report) {
    MomentReport unwanted;
    check(options);
    validate(given);
    const std::optional<Box> period = period_of(given, options);
    Points wrapped;
    if (period) {
        wrapped = given;
        wrap(wrapped, *period);
    }
    const Points& points = period ? wrapped : given;
    PointJob job{points, options, report ? *report : unwanted, masses(points, options.value), {}};
    job.report = {};
    for (std::size_t n = 0; n < points.size(); ++n) {
        job.total += job.values[n];
        keep_memory_at(n);
    }
    job.origin = origin_of(points, options.radius);
    job.clock.end_stage("check", 0.05);

    const bool adaptive = options.radius == 0 && job.smoothing.name.empty();
    if (adaptive || job.cuts()) {
        job.grid = point_grid(points);
        job.clock.end_stage("sort", 0.2);
    }
    job.radius = adaptive             ? adaptive_radii(points, job.grid, options, period)
                 : options.radius > 0 ? BigVector<double>(points.size(), options.radius)
                                      : smoothing_radii(points, job.smoothing);
    job.clock.end_stage("radii", 0.5);

    CutModel cut = job.cuts() ? cut_model(job) : CutModel{all_particles(job), {}};
    Gaussians& model = cut.model;
    check_density_range(model, name_of(points));
    job.clock.end_stage("model", 0.9);
    if (options.measure && job.report.measured_error < 0) {
        const ErrorViews views(all_particles(job));
        const RelativeError error = views.relative_l2(model);
        job.report.measured_error = error.worst, job.report.mean_error = error.mean;
        job.report.view_note = views.note();
        job.clock.end_stage("measure", 0.95);
    }
    if (!job.fields.empty()) {
        if (!job.cuts()) cut.members = one_each(with_mass(job.values));
        add_particle_fields(model, points, job.fields, cut.members, job.values, job.radius);
        job.clock.end_stage("fields", 1);
    }
    describe(model, points, options.value);
    model.method = job.cuts() ? "moments" : "particles";
    model.options = option_text(job);
    if (period) add_periodic_images(model, *period);
    model.summary = summary_text(model, job.report, "particles");
    return std::move(model);
}

Gaussians convert_points_paper(const Points& points, const std::string& value, double radius,
                               float kappa, std::span<const PointField> fields) {
    validate(points);
    if (!(radius >= 0 && std::isfinite(radius)))
        throw Error(fmt::format("particles: radius {}, expected more than 0, or 0", radius));
    if (!(kappa > 0 && kappa < 1))
        throw Error(fmt::format("particles: kappa {}, expected in (0, 1)", kappa));
    const BigVector<float> values = masses(points, value);
    const std::vector<ParticleValues> field_values = particle_values(points, fields);
    const double voxel_size = point_voxel_size(points);
    const double paper_radius = radius > 0 ? radius : 0.5 * voxel_size;
    const LeafOrder order = leaf_order(points, voxel_size);

    Gaussians model;
    model.cutoff = static_cast<float>(std::sqrt(-2 * std::log(kappa)));
    model.box = view_box_of(points);
    model.origin = origin_of(points, paper_radius);
    BigVector<std::uint32_t> kept;
    for (const std::uint32_t n : order.index) {
        if (!(values[n] > 0)) continue;
        if (!fields.empty()) kept.push_back(n);
        const auto s = static_cast<float>(paper_radius / std::numbers::sqrt2);
        model.mean.push_back(vec_cast<float>(points.position[n] - model.origin));
        model.scale.push_back({s, s, s});
        model.density.push_back(values[n]);
    }
    if (!fields.empty())
        add_particle_fields(model, points, field_values, one_each(std::move(kept)), values,
                            BigVector<double>(points.size(), paper_radius / std::numbers::sqrt2));
    describe(model, points, value);
    model.method = "paper";
    model.options =
        fmt::format("--value {} --radius {:.6g} --set kappa={}", value, paper_radius, kappa);
    return model;
}

}  // namespace vog
