// moment_job.h: what the stages of one moment conversion share: what is asked, the cells of
// all fields, how they are softened and become the model.
#pragma once

#include <span>
#include <vector>

#include "compare/error_views.h"
#include "convert/moments/cells/lattice_field.h"
#include "convert/moments/cells/packed_cells.h"
#include "convert/moments/em/em_step.h"
#include "convert/moments/stage_clock.h"
#include "vog/convert_moments.h"
#include "vog/distributed.h"

namespace vog::moments {

using namespace comparison;

/// One conversion: what is asked, and what is to be reported.
struct MomentJob {
    std::span<const Volume> parts;  ///< volumes that do not overlap
    Box box;
    bool levels = false;  ///< parts of levels: of several lattices, under one budget
    const MomentOptions& options;
    MomentReport& report;
    double data_mass = 0;  ///< of all parts, in unit volumes
    StageClock clock{report, options.progress};

    const Collective& collective() const { return collective_or_single(options.collective); }
    int soft_steps() const {
        if (options.soft_steps >= 0) return options.soft_steps;
        return options.block_voxels ? 0 : options.budget ? kSoftSteps : kSearchSoftSteps;
    }
    const Volume& volume() const { return parts.front(); }
    MomentFrame frame(const Affine& world_from_index) const {
        return moment_frame(world_from_index, options.axis_aligned, options.spread);
    }
    /// Unit volumes in a voxel of the field's.
    double voxels_in(const LatticeField& field) const {
        return levels ? field.voxel_volume() / unit_volume() : 1;
    }
    /// What masses are in: voxels of the first part, which others may not have.
    double unit_volume() const {
        return levels && collective().shared() ? 1 : voxel_volume(volume());
    }
    std::vector<LatticeField> fields() const {
        if (levels) return lattice_fields(parts);
        std::vector<LatticeField> one;
        one.push_back(lattice_field(volume()));
        return one;
    }
};

/// Cells of every field.
using FieldCells = std::vector<PackedCells>;

/// The softeners of all fields, and how far each has come.
class FieldEmSolver {
  public:
    /// goes_on  steps will follow those of `soften`: what they remember is kept
    FieldEmSolver(std::span<const LatticeField> fields, bool goes_on)
        : steps_(fields.size()), goes_on_(goes_on) {
        for (const LatticeField& field : fields) softeners_.emplace_back(field.bricks);
    }
    void step(FieldCells& cells) {
        for (std::size_t f = 0; f < softeners_.size(); ++f)
            if (!cells[f].empty()) softeners_[f].step(cells[f], steps_[f]);
    }
    /// From hard cells.
    void soften(FieldCells& cells, int steps) {
        forget();
        for (int n = 0; n < steps; ++n) step(cells);
        if (!goes_on_) forget();
    }

    /// Cells that did not come from the last ones are next.
    void forget() { steps_ = std::vector<EmHistory>(softeners_.size()); }

  private:
    std::vector<EmSolver> softeners_;
    std::vector<EmHistory> steps_;
    bool goes_on_;
};

/// One Gaussian for each cell, field after field.
Gaussians all_gaussians(const MomentJob& job, std::span<const LatticeField> fields,
                        FieldCells cells);
/// The model of the cells, without the lightest, which are told in the report.
Gaussians gaussians_of(MomentJob& job, std::span<const LatticeField> fields, FieldCells cells);
/// The model of the cells as it will be written, and its relative L2 error over `views`.
struct MeasuredModel {
    Gaussians model;
    double error = -1;
};
MeasuredModel measured_model(MomentJob& job, std::span<const LatticeField> fields,
                             const ErrorViews& views, FieldCells cells);
/// For the seconds asked for, soft steps and cells taken from where they are of little use to where
/// pictures err, as long as the pictures err less: as many cells as before.
FieldCells refined(MomentJob& job, std::span<const LatticeField> fields, FieldEmSolver& softener,
                   FieldCells cells);
/// The refined cells, if that is asked for, as a model.
Gaussians finished(MomentJob& job, std::span<const LatticeField> fields, FieldEmSolver& softener,
                   FieldCells cells);

/// A uniform cut.
Gaussians block_model(MomentJob& job);
/// The cut of a budget, or the search for an error.
Gaussians best_model(MomentJob& job);

}  // namespace vog::moments
