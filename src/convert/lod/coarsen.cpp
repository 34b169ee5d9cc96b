// coarsen.cpp: coarser models by pruning a tree of moments over the Gaussians of a model.
#include "vog/lod.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "convert/lod/coarsener.h"
#include "convert/lod/field_moments.h"
#include "convert/particles/moment_tree.h"
#include "convert/particles/soften.h"
#include "core/parallel.h"
#include "data/fields/field_arrays.h"
#include "data/fields/field_limits.h"
#include "vog/error.h"

namespace vog {

using namespace particles;
using namespace lod;

namespace {

/// Gaussians below which drawing time no longer depends on the count: no coarser level is made.
constexpr std::size_t kCoarsest = 1000;
constexpr std::size_t kLevelRatio = 4;

/// Origin and units of the tree.
struct Lattice {
    Vec3d origin;
    double length = 1;  ///< world units per unit of length: the mean spacing
    double mass = 1;    ///< per unit of mass: the mean of the Gaussians
};

Lattice lattice_of(const Gaussians& model) {
    Box means;
    for (const Vec3f& mean : model.mean) means.include(vec_cast<double>(mean));
    Lattice lattice;
    lattice.origin = means.lower;
    const auto count = static_cast<double>(model.size());
    // The largest scale, if all Gaussians lie in one place.
    double extent = 2 * means.radius();
    for (const Vec3f& s : model.scale)
        extent = std::max({extent, double{s.x}, double{s.y}, double{s.z}});
    lattice.length = extent / std::cbrt(count);
    const double total = mass(model);
    if (total > 0) lattice.mass = total / count;
    return lattice;
}

/// Mass, mean and covariance after truncation of each Gaussian with mass, in the tree's units.
BigVector<Particle> particles_of(const Gaussians& model, const Lattice& lattice) {
    const double variance_share = variance_within(model.cutoff) / (lattice.length * lattice.length);
    BigVector<Particle> all(model.size());
    vog::parallel_for(std::size_t{0}, all.size(), [&](std::size_t i) {
        all[i].place = (1 / lattice.length) * (vec_cast<double>(model.mean[i]) - lattice.origin);
        all[i].mass = static_cast<float>(mass(model, i) / lattice.mass);
        all[i].index = static_cast<std::uint32_t>(i);
        const std::array<double, 6> covariance = kernel_covariance(model, i);
        for (std::size_t n = 0; n < 6; ++n)
            all[i].covariance[n] = static_cast<float>(variance_share * covariance[n]);
    });
    std::erase_if(all, [](const Particle& particle) { return !(particle.mass > 0); });
    return all;
}

/// Gaussians of the cells, with the description of `source`.
Gaussians model_of(const Gaussians& source, const BigVector<Moments>& cells,
                   const Lattice& lattice) {
    const double edge = lattice.length;
    MomentFrame frame =
        moment_frame({{{Vec3d{edge, 0, 0}, {0, edge, 0}, {0, 0, edge}}}, lattice.origin}, false, 1,
                     source.cutoff);
    frame.voxel_volume = lattice.mass;  // cells hold masses, not densities
    Gaussians model = select(source, {});
    model.source_voxels = source.source_voxels;
    resize(model, cells.size(), false);
    vog::parallel_for(std::size_t{0}, cells.size(),
                      [&](std::size_t i) { set_gaussian(model, i, cells[i], frame); });
    return model;
}

/// One cell, whose fields are merged from those of its parts.
struct FieldCell {
    std::span<const Moments> parts;       ///< of one cell
    std::span<const std::size_t> places;  ///< of them in the source
    const Merger& merger;
    std::size_t cell;

