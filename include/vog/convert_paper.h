// vog/convert_paper.h: conversion of voxels to Gaussians by the paper's strategies.
// Source: Sharma & Schmalstieg, "3D Gaussian Modeling and Ray Marching of OpenVDB datasets for
// Scientific Visualization" (the paper), section 3; arXiv 2504.04857 (its companion), section 4.
// Departures from their text: docs/method.md.
// A leaf is a block of 8^3 voxels, dense if all are active. A group of voxels becomes one Gaussian
// in its bounding box: the paper's radius is half the box, the standard deviation radius / sqrt(2).
#pragma once

#include <optional>
#include <string>

#include "vog/gaussians.h"
#include "vog/levels.h"
#include "vog/progress.h"
#include "vog/volume.h"

namespace vog {

/// Strategies to group the active voxels of a volume. The first three are the paper's and divide
/// dense leaves into blocks of PaperOptions::dense_block; the others are the companion's.
enum class Strategy {
    smart_grouping,     ///< 2^3 blocks, then face-adjacent pairs along X, Y, Z, then single voxels
    strict_blocks,      ///< 2^3 blocks, then single voxels
    single_per_leaf,    ///< one group per leaf
    variance_clusters,  ///< cubes of a leaf, divided into eighths until their variance is small
    leaf_clusters,      ///< boxes of neighbouring leaves of similar mean density
    tree_mirror,        ///< one group per tree node of one depth
};

/// Rules for the peak density of a group's Gaussian.
enum class Amplitude {
    mean,  ///< mean density of the group, as in the paper
    mass,  ///< density at which the truncated Gaussian has the mass of the group
};

/// Options of convert_paper.
struct PaperOptions {
    Strategy strategy = Strategy::smart_grouping;  ///< grouping of voxels
    int dense_block = 2;  ///< the paper's strategies: block edge in dense leaves, 2, 4 or 8 voxels
    Amplitude amplitude = Amplitude::mean;  ///< peak density
    float opacity_threshold = 1e-4f;        ///< mean density, >= 0, up to which a group is dropped
    float minimum_radius_voxels = 0.1f;     ///< least radius, voxels, [0, 1e6]
    /// Share of its peak at which a Gaussian is cut, [1.3e-14, 1): cutoff = sqrt(-2 ln kappa).
    float kappa = 0.01f;
    /// variance_clusters: largest variance of density in a cube, as a share of the variance over
    /// all leaves, >= 0.
    float variance_threshold = 0.01f;
    /// leaf_clusters: largest difference of the means of two leaves, as a share of the larger one,
    /// [0, 1].
    float similarity = 0.1f;
    int tree_depth = 3;  ///< tree_mirror: 1: nodes of 4096^3 voxels, 2: 128^3, 3: leaves, 8^3
    /// Gaussians::origin, world units. None: model_origin of the data's box. For parts of one model.
    std::optional<Vec3d> origin{};
    Progress progress{};  ///< called with the finished fraction; empty: not
};

/// Name of a strategy for `vog convert --set strategy`: smart, strict, single, variance, neighbours,
/// tree, in the order of the enumeration.
std::string strategy_name(Strategy strategy);
/// Strategy of such a name. throws vog::Error listing the names for an unknown one
Strategy strategy_from_name(const std::string& name);

/// Options of a level of detail in the paper's tables: dense_block 2, 4, 8, 8, 8 with
/// smart_grouping (1 to 3), strict_blocks (4) and single_per_leaf (5).
/// lod     1 (finest) to 5
/// throws  vog::Error for another lod
PaperOptions paper_lod(int lod);

/// Converts a volume by one of the paper's strategies. Each tile becomes one Gaussian.
/// volume   density >= 0, any affine transform
/// returns  Gaussians in world space, in leaf order, then tiles; the same bytes for any number of
///          threads. Empty if no group's mean exceeds the opacity threshold
/// throws   vog::Error if an option is out of range, the volume is empty, or a value is negative or
///          not finite
/// cost     O(active voxels) time, O(Gaussians) memory, parallel over leaves
[[nodiscard]] Gaussians convert_paper(const Volume& volume, const PaperOptions& options = {});

/// Converts the levels of an adaptive mesh to one model, part by part of `data`. Box and
/// source_voxels are those of all levels.
/// throws  vog::Error as above, or if `data` has no parts
[[nodiscard]] Gaussians convert_paper(const Composite& data, const PaperOptions& options = {});

}  // namespace vog
