// group_gaussian.h: the step all strategies of the paper share: a group of voxels and the index box
// around it become one Gaussian, or nothing where the group is too thin to see.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "convert/paper/world_shape.h"
#include "vog/convert_paper.h"

namespace vog::paper {

/// Voxels of one group: its index box, and the sum and number of its values.
struct Group {
    Vec3i lower;       ///< index of the box's first voxel
    Vec3i size;        ///< voxels along each axis
    double sum = 0;    ///< of the active values
    double count = 0;  ///< of active voxels; a tile may stand for 4096^3
};

/// One Gaussian on its way to the model's arrays.
struct FittedGaussian {
    Vec3f mean;
    float density = 0;
    Vec3f scale;
    Quat rotation;
};

/// What boxes of one size become, wherever they lie.
struct GroupShape {
    Vec3f scale;
    Quat rotation;
    double peak_per_sum = 0;  ///< Amplitude::mass: peak density over the sum of the group's values
};

/// All that the groups of one conversion have in common.
struct GroupFit {
    WorldFrame frame;
    Amplitude amplitude = Amplitude::mean;
    double opacity_threshold = 0;
    double minimum_radius_voxels = 0;
    float cutoff = 0;
    std::array<GroupShape, kLeafVoxels> leaf_shape;  ///< boxes up to 8^3, at leaf_offset(size - 1)
};

/// throws vog::Error if the scales of a voxel are no positive float32
GroupFit make_group_fit(const Volume& volume, const PaperOptions& options, float cutoff);

/// The paper's radius is half the box, at least the minimum radius; its kernel
/// exp(-d^T diag(r^2)^-1 d) has the standard deviation r / sqrt 2.
GroupShape group_shape(const GroupFit& fit, Vec3i size);

/// Appends the group's Gaussian, unless its mean is at or below the opacity threshold.
inline void add_group(const GroupFit& fit, const Group& group, std::vector<FittedGaussian>& out) {
    const double mean = group.sum / group.count;
    if (!(mean > fit.opacity_threshold)) return;
    const Vec3i last = group.size - Vec3i{1, 1, 1};
    const bool in_table = (last.x | last.y | last.z) < kLeafEdge;
    const GroupShape shape =
        in_table ? fit.leaf_shape[static_cast<std::size_t>(leaf_offset(last.x, last.y, last.z))]
                 : group_shape(fit, group.size);
    // Voxel centres lie at integers: n voxels from i on have their middle at i + (n - 1) / 2.
    const Vec3d middle = vec_cast<double>(group.lower) + 0.5 * vec_cast<double>(last);
    const double density = fit.amplitude == Amplitude::mean ? mean : shape.peak_per_sum * group.sum;
    out.push_back({vec_cast<float>(fit.frame.world_from_index(middle)), static_cast<float>(density),
                   shape.scale, shape.rotation});
}

}  // namespace vog::paper
