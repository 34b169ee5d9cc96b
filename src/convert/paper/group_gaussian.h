// group_gaussian.h: from a group of voxels and its index box to one Gaussian, the step that all
// strategies of the paper share.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "convert/paper/world_shape.h"
#include "vog/convert_paper.h"

namespace vog::paper {

/// A group of voxels: index box, sum and number of the active values.
struct Group {
    Vec3i lower;       ///< index of the box's first voxel
    Vec3i size;        ///< voxels along each axis
    double sum = 0;    ///< sum of the active values
    double count = 0;  ///< active voxels; double, as a tile may have 4096^3
};

/// One Gaussian, before it is copied to the model's arrays.
struct FittedGaussian {
    Vec3f mean;
    float density = 0;
    Vec3f scale;
    Quat rotation;
};

/// Shape of the Gaussians of all boxes of one size.
struct GroupShape {
    Vec3f scale;
    Quat rotation;
    double peak_per_sum = 0;  ///< Amplitude::mass: peak density per sum of values
};

/// Constants that all groups of one conversion share.
struct GroupFit {
    WorldFrame frame;
    Amplitude amplitude = Amplitude::mean;
    double opacity_threshold = 0;
    double minimum_radius_voxels = 0;
    float cutoff = 0;
    std::array<GroupShape, kLeafVoxels> leaf_shape;  ///< boxes up to 8^3, at leaf_offset(size - 1)
};

/// throws vog::Error unless the scales of a single voxel are within 1e-37 and 1e30
GroupFit make_group_fit(const Volume& volume, const PaperOptions& options, float cutoff);

/// Shape for a box of `size` voxels. The paper's radius r is half the box, at least the minimum
/// radius;
/// its kernel exp(-d^T diag(r^2)^-1 d) has the standard deviation r / sqrt 2.
GroupShape group_shape(const GroupFit& fit, Vec3i size);

/// Appends the group's Gaussian, unless its mean value is at or below the opacity threshold.
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
