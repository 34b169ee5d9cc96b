// grouping.h: how the strategies of the paper and of its companion divide voxels into groups.
#pragma once

#include <vector>

#include "convert/paper/group_gaussian.h"

namespace vog::paper {

// The paper's own: one leaf at a time (paper_leaf_groups.cpp).

/// A leaf of 512 active voxels in blocks of edge^3 voxels, edge 2, 4 or 8.
void add_dense_blocks(const GroupFit& fit, const Leaf& leaf, int edge,
                      std::vector<FittedGaussian>& out);
/// Full aligned 2^3 blocks; then, in memory order, each voxel left with its neighbour along X, else
/// Y, else Z; then singles.
void add_smart_groups(const GroupFit& fit, const Leaf& leaf, std::vector<FittedGaussian>& out);
/// Full aligned 2^3 blocks, then every other voxel alone.
void add_strict_blocks(const GroupFit& fit, const Leaf& leaf, std::vector<FittedGaussian>& out);
/// The active voxels of a leaf in their minimum bounding box; count 0 if there are none.
Group leaf_group(const Leaf& leaf);
/// That group, if there is one.
void add_single(const GroupFit& fit, const Leaf& leaf, std::vector<FittedGaussian>& out);

// The companion's (paper_clusters.cpp).

/// Variance of the values of all active voxels in leaves. Tiles are left out: one of 4096^3 would
/// outweigh every leaf.
double leaf_value_variance(const Volume& volume);
/// BinarySplits the leaf along every axis (8^3, 4^3, 2^3, 1) until the variance of the values in a
/// part's tight box, its inactive voxels counted as zeros, is at most `variance`.
void add_variance_clusters(const GroupFit& fit, const Leaf& leaf, double variance,
                           std::vector<FittedGaussian>& out);

/// leaf_group of every leaf, in leaf order.
std::vector<Group> leaf_groups(const Volume& volume);
/// Joins leaves that fill a box inside one lower node (128^3) and whose means differ from the
/// first one's by at most `similarity` of the larger of the two.
std::vector<Group> join_neighbours(const Volume& volume, const std::vector<Group>& leaves,
                                   double similarity);
/// One group a tile.
std::vector<Group> tile_groups(const Volume& volume);
/// One group a node: root's children (depth 1), their children (2), leaves (3). Tiles below that
/// depth belong to their node, tiles at or above it are nodes themselves.
std::vector<Group> mirror_tree(const Volume& volume, const std::vector<Group>& leaves, int depth);

}  // namespace vog::paper
