// vog/openvdb.h: the interop header, the only public one that shows a third-party type.
#pragma once

#include <openvdb/openvdb.h>

#include "vog/volume.h"

namespace vog {

/// Density from a grid in memory: values below zero become zero, non-finite ones are refused.
/// throws vog::Error for a level set, a non-affine or singular transform, non-finite values
Volume volume_from_grid(const openvdb::FloatGrid& grid);

/// The same volume as an OpenVDB grid of class fog volume, tiles as tiles.
openvdb::FloatGrid::Ptr grid_from_volume(const Volume& volume);

}  // namespace vog
