// vog/openvdb.h: conversion between volumes and OpenVDB grids in memory. No other public header
// includes a third-party one, so vog/vog.h leaves it out.
#pragma once

#include <openvdb/openvdb.h>

#include "vog/volume.h"

namespace vog {

/// Density volume of a grid.
/// throws  vog::Error for a level set, a non-affine or singular transform, values negative or not
///         finite (their count and the first index)
Volume volume_from_grid(const openvdb::FloatGrid& grid);

/// OpenVDB grid of class fog volume with the leaves, tiles, name and transform of a volume.
openvdb::FloatGrid::Ptr grid_from_volume(const Volume& volume);

}  // namespace vog
