// moment_job.h: state shared by the stages of one moment conversion, and those stages.
#pragma once

#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "compare/error_views.h"
#include "convert/moments/cells/lattice_field.h"
#include "convert/moments/cells/overlapping_cells.h"
#include "convert/moments/cells/packed_cells.h"
#include "convert/moments/em/em_step.h"
#include "convert/moments/periodic_lattice.h"
#include "convert/moments/stage_clock.h"
#include "vog/convert_moments.h"
#include "vog/distributed.h"

namespace vog::moments {

using namespace comparison;

/// Default soft steps of a uniform cut: kSoftSteps for up to 4 million voxels, beyond as many as
/// keep voxels times steps below this, ten to fifteen seconds on two cores.
inline constexpr double kVoxelSteps = 1e8;
/// The fewest of them where cells do not overlap: meshes, cells above 8 voxels.
inline constexpr int kLeastSoftSteps = 4;

/// Samples of volumes: active voxels of leaves, and 8^3 of each tile, whatever its size.
std::uint64_t sample_count(std::span<const Volume> parts);

/// A kept cell of a uniform cut, while its voxels are at hand.
struct CutCell {
    const MortonNode& node;
    const OverlapScratch* windows;  ///< of the node; null: hard cells
    const MomentSums& sums;         ///< about the centre
    Vec3d center;                   ///< index space
};
/// Called with each cell and the index of its Gaussian.
using CellSink = std::function<void(const CutCell& cell, std::size_t gaussian)>;
/// Takes the cells of a uniform cut of at most a leaf's edge, for sums of other quantities in the pass that makes
/// their Gaussians.
struct CellReceiver {
    std::function<void(std::size_t gaussians)> begin;
    std::function<CellSink()> sink_of_chunk;  ///< called by several threads, each sink by one
};

/// Input, options and report of one conversion.
struct MomentJob {
    std::span<const Volume> parts;  ///< disjoint
    Box box;                        ///< bounds of the whole data, world space
    bool levels = false;  ///< parts are levels of a mesh: several lattices under one budget
    const MomentOptions& options;
    MomentReport& report;
    /// Active voxels of the data: no cut has more cells. Unknown: the largest number.
    std::uint64_t most_cells = std::numeric_limits<std::uint64_t>::max();
    /// World volume that masses are counted in: a voxel of the first part, which makes them sums of
    /// values; between processes that share levels, the largest of those.
    double unit_volume = 1;
    double data_mass = 0;   ///< all parts and processes; density times unit_volume
    double least_mass = 0;  ///< of the cells kept by the mass threshold, likewise
    StageClock clock{report, options.progress};
    CellReceiver* receiver = nullptr;  ///< takes the cells where has_fine_cells(); null: none

