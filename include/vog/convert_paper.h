// vog/convert.h: turn a sparse density volume into 3D Gaussians.
// Source: Sharma & Schmalstieg, "3D Gaussian Modeling and Ray Marching of OpenVDB datasets for
// Scientific Visualization", section 3, and its companion arXiv 2504.04857, section 4.
// Departures from their text: docs/method.md.
#pragma once

#include <string>

#include "vog/gaussians.h"
#include "vog/levels.h"
#include "vog/progress.h"
#include "vog/volume.h"

namespace vog {

/// How the voxels of leaves are grouped; each group becomes one axis-aligned Gaussian.
enum class Strategy {
    smart_grouping,     ///< 2^3 blocks, then face-adjacent pairs along X, Y, Z, then singles
    strict_blocks,      ///< 2^3 blocks, then single voxels
    single_per_leaf,    ///< one Gaussian in the running minimum bounding box of the active voxels
    variance_clusters,  ///< companion: halve a leaf until the variance of values in a part is small
    leaf_clusters,      ///< companion: neighbouring leaves of similar mean become one Gaussian
    tree_mirror,        ///< companion: one Gaussian per tree node at a chosen depth
};

enum class Amplitude {
    mean,  ///< the paper's: the peak is the mean density of the group
    mass,  ///< the peak at which the truncated Gaussian has the mass of the group
};

struct PaperOptions {
    Strategy strategy = Strategy::smart_grouping;
    int dense_block = 2;  ///< paper: block edge in dense leaves, 2, 4 or 8 voxels
    Amplitude amplitude = Amplitude::mean;
    float opacity_threshold = 1e-4f;     ///< groups with mean density at or below this are dropped
    float minimum_radius_voxels = 0.1f;  ///< radii are raised to this
    float kappa = 0.01f;  ///< density at which the paper cuts a Gaussian: k = sqrt(-2 ln kappa)
    float variance_threshold = 0.01f;  ///< variance: of that of all values in leaves, >= 0
    float similarity = 0.1f;  ///< neighbours: relative difference of means that joins, [0, 1]
    int tree_depth = 3;       ///< tree: 1 root's children (4096^3), 2 (128^3), 3 leaves (8^3)
    Progress progress{};
};

/// smart, strict, single, variance, neighbours, tree: what `vog convert --strategy` takes.
std::string strategy_name(Strategy strategy);
/// throws vog::Error listing the names if there is none such
Strategy strategy_from_name(const std::string& name);

/// Levels 1 (finest) to 5 (coarsest) of the paper's tables: dense blocks 2, 4, 8, 8, 8 with smart
/// grouping (1-3), strict blocks (4) and a single Gaussian per leaf (5).
/// throws vog::Error outside 1..5
PaperOptions paper_lod(int lod);

/// The paper's conversion, one leaf a task; each tile becomes one Gaussian. The companion's
/// strategies treat dense leaves like all others.
/// volume   density >= 0, any affine transform
/// returns  Gaussians in world space, in leaf order, then tiles: the same bytes for any number of
///          threads. None at all where no group's mean exceeds the opacity threshold
/// throws   vog::Error if an option is out of range, the volume is empty or a value is negative or
///          not finite
/// cost     O(active voxels) time, O(Gaussians) memory
[[nodiscard]] Gaussians convert_paper(const Volume& volume, const PaperOptions& options = {});

/// Parts of levels as one model, part by part; its box and voxels are those of all levels.
[[nodiscard]] Gaussians convert_paper(const Composite& data, const PaperOptions& options = {});

}  // namespace vog
