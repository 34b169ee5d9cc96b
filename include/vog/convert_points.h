// vog/convert_points.h: conversion of particles to Gaussians, one each or fewer by moments.
// Source: Sharma & Schmalstieg, "Unstructured Point Clouds". Departures: a particle's Gaussian has
// the particle's value as mass, not as peak, and a width from its neighbours (docs/particles.md).
// A cell is a group of particles; its Gaussian has their mass, mean and covariance
// (vog/convert_moments.h).
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vog/convert_moments.h"
#include "vog/gaussians.h"
#include "vog/points.h"
#include "vog/progress.h"

namespace vog {

/// A field of a model of particles (vog/fields.h).
struct PointField {
    /// `velocity` (a vector), a name as of point_values, or that of a vector in three attributes, `wind` for wind_x
    /// wind_y wind_z.
    std::string values;
    std::string name{};  ///< name of the field; empty: `values`
};

inline constexpr const char* kAutoSmoothing = "auto";
/// Cutoff at which a truncated Gaussian of its variance is nearest to the cubic spline: the columns of one kernel differ by 1.6 %
/// in L2 (6.8 % at 2.25), those of overlapping ones by less.
inline constexpr float kSplineCutoff = 2.75f;

/// Options of convert_points. Cells are chosen by one of block_voxels, budget and error; by none:
/// one Gaussian a particle.
struct PointOptions {
    /// Mass of a particle, >= 0: "count" (1), "speed" or the name of an attribute.
    std::string value = "count";
    /// Standard deviation of a particle's Gaussian, world units, > 0. 0: by `smoothing`, else adaptive, half the
    /// distance to the neighbour number `neighbours`.
    double radius = 0;
    int neighbours = 8;  ///< rank of the neighbour by distance, 1 (nearest) to 64
    /// Attribute with the radius at which a particle's kernel ends, > 0: its Gaussian has the variance of a cubic spline, 3/40
    /// of the radius squared, and the cutoff kSplineCutoff. kAutoSmoothing: smoothing_radius. Empty: none.
    std::string smoothing = kAutoSmoothing;
    /// Periodic box: positions are wrapped into it, neighbours found across its faces, and Gaussians that cross a face have
    /// images behind the opposite one (vog/periodic.h). None: open; an empty box:
    /// the one that the points state.
    std::optional<Box> periodic{};
    /// Uniform cells: edge, in voxels of edge point_voxel_size, a power of two, 1 to 128; 0: no.
    int block_voxels = 0;
    std::size_t budget = 0;  ///< adaptive cells: largest number of Gaussians; 0: no
    /// Adaptive cells: largest measured error, (0, 1), with the fewest Gaussians; 0: no. The
    /// reference is the model of one Gaussian a particle.
    double error = 0;
    /// Largest share of the mass that is dropped with the lightest cells, [0, 1).
    double mass_threshold = 0;
    bool axis_aligned = false;  ///< diagonal covariance, no rotations: 28 bytes each, not 44
    bool measure = false;       ///< report the measured error of block_voxels or a budget too
    /// Processes that each hold all particles (vog/distributed.h): the adaptive widths are divided
    /// among them, everything else is done by each. Null: a single process.
    const Collective* collective = nullptr;
    Progress progress{};  ///< called with the finished fraction; empty: not
    /// Fields of the model, weighted by the particles' masses. A particle's value is constant over its
    /// Gaussian; a cell has the joint moments of its particles.
    std::vector<PointField> fields{};
};

/// Attribute that sets the radii under these options; empty name: none does.
/// throws  vog::Error for options.smoothing that is no attribute
SmoothingRadius chosen_smoothing(const Points& points, const PointOptions& options);

/// Converts particles to Gaussians truncated at kMomentCutoff (one each of stated kernels: kSplineCutoff), whose masses sum to the particles'
/// values.
/// report   receives the results, as of convert_moments; the reference of its measured error is the
///          model of one Gaussian a particle; null: not reported
/// returns  one a particle: isotropic, in the order of the particles, without those of value 0; by
///          cells: one each. World units; the same bytes for any number of threads
/// throws   vog::Error if an option is out of range, two choices of cells are set, a value is
///          negative or all are zero, a field is unknown (the names are listed), or the radius is adaptive and all particles are in one place
/// cost     O(N log N) time; besides the particles 28 bytes each, and 150 for a budget
[[nodiscard]] Gaussians convert_points(const Points& points, const PointOptions& options = {},
                                       MomentReport* report = nullptr);

/// Converts particles as the paper does: isotropic Gaussians of one radius whose peak density is
/// the particle's value, in the order of a PointDataGrid's leaves and voxels.
/// value   peak density, >= 0, by its name as in PointOptions; "speed" in the paper
/// radius  sqrt(2) standard deviations, world units, > 0; 0: half of point_voxel_size
/// kappa   share of its peak at which a Gaussian is cut, [1.3e-14, 1): cutoff = sqrt(-2 ln kappa)
/// fields  as PointOptions::fields
/// throws  vog::Error as convert_points does
[[nodiscard]] Gaussians convert_points_paper(const Points& points,
                                             const std::string& value = "speed", double radius = 0,
                                             float kappa = 0.01f,
                                             std::span<const PointField> fields = {});

}  // namespace vog
