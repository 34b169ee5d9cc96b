// grouping.h: groups of voxels: the strategies of the paper and of its companion.
#pragma once

#include <vector>

#include "convert/paper/group_gaussian.h"

namespace vog::paper {

// The paper's own: one leaf at a time (leaf_grouping.cpp).

/// Divides a leaf of 512 active voxels into blocks of edge^3.
/// edge  2, 4 or 8 voxels
void add_dense_blocks(const GroupFit& fit, const Leaf& leaf, int edge,
                      std::vector<FittedGaussian>& out);
/// Smart grouping: full aligned 2^3 blocks; then, in memory order, each voxel left with its
/// neighbour along x, else y, else z; single voxels otherwise.
void add_smart_groups(const GroupFit& fit, const Leaf& leaf, std::vector<FittedGaussian>& out);
/// Strict blocks: full aligned 2^3 blocks, and every other voxel alone.
void add_strict_blocks(const GroupFit& fit, const Leaf& leaf, std::vector<FittedGaussian>& out);
/// The active voxels of a leaf with their bounding box; count 0 if there are none.
Group leaf_group(const Leaf& leaf);
/// Appends the Gaussian of leaf_group, if it has voxels.
void add_single(const GroupFit& fit, const Leaf& leaf, std::vector<FittedGaussian>& out);

// The companion's (companion_clusters.cpp).

/// Variance of the values of all active voxels in leaves. Tiles do not count: one of 4096^3 voxels
/// would outweigh all leaves.
double leaf_value_variance(const Volume& volume);
/// Divides a leaf into octants (8^3, 4^3, 2^3, 1) until the variance of the values in a part's
/// tight box, its inactive voxels counted as zeros, is at most `variance`.
void add_variance_clusters(const GroupFit& fit, const Leaf& leaf, double variance,
                           std::vector<FittedGaussian>& out);

/// leaf_group of every leaf, in leaf order.
std::vector<Group> leaf_groups(const Volume& volume);
/// Joins leaves that fill a box inside one lower node (128^3 voxels) and whose means differ from
/// the first one's by at most `similarity` times the larger of the two.
std::vector<Group> join_neighbours(const Volume& volume, const std::vector<Group>& leaves,
                                   double similarity);
/// One group for each tile.
std::vector<Group> tile_groups(const Volume& volume);
/// One group for each node of the tree at a depth: children of the root (1), their children (2),
/// leaves (3). Tiles below that depth belong to their node; tiles at or above it are groups of
/// their own.
std::vector<Group> mirror_tree(const Volume& volume, const std::vector<Group>& leaves, int depth);

}  // namespace vog::paper
