// group_gaussian.cpp: shapes and peaks of Gaussians of boxes of voxels, by the paper's conventions.
#include "convert/paper/group_gaussian.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "vog/error.h"

namespace vog::paper {

GroupShape group_shape(const GroupFit& fit, Vec3i size) {
    Vec3d deviation;
    for (int axis = 0; axis < 3; ++axis) {
        const double radius = std::max(0.5 * size[axis], fit.minimum_radius_voxels);
        deviation[axis] = radius / std::numbers::sqrt2;
    }
    const WorldShape world = world_shape(fit.frame, deviation);
    // Mass is sum * |det|, and the product of the world scales is |det| times that of the
    // deviations:
    // the determinant cancels.
    const double unit_peak_mass = std::pow(2 * std::numbers::pi, 1.5) * mass_within(fit.cutoff) *
                                  deviation.x * deviation.y * deviation.z;
    return {vec_cast<float>(world.scale), world.rotation, 1 / unit_peak_mass};
}

GroupFit make_group_fit(const Volume& volume, const PaperOptions& options, float cutoff) {
    GroupFit fit;
    fit.frame = world_frame(volume.world_from_index);
    fit.amplitude = options.amplitude;
    fit.opacity_threshold = options.opacity_threshold;
    fit.minimum_radius_voxels = options.minimum_radius_voxels;
    fit.cutoff = cutoff;
    for (int offset = 0; offset < kLeafVoxels; ++offset)
        fit.leaf_shape[static_cast<std::size_t>(offset)] =
            group_shape(fit, {(offset >> 6) + 1, ((offset >> 3) & 7) + 1, (offset & 7) + 1});
    const Vec3f voxel = fit.leaf_shape[0].scale;
    for (int axis = 0; axis < 3; ++axis)
        if (!std::isnormal(voxel[axis]) || voxel[axis] > 1e30f)
            throw Error(fmt::format(
                "{}: a voxel would have the standard deviation {}, expected 1e-37 to 1e30",
                volume.source.empty() ? "volume" : volume.source, voxel[axis]));
    return fit;
}

}  // namespace vog::paper
