// vog/convert_points.h: particles to Gaussians: one for each, or any smaller number by moments.
// Source: Sharma & Schmalstieg, "Unstructured Point Clouds". Departures: a particle's Gaussian has
// its value as mass, not as peak, and a width from its neighbours (docs/particles.md).
#pragma once

#include <string>

#include "vog/convert_moments.h"
#include "vog/gaussians.h"
#include "vog/points.h"
#include "vog/progress.h"

namespace vog {

struct PointOptions {
    std::string value =
        "count";                ///< mass of a particle: "count" (1), "speed" or an attribute, >= 0
    double radius = 0;          ///< standard deviation of a particle's Gaussian, world units; 0:
                                ///< adaptive, half the distance to a near neighbour
    int neighbours = 8;         ///< adaptive: which neighbour, 1 (the nearest) to 64
    int block_voxels = 0;       ///< uniform cut: edge of a cell in voxels of point_voxel_size, a
                                ///< power of two, 1 to 128; 0: no
    std::size_t budget = 0;     ///< best cut with at most this many Gaussians; 0: no
    double error = 0;           ///< smallest cut with a measured error up to this, (0, 1); 0: no.
                                ///< None of the three: one Gaussian a particle
    double mass_threshold = 0;  ///< the lightest go, up to this share of the mass, [0, 1)
    bool axis_aligned = false;  ///< variances along the world axes only: 28 bytes, not 44
    bool measure = false;       ///< measure the error of a uniform cut or a budget too
    /// Processes that each hold all particles: adaptive widths are computed in shares, everything
    /// else by each process.
    const Collective* collective = nullptr;
    Progress progress{};
};

/// Levels of detail 1 (finest) to 5: uniform cells of 2, 4, 8, 16, 32 voxels.
/// throws vog::Error outside 1..5
PointOptions point_lod(int lod);

void set_cut(PointOptions& options, const CellChoice& cut);

/// Gaussians whose masses, after the cut of their kernel at kMomentCutoff, sum to the particles'
/// values. One a particle: isotropic, in the order of the particles, those of value 0 left out.
/// Fewer: each with the mass, mean and covariance of several, cut from a tree of moments. The same
/// bytes for any number of threads.
/// The error is against one Gaussian a particle, over the eight views of MomentReport.
/// throws vog::Error if an option is out of range, two cuts are asked for, a value is negative or
///        all are zero, or the radius is adaptive and all particles lie in one place
/// cost   O(N log N) time, 28 bytes a particle and 150 for a budget, besides the particles
[[nodiscard]] Gaussians convert_points(const Points& points, const PointOptions& options = {},
                                       MomentReport* report = nullptr);

/// The paper's particles: isotropic Gaussians of one radius whose peak is the particle's value, in
/// the order of a PointDataGrid's leaves and voxels.
/// value   what the opacity encodes; the paper's: "speed"
/// radius  the paper's, sqrt(2) standard deviations, world units; 0: half a voxel of
///         point_voxel_size
/// kappa   density at which the kernel is cut: k = sqrt(-2 ln kappa), as in PaperOptions
/// throws  vog::Error as convert_points does
[[nodiscard]] Gaussians convert_points_paper(const Points& points,
                                             const std::string& value = "speed", double radius = 0,
                                             float kappa = 0.01f);

}  // namespace vog