    template <class Field>
    void set(const Field& from, Field& to) const {
        std::vector<decltype(field_moments(from, 0, {}))> of_parts;
        of_parts.reserve(places.size());
        for (std::size_t k = 0; k < places.size(); ++k)
            of_parts.push_back(field_moments(from, places[k], parts[k].covariance));
        set_field(to, cell, merged(merger, std::span(std::as_const(of_parts))));
    }
};

/// Sets the fields of each cell from those of its Gaussians in the source.
/// parts  by cell
void set_fields(const Gaussians& source, const PointTree& tree, const BigVector<ParticlePart>& all,
                Gaussians& model) {
    if (source.fields.empty()) return;
    const double variance = variance_within(source.cutoff);
    vog::parallel_for(std::size_t{0}, model.size(), [&](std::size_t cell) {
        std::vector<std::size_t> places;
        std::vector<Moments> parts;
        for (const ParticlePart& one :
             std::ranges::equal_range(all, cell, {}, &ParticlePart::cell)) {
            const std::size_t i = tree.particles[one.particle].index;
            Moments part{one.share * mass(source, i), vec_cast<double>(source.mean[i]),
                         kernel_covariance(source, i)};
            for (double& c : part.covariance) c *= variance;
            places.push_back(i);
            parts.push_back(part);
        }
        const Merger merger(joined_moments(parts), parts);
        const FieldCell fields{parts, places, merger, cell};
        for (std::size_t k = 0; k < source.fields.scalar.size(); ++k)
            fields.set(source.fields.scalar[k], model.fields.scalar[k]);
        for (std::size_t k = 0; k < source.fields.vector.size(); ++k)
            fields.set(source.fields.vector[k], model.fields.vector[k]);
    });
    limit_planes(model);
}

/// Whole particles as parts of the cells that hold them.
/// ends  of each cell's run in tree.particles
BigVector<ParticlePart> whole_parts(const BigVector<std::uint32_t>& ends) {
    BigVector<ParticlePart> parts;
    for (std::uint32_t cell = 0, n = 0; cell < ends.size(); ++cell)
        for (; n < ends[cell]; ++n) parts.push_back({cell, n, 1});
    return parts;
}

/// Steps from the windows of a cut: from 2 to 6 the error of T at 50 particles a cell falls from 0.0064 to 0.0048; few particles a cell are
/// fitted one by one by more.
int soft_steps(std::size_t particles, std::size_t cells) {
    constexpr double kMost = 6;
    const double ratio = static_cast<double>(particles) / static_cast<double>(cells);
    return static_cast<int>(std::clamp(1 + std::ceil(std::log2(ratio)), 1.0, kMost));
}

}  // namespace

struct Coarsener::State {
    const Gaussians& model;
    bool fills_space;
    Lattice lattice;
    PointTree tree;
};

Coarsener::Coarsener(const Gaussians& model, bool fills_space)
    : state_(std::make_unique<State>(State{model, fills_space, lattice_of(model), {}})) {}
Coarsener::~Coarsener() = default;

Gaussians Coarsener::model(std::size_t budget) {
    State& of = *state_;
    if (of.model.size() <= budget && !of.fills_space) return of.model;
    if (of.tree.particles.empty())
        of.tree = point_tree(particles_of(of.model, of.lattice),
                             of.fills_space ? Division::at_middle : Division::at_mean);
    BigVector<Moments> cells;
    BigVector<std::uint32_t> ends;
    if (!of.tree.particles.empty()) cells = best_cut(of.tree, budget, &ends);
    BigVector<ParticlePart> parts;
    if (of.fills_space)
        soften(of.tree, cells, soft_steps(of.tree.particles.size(), cells.size()),
               of.model.fields.empty() ? nullptr : &parts);
    else
        parts = whole_parts(ends);
    Gaussians coarse = model_of(of.model, cells, of.lattice);
    set_fields(of.model, of.tree, parts, coarse);
    coarse.options +=
        fmt::format("{}coarsened to {}", of.model.options.empty() ? "" : ", ", budget);
    return coarse;
}

std::vector<Gaussians> coarsen(const Gaussians& model, std::span<const std::size_t> budgets) {
    validate(model);
    if (std::ranges::find(budgets, std::size_t{0}) != budgets.end())
        throw Error(fmt::format("{}: a budget of 0 Gaussians, expected 1 or more",
                                model.source.empty() ? "model" : model.source));
    Coarsener coarsener(model);
    std::vector<Gaussians> results;
    for (const std::size_t budget : budgets) results.push_back(coarsener.model(budget));
    return results;
}

Gaussians coarsen(const Gaussians& model, std::size_t budget) {
    return std::move(coarsen(model, std::span(&budget, 1)).front());
}

std::vector<std::size_t> detail_budgets(std::size_t size, std::size_t most) {
    std::vector<std::size_t> budgets;
    for (std::size_t count = size / kLevelRatio;
         count >= kCoarsest / 2 && budgets.size() + 1 < most; count /= kLevelRatio)
        budgets.push_back(count);
    return budgets;
}

std::vector<Gaussians> detail_levels(Gaussians model, std::size_t most) {
    std::vector<Gaussians> coarser = coarsen(model, detail_budgets(model.size(), most));
    std::vector<Gaussians> levels;
    levels.push_back(std::move(model));
    for (Gaussians& level : coarser) levels.push_back(std::move(level));
    return levels;
}

}  // namespace vog
