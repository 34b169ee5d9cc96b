// launch.h: Launch parameters of the OptiX programs, and the names of their entry points, by which
// the host finds the programs in the compiled module.
#pragma once

#include "render/device/any_hit.h"
#include "render/device/camera_ray.h"
#include "render/device/chord_picture.h"
#include "render/device/gaussian_hit.h"
#include "render/device/voxels/voxel_picture.h"

#define VOG_RAYGEN_ACCUMULATE "__raygen__accumulate"
#define VOG_RAYGEN_COLLECT "__raygen__collect"
#define VOG_INTERSECTION_GAUSSIAN "__intersection__gaussian"
#define VOG_ANYHIT_ACCUMULATE "__anyhit__accumulate"
#define VOG_ANYHIT_COLLECT "__anyhit__collect"
#define VOG_MISS_GAUSSIAN "__miss__gaussian"
#define VOG_RAYGEN_SUMS "__raygen__sums"
#define VOG_ANYHIT_SUMS "__anyhit__sums"
#define VOG_RAYGEN_SLABS "__raygen__slabs"
#define VOG_ANYHIT_SLABS "__anyhit__slabs"
#define VOG_RAYGEN_VOXELS "__raygen__voxels"
#define VOG_INTERSECTION_VOXELS "__intersection__voxels"
#define VOG_CLOSESTHIT_VOXELS "__closesthit__voxels"

namespace vog::device {

constexpr int kPayloadWords = 2;    ///< a pointer to the ray's own data
constexpr int kAttributeWords = 4;  ///< Hit

/// Output of a launch of the Gaussian pipeline: a picture of one launch, or of several, each with other points of pixels.
struct Film {
    float* depth;       ///< [height * width] T at extinction 1, mean over the launches so far
    double* sum;        ///< [height * width] sum over launches, or null for a picture of one
    double depth_unit;  ///< T of one unit of a ray's depth
    double x, y;        ///< point of the pixel, [-1/2, 1/2]; 0: its centre
    int32_t earlier;    ///< number of launches before this one
};

/// Work of one ray, for reports.
struct RayCounts {
    uint64_t hits;               ///< over all launches of a picture
    uint32_t slabs, most_slabs;  ///< over all launches, and the largest of one
};

/// Launch parameters of all pipelines.
struct Launch {
    uint64_t traversable;
    Camera camera;
    Bounds bounds;
    Film film;

    // The Gaussian pipeline.
    const Gaussian* gaussians;
    const float* shares;    ///< of the Gaussians, or null: share_of()
    const float* splatted;  ///< [height * width] T of the Gaussians of share 0, or null
    Double3 center;         ///< origin of the hierarchy's coordinates, scene units
    Bounds scene;           ///< TraceModel::scene
    SumRounding rounding;
    double stop_depth;  ///< in film.depth_unit, as all depths of the Gaussian pipeline
    float cutoff2;
    int32_t boxed;
    int32_t hits_per_slab;
    RayCounts* counts;  ///< [height * width], or null

    // The same of pictures of chords, which have no film.
    ChordPicture chords;

    // The SciVis pipeline, which has no film.
    VoxelPicture voxels;
};

/// Writes T of one ray.
/// depth  in film.depth_unit
VOG_HD void expose(const Film& film, uint32_t pixel, double depth) {
    double total = depth * film.depth_unit;
    if (film.sum) {
        if (film.earlier) total += film.sum[pixel];
        film.sum[pixel] = total;
    }
    film.depth[pixel] = static_cast<float>(total / (film.earlier + 1));
}

}  // namespace vog::device
