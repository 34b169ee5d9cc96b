// vog/convert_moments.h: conversion of voxels to Gaussians by moments, without training.
// A cell is a group of voxels; its Gaussian, truncated at kMomentCutoff, has the mass, mean and
// covariance of these voxels. Sums of moments are additive, so that one bottom-up pass gives every
// node of an octree its Gaussian. A cut through the octree, cubes that together hold every voxel
// once, is a model: uniform with cubes of one size, adaptive with small cubes where they gain most.
//   hard cell   every voxel belongs to the one cube that holds it
//   overlapping cell
//               voxels are shared by fixed windows, which reach half a cell into the neighbours
//   soft cell   voxels are shared: cell i gets the share G_i(x) / sum_j G_j(x) of the voxel at x, G
//               the Gaussians of the step before (expectation-maximisation); no ripples between
// Method and measurements: docs/moments.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vog/gaussians.h"
#include "vog/levels.h"
#include "vog/progress.h"
#include "vog/volume.h"

namespace vog {

struct Collective;
struct VoxelField;

/// A field whose values an adaptive cut follows beside the density (carried_fields in vog/convert_fields.h).
struct CarriedField {
    const std::vector<VoxelField>* levels =
        nullptr;           ///< at the volume's voxels, or those of each part
    double deviation = 1;  ///< standard deviation over the whole data, weighted by mass; > 0
};

/// Cutoff of moment Gaussians: radius of the support, standard deviations.
inline constexpr float kMomentCutoff = 2.25f;

/// Options of convert_moments. Cells are chosen by block_voxels, else by budget, else by error.
struct MomentOptions {
    int block_voxels = 0;  ///< uniform cut: edge of a cell, voxels, a power of two, 1 to 128; 0: no
    std::size_t budget = 0;  ///< adaptive cut: largest number of Gaussians; 0: no
    /// Adaptive cut of the fewest Gaussians, to 5 %, with a MomentReport::measured_error of at most
    /// this, (0, 1), or, beyond kSmallCount voxels, of at most the error of the voxels interpolated linearly. 0: kDefaultError,
    /// but at most default_count of the voxels. Used without block_voxels and budget.
    double error = 0;
    /// Expectation-maximisation steps from hard to soft cells, 0 to 1000; 0 leaves them hard: fast,
    /// but uniform ones show a grid of dots along the axes. -1: kSoftSteps for a budget,
    /// kSearchSoftSteps for an error (its search makes several models). -1 for a uniform cut:
    /// overlapping cells in place of hard ones, up to 8 voxels in a single volume; then, for 4
    /// voxels and more, kSoftSteps steps, or as many as keep steps times voxels below 1e8. Cells
    /// that cannot overlap have 4 steps at least.
    int soft_steps = -1;
    float spread = 1;  ///< factor on each standard deviation at constant mass, [0.5, 2]
    /// Largest share of the mass that is dropped with the lightest cells, [0, 1).
    double mass_threshold = 1e-4;
    /// Time for refinement, seconds, [0, 1e6]: moves cells to where pictures have the largest
    /// error, with further soft steps, as long as that error falls. 0: none. The result then
    /// depends on the speed of the machine.
    double refine_seconds = 0;
    /// Name of a field that the model carries: the volume's own values (vog/convert_fields.h). Uniform cells of up
    /// to 8 voxels without soft steps sum it while they are made, in less time than add_fields needs. Empty: no fields.
    std::string own_field{};
    /// Fields of the model: an adaptive cut has smaller cells where they vary.
    std::vector<CarriedField> carried_fields{};
    bool axis_aligned = false;  ///< diagonal covariance, no rotations: 28 bytes each, not 44
    bool measure = false;       ///< report the measured error of a uniform cut or a budget too
    /// Gaussians::origin, world units. None: model_origin of the data's box. For parts of one model.
    std::optional<Vec3d> origin{};
    /// Periodic box, world units: cells share voxels across its faces, and errors are those of the model with its images,
    /// which the caller adds (vog/periodic.h). Windows of overlapping cells cross the faces where these lie between leaves;
    /// elsewhere cells are hard before soft steps. None: open.
    std::optional<Box> periodic{};
    /// Processes that each hold a part of the volume (vog/distributed.h). Only for block_voxels
    /// with soft_steps 0, without refinement and measure; parts must be aligned to cells, then the
    /// union of the results equals the single-process model. Null: a single process.
    const Collective* collective = nullptr;
    Progress progress{};  ///< called with the finished fraction; empty: not
};
/// Default conversion: the measured error, and active voxels per Gaussian at which it stops; of more
/// than 128 tiles each counts as few voxels, down to one.
inline constexpr double kDefaultError = 0.03;
inline constexpr std::size_t kVoxelsPerGaussian = 16;
/// Gaussians that cost nothing: small data have up to one for each voxel.
inline constexpr std::size_t kSmallCount = 10000;
/// Most Gaussians of the default conversion.
constexpr std::size_t default_count(std::size_t voxels) {
    const std::size_t count = voxels / kVoxelsPerGaussian,
                      fewest = voxels < kSmallCount ? voxels : kSmallCount;
    return count > fewest ? count : fewest > 0 ? fewest : 1;
}
/// Default soft_steps for a budget and for each model in the search for an error.
inline constexpr int kSoftSteps = 24, kSearchSoftSteps = 12;

/// Cells of a uniform cut of one volume without soft steps: a Gaussian for each, in Morton order.
struct UniformCells {
    int block_voxels = 1;      ///< edge of a cell
    bool overlapping = false;  ///< else hard
    double least_mass = 0;     ///< lightest kept, density times voxels
};

/// Results of a conversion by moments.
struct MomentReport {
    double mass_ratio = 1;          ///< mass of all cells, dropped ones included / mass of the data
    double dropped_mass_share = 0;  ///< mass of the dropped cells / mass of the data, [0, 1)
    std::size_t dropped_cells = 0;  ///< number of cells below the mass threshold
    /// Relative L2 error of the optical depth T, sqrt(sum (T - T_ref)^2 / sum T_ref^2), in the worst
    /// of the error views (error_views in vog/distributed.h); T_ref by exact integration of the
    /// voxels. -1: not measured. Above MomentOptions::error if the finest cut does not achieve it.
    double measured_error = -1;
    double mean_error = -1;  ///< the same over the pixels of all views together; -1: not measured
    /// The same two of the voxels interpolated in place of a model: below these an error says nothing. Linearly between
    /// their centres; in a search for MomentOptions::error of one volume also by one Gaussian a voxel, whose errors
    /// with an eighth more count where they are larger. -1: not measured.
    double interpolation_error = -1, mean_interpolation_error = -1;
    /// Fields of the model beside the volume's own values, where errors are measured: name and relative L2 of its means
    /// (FieldDifference::mean_l2) in the worst of the same views.
    std::vector<std::pair<std::string, double>> field_errors{};
    /// Mass that the error views leave out, in words; empty: none, or not measured.
    std::string view_note;
    /// Whether the default stopped at one Gaussian to kVoxelsPerGaussian voxels, above its error.
    bool stopped_by_count = false;
    /// The voxels of each Gaussian, for fields; none: the Gaussians' densities divide them.
    std::optional<UniformCells> cells{};
    /// Stages of the conversion in their order: name and duration, milliseconds.
    std::vector<std::pair<std::string, double>> stage_ms;