    const Collective& collective() const { return collective_or_single(options.collective); }
    /// Whether a uniform cut begins with overlapping cells; of levels only that of their voxels.
    bool overlaps() const {
        return options.soft_steps < 0 && options.block_voxels &&
               (!levels || options.block_voxels == 1) && options.block_voxels <= kLeafEdge &&
               !options.collective && (!options.periodic || window_period());
    }
    /// Voxels of a periodic box across whose faces windows go.
    std::optional<IndexBox> window_period() const {
        return leaf_period(options.periodic, volume().world_from_index);
    }
    /// Whether these share voxels: a cell of one voxel has that voxel alone.
    bool shares_voxels() const { return overlaps() && options.block_voxels > 1; }
    int soft_steps() const;
    /// Whether the model has one Gaussian for each kept cell of a uniform cut, unchanged.
    bool has_uniform_cells() const {
        return options.block_voxels && !levels && soft_steps() == 0 && options.refine_seconds == 0;
    }
    /// Whether these are cells of at most a leaf's edge, made in two passes.
    bool has_fine_cells() const { return has_uniform_cells() && options.block_voxels <= kLeafEdge; }
    /// Largest measured error of an adaptive cut without a budget.
    double error() const { return options.error > 0 ? options.error : kDefaultError; }
    std::uint64_t samples() const { return sample_count(parts); }
    /// Values of all parts, for the default's limit: active voxels of leaves, and one of each tile; few
    /// tiles count as their samples, up to 2^16 in all.
    std::uint64_t values() const;
    /// interpolation  ErrorViews::interpolation of the parts
    void report_error(const RelativeError& error, const RelativeError& interpolation,
                      const ErrorViews& views) {
        report.measured_error = error.worst, report.mean_error = error.mean;
        report.interpolation_error = interpolation.worst;
        report.mean_interpolation_error = interpolation.mean;
        report.view_note = views.note();
    }
    const Volume& volume() const { return parts.front(); }
    Vec3d origin() const { return options.origin.value_or(model_origin(box)); }
    /// Constants of the Gaussians of a field; their means are relative to origin().
    MomentFrame frame(const Affine& world_from_index) const {
        return moment_frame({world_from_index.linear, world_from_index.translation - origin()},
                            options.axis_aligned, options.spread);
    }
    /// Volume of the field's voxels, in unit_volume.
    double voxels_in(const LatticeField& field) const {
        return levels ? field.voxel_volume() / unit_volume : 1;
    }
    std::vector<LatticeField> fields() const { return fields(parts); }
    /// The same of other densities at the voxels of the parts.
    std::vector<LatticeField> fields(std::span<const Volume> densities) const {
        if (levels) return lattice_fields(densities);
        std::vector<LatticeField> one;
        one.push_back(lattice_field(densities.front()));
        return one;
    }
};

/// Cells of every field.
using FieldCells = std::vector<PackedCells>;

/// Expectation-maximisation over the cells of all fields, each with its own momentum.
class FieldEmSolver {
  public:
    /// keep_momentum  whether calls of step() follow run(); if not, run() frees the momenta
    /// period         MomentOptions::periodic
    FieldEmSolver(std::span<const LatticeField> fields, bool keep_momentum,
                  const std::optional<Box>& period = {})
        : histories_(fields.size()), keep_momentum_(keep_momentum) {
        for (const LatticeField& field : fields)
            solvers_.emplace_back(field.bricks, image_shifts(period, field.world_from_index));
    }
    void step(FieldCells& cells) {
        for (std::size_t f = 0; f < solvers_.size(); ++f)
            if (!cells[f].empty()) solvers_[f].step(cells[f], histories_[f]);
    }
    /// `steps` EM steps from hard cells, without momentum at first.
    void run(FieldCells& cells, int steps) {
        reset_momentum();
        for (int n = 0; n < steps; ++n) step(cells);
        if (!keep_momentum_) reset_momentum();
    }
    /// For cells that are not the result of the last step.
    void reset_momentum() { histories_ = std::vector<EmHistory>(solvers_.size()); }

  private:
    std::vector<EmSolver> solvers_;
    std::vector<EmHistory> histories_;
    bool keep_momentum_;
};

/// One Gaussian for each cell, field after field.
Gaussians all_gaussians(const MomentJob& job, std::span<const LatticeField> fields,
                        FieldCells cells);
/// Gaussians of the cells above the mass threshold; records the dropped mass in job.report.
Gaussians thresholded_gaussians(MomentJob& job, std::span<const LatticeField> fields,
                                FieldCells cells);

/// The thresholded model and its relative L2 error of T over `views`.
struct MeasuredModel {
    Gaussians model;
    RelativeError error;
};
MeasuredModel measured_model(MomentJob& job, std::span<const LatticeField> fields,
                             const ErrorViews& views, FieldCells cells);

/// Rounds of split-and-merge followed by EM. Keeps a round only if the visible error of the views
/// falls; the number of cells stays.
/// go_on  evaluated before each EM step and each round; false ends the refinement
FieldCells refine(MomentJob& job, std::span<const LatticeField> fields, FieldEmSolver& em,
                  FieldCells cells, const std::function<bool()>& go_on);

/// Thresholded model of the cells, refined for options.refine_seconds before.
Gaussians final_model(MomentJob& job, std::span<const LatticeField> fields, FieldEmSolver& em,
                      FieldCells cells);

/// --block: cells of one size.
Gaussians uniform_model(MomentJob& job);
/// --budget and --error: the optimal cut.
Gaussians adaptive_model(MomentJob& job);

}  // namespace vog::moments
