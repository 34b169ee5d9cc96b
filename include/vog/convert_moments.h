// vog/convert_moments.h: voxels to Gaussians by moments, without training.
// A Gaussian has the mass, mean and covariance of the voxels it replaces, all three after the cut
// of its kernel (docs/moments.md). The sums are additive, so one bottom-up pass gives every node of
// an octree its own Gaussian; a model is a cut through that octree.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "vog/gaussians.h"
#include "vog/levels.h"
#include "vog/progress.h"
#include "vog/volume.h"

namespace vog {

struct Collective;

/// Standard deviations at which moment Gaussians are cut.
inline constexpr float kMomentCutoff = 2.25f;

struct MomentOptions {
    int block_voxels = 0;    ///< uniform cut: edge of a cell, a power of two, 1 to 128; 0: no
    std::size_t budget = 0;  ///< best cut with at most this many Gaussians; 0: no
    double error = 0.03;     ///< smallest cut with a measured error up to this, where neither
                             ///< block_voxels nor budget is given; (0, 1)
    int soft_steps = -1;     ///< steps from hard cells to soft ones, 0 to 1000; -1: none for a
                             ///< uniform cut, kSoftSteps for a budget, kSearchSoftSteps for
                             ///< an error, which makes several models
    float spread = 1;        ///< widens each standard deviation at constant mass, [0.5, 2]
    double mass_threshold = 1e-4;  ///< the lightest cells go, up to this share of the mass, [0, 1)
    double refine_seconds = 0;  ///< soft steps, and cells moved to where pictures err, for so long,
                                ///< while they err less: no more the same bytes each time; [0, 1e6]
    bool axis_aligned = false;  ///< variances along the world axes only: 28 bytes, not 44
    bool measure = false;       ///< measure the error of a uniform cut or a budget too
    /// Processes that each hold a part of the volume. Only for block_voxels with soft_steps 0; parts
    /// must be aligned to cells, then the union of the results equals the single-process model.
    const Collective* collective = nullptr;
    Progress progress{};
};
inline constexpr int kSoftSteps = 24, kSearchSoftSteps = 12;

/// One way to choose cells, as commands and bindings are asked for it; 0: not asked. None of them:
/// what the conversion does unasked.
struct CellChoice {
    int block_voxels = 0;
    std::size_t budget = 0;
    double error = 0;
    int lod = 0;  ///< moment_lod or point_lod
};
/// throws vog::Error where two are asked for: "block and budget exclude each other"
void set_cut(MomentOptions& options, const CellChoice& cut);

/// What the conversion did and reached.
struct MomentReport {
    double mass_ratio = 1;          ///< of all cells to the volume, before any is dropped
    double dropped_mass_share = 0;  ///< lost to the threshold, of the volume's mass
    std::size_t dropped_cells = 0;
    /// Relative L2 of T over eight views around the volume, 256^2 pixels each; below 0: not
    /// measured. Above MomentOptions::error where even the finest cut is.
    double measured_error = -1;
    std::vector<std::pair<std::string, double>> stage_ms;  ///< in the order they ran
};

/// What convert_moments and convert_points say in Gaussians::summary: counts, mass, measured error.
/// of  what the model stands for: "active voxels", "particles"
std::string summary_text(const Gaussians& model, const MomentReport& report, const std::string& of);
std::string summary_text(std::uint64_t gaussians, std::uint64_t source_voxels,
                         const MomentReport& report, const std::string& of);

/// Levels of detail 1 (finest) to 5: uniform cells of 2, 4, 8, 16, 32 voxels.
/// throws vog::Error outside 1..5
MomentOptions moment_lod(int lod);

/// returns  Gaussians in world space, in Morton order of their cells: the same bytes for any number
///          of threads
/// throws   vog::Error if an option is out of range, both a block and a budget are asked for, the
///          volume has no mass, a value is negative or not finite
/// cost     O(active voxels) time for a uniform cut, with the memory of its result; the others take
///          as much again for each soft step, the search for an error a few times that
[[nodiscard]] Gaussians convert_moments(const Volume& volume, const MomentOptions& options = {},
                                        MomentReport* report = nullptr);

/// Levels of an adaptive mesh as one model: one octree takes the cells of all levels whose lattices
/// divide each other in halves, so that seams do not show; levels that fit no other have an octree
/// of their own, under the same budget. A block counts voxels of each level up to 8, then voxels of
/// the coarsest.
/// throws   as above, or if no part is left
[[nodiscard]] Gaussians convert_moments(const Composite& data, const MomentOptions& options = {},
                                        MomentReport* report = nullptr);

/// One node of the moment octree: what is inside the cube [origin, origin + edge) of voxels.
/// Index space: lengths in voxels, mass in density times voxels. Voxels count as boxes.
struct MomentCell {
    Vec3i origin;                       ///< multiples of the level's edge
    float mass = 0;                     ///< > 0
    Vec3f mean;                         ///< from the centre of the cube
    std::array<float, 6> covariance{};  ///< xx xy xz yy yz zz
    std::uint32_t first_child = 0;      ///< in the next finer level
    std::uint32_t child_count = 0;      ///< 0: a cell of the finest level, or a tile
};

struct MomentLevel {
    int edge_log2 = 3;              ///< cells of 2^edge_log2 voxels along an edge
    std::vector<MomentCell> cells;  ///< in Morton order, so the children of a cell are contiguous
};

/// Every cell size at once. The last level is a single cell, of everything.
struct MomentOctree {
    std::vector<MomentLevel> levels;  ///< finest first
    Affine world_from_index;
};

/// finest_edge  1, 2, 4 or 8 voxels: edge of the cells of the first level. 8: the tree's own
///              leaves, 64 bytes to each leaf of the volume; 2: up to 4.7 kB to each.
/// throws       vog::Error as convert_moments does
[[nodiscard]] MomentOctree moment_octree(const Volume& volume, int finest_edge = 8);

/// The Gaussians of these cells of one level.
[[nodiscard]] Gaussians cell_gaussians(const MomentOctree& octree, std::size_t level,
                                       std::span<const std::uint32_t> cells);

}  // namespace vog