    /// Whether the model is measured, and as near to the voxels as their interpolation.
    bool as_near_as_interpolation() const {
        return measured_error >= 0 && measured_error <= interpolation_error &&
               mean_error <= mean_interpolation_error;
    }
};

/// Text of Gaussians::summary after a conversion by moments: counts, mass ratio, measured error.
/// of  name of the source elements: "active voxels", "particles"
std::string summary_text(const Gaussians& model, const MomentReport& report, const std::string& of);
/// The same text by counts, for a model in several parts.
/// source_voxels  active voxels or particles of the source; 0: unknown
std::string summary_text(std::uint64_t gaussians, std::uint64_t source_voxels,
                         const MomentReport& report, const std::string& of);

/// The part of that text after the mass ratio: dropped cells, measured error; may be empty.
std::string detail_text(const MomentReport& report);

/// Options of a level of detail: uniform cells of 2, 4, 8, 16 or 32 voxels along an edge.
/// lod     1 (finest) to 5
/// throws  vog::Error for another lod
MomentOptions moment_lod(int lod);

/// Converts a volume by moments.
/// report   receives the results; null: not reported
/// returns  Gaussians in world space, in Morton order of their cells; without refine_seconds the
///          same bytes for any number of threads
/// throws   vog::Error if an option is out of range, both block_voxels and budget are set, the
///          volume has no mass, or a value is negative or not finite
/// cost     a uniform cut: O(active voxels) time, and the memory of its result; each soft step: as
///          much time again; the search for an error: a few models
[[nodiscard]] Gaussians convert_moments(const Volume& volume, const MomentOptions& options = {},
                                        MomentReport* report = nullptr);

/// Converts the levels of an adaptive mesh to one model by moments. Levels whose lattices divide
/// each other in halves share one octree, so that no seam shows; a level that fits no other has an
/// octree of its own, under the same budget. Up to 8, block_voxels counts voxels of each level;
/// above, voxels of the coarsest.
/// throws  vog::Error as above, or if `data` has no parts
[[nodiscard]] Gaussians convert_moments(const Composite& data, const MomentOptions& options = {},
                                        MomentReport* report = nullptr);

}  // namespace vog
