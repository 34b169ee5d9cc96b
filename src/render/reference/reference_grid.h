// reference_grid.h: Data of a VoxelGrid: NanoVDB tree, transform and interpolation.
#pragma once

#include "core/parallel.h"
#include "render/pixel_tiles.h"
#include "render/reference/hierarchical_dda.h"
#include "render/reference/nano_tree.h"
#include "render/reference/reference.h"

namespace vog {

struct VoxelGrid::Data {
    VoxelGridOptions options;
    reference::NanoTree tree;
    Vec3d corner;  ///< index of the local origin: the lower corner of the active box, or of_part's
    reference::RootCells root_cells;
    Vec3d world_corner;     ///< the same point in world space
    Mat3 local_from_world;  ///< linear part, for directions

    /// Sets the tree, the corner and the cells of the root.
    /// of_part  the corner is the same for all parts of a volume
    void set_tree(reference::NanoTree made, bool of_part = false);

    /// The ray in local coordinates in which voxel i covers [i, i + 1) (voxel_ray), or has its centre
    /// at i (center_ray). Both have the same t as the ray in world space.
    reference::GridRay voxel_ray(Vec3d origin, Vec3d direction) const {
        return {voxel_origin(origin), local_from_world * direction};
    }
    Vec3d voxel_origin(Vec3d origin) const {
        return local_from_world * (origin - world_corner) + Vec3d{0.5, 0.5, 0.5};
    }
    reference::GridRay center_ray(Vec3d origin, Vec3d direction) const {
        return {local_from_world * (origin - world_corner), local_from_world * direction};
    }
};

}  // namespace vog

namespace vog::reference {

/// As voxel_grid, of constant voxels, with local coordinates that all parts of a volume share, up to indices of 2^19: a
/// ray within a face then lies in the same voxel whichever part has it.
VoxelGrid voxel_grid_of_part(const Volume& volume);
/// throws vog::Error unless samples is in [1, 64]
void check_samples(int samples);
/// Part of a ray that a clip leaves.
inline Segment visible_segment(const Clipping& clip, Vec3d origin, Vec3d direction) {
    if (clip.empty()) return {};
    const RayInterval interval = clipped_ray(clip, origin, direction);
    return {interval.first, interval.last};
}
/// Sample i of n along an edge of a pixel, from its centre.
inline double sample_offset(int i, int n) { return (i + 0.5) / n - 0.5; }

/// Evaluates depth(origin, direction, segment) for every pixel, as the mean over its samples.
template <class Depth>
DepthImage render_rays(const Depth& depth, const Camera& camera, int width, int height,
                       const ReferenceOptions& options) {
    const int n = options.samples;
    check_samples(n);
    validate(options.clip);
    const CameraFrame frame = frame_of(camera, width, height);
    DepthImage image(width, height);
    const auto offset = [&](int i) { return sample_offset(i, n); };
    const auto along = [&](Vec3d origin, Vec3d direction) {
        return depth(origin, direction, visible_segment(options.clip, origin, direction));
    };
    for_each_pixel(width, height, options.progress, [&](int column, int row) {
        if (options.fifth && !is_fifth(column, row)) return;
        check_interrupt();
        double sum = 0;
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x)
                sum += along(frame.origin(column + offset(x), row + offset(y)),
                             frame.direction(column + offset(x), row + offset(y)));
        image.at(column, row) = static_cast<float>(sum / (n * n));
    });
    return image;
}

}  // namespace vog::reference
