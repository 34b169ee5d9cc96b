// vog/convert_labels.h: volumes divided by labels, such as a segmentation has, so that no Gaussian of a conversion straddles two.
#pragma once

#include <cstdint>
#include <vector>

#include "vog/volume.h"
#include "vog/voxel_field.h"

namespace vog {

/// The voxels of one label.
struct LabelledVolume {
    std::int64_t label = 0;
    Volume volume;
};

/// Largest number of labels of a volume.
inline constexpr std::size_t kMostLabels = 1000;

/// Parts of a volume by the labels at its voxels, 0 among them, in ascending order; together they are the volume.
/// labels  whole numbers, a scalar field at the volume's voxels (read_field); without values the volume's own
/// throws  vog::Error for values that are no whole numbers, as of labels on another lattice, and for more than kMostLabels
[[nodiscard]] std::vector<LabelledVolume> divide_by_labels(const Volume& volume,
                                                           const VoxelField& labels);

}  // namespace vog
